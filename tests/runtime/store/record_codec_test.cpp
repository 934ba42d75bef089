#include "runtime/store/record_codec.h"

#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/base/crc32c.h"
#include "tests/runtime/store/sample_record.h"

namespace roomcal::store {
namespace {

using test::same;
using test::sample_record;

struct alignas(16) Bytes {
  std::byte data[kMaxRecordBytes];
};

class RecordCodec : public testing::Test {
 protected:
  std::span<std::byte> encode(const Record& record) {
    const Result<std::size_t> size = encode_record(record, out->data, scratch->data);
    EXPECT_TRUE(size.ok()) << size.status().detail();
    return std::span(out->data).first(size.ok() ? size.value() : 0);
  }

  std::unique_ptr<Bytes> out = std::make_unique<Bytes>(), scratch = std::make_unique<Bytes>();
  Record back;
};

TEST_F(RecordCodec, RoundTrip_EveryFieldComesBack) {
  Record record = sample_record(3, 4, 2);
  record.generation = 17;
  record.content_generation = 12;
  record.previous_content = 11;
  record.action = Action::kUndone;
  record.written_unix_s = 99;
  const auto bytes = encode(record);
  ASSERT_TRUE(decode_record(bytes, back).ok());
  EXPECT_TRUE(same(record, back));
  EXPECT_EQ(record_size(bytes).value(), bytes.size());
  std::printf("a record of 4 cameras and 2 LiDARs takes %zu bytes\n", bytes.size());
}

TEST_F(RecordCodec, LargestRecord_FitsWithRoom) {
  const Record record = test::largest_record();
  const auto bytes = encode(record);
  ASSERT_TRUE(decode_record(bytes, back).ok());
  EXPECT_TRUE(same(record, back));
  std::printf("the largest record takes %zu of %zu bytes\n", bytes.size(), kMaxRecordBytes);
  EXPECT_LT(bytes.size(), 3 * kMaxRecordBytes / 4);
}

TEST_F(RecordCodec, SameRecord_SameBytes) {
  const auto bytes = encode(sample_record(3));
  const std::vector<std::byte> first(bytes.begin(), bytes.end());
  std::memset(out->data, 0x5A, sizeof out->data);
  std::memset(scratch->data, 0x5A, sizeof scratch->data);
  const auto again = encode(sample_record(3));
  EXPECT_TRUE(std::equal(first.begin(), first.end(), again.begin(), again.end()));
}

TEST_F(RecordCodec, UnknownTemperature_StaysUnknown) {
  Record record = sample_record(3);
  record.temperature_c = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(decode_record(encode(record), back).ok());
  EXPECT_TRUE(std::isnan(back.temperature_c));
}

TEST_F(RecordCodec, AnyFlippedByte_IsFound) {
  const auto bytes = encode(sample_record(3));
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    bytes[at] ^= std::byte{0x40};
    EXPECT_FALSE(decode_record(bytes, back).ok()) << "byte " << at;
    bytes[at] ^= std::byte{0x40};
  }
}

TEST_F(RecordCodec, AnyCut_IsFound) {
  const auto bytes = encode(sample_record(3));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_EQ(decode_record(bytes.first(size), back).code(), StatusCode::kCorrupt) << size;
}

TEST_F(RecordCodec, AnotherVersion_IsUnsupported) {
  const auto bytes = encode(sample_record(3));
  RecordHeader header{};
  std::memcpy(&header, bytes.data(), sizeof header);
  header.version = kFormatVersion + 1;
  std::memcpy(bytes.data(), &header, sizeof header);
  header.header_crc32c = crc32c(bytes.first(offsetof(RecordHeader, header_crc32c)));
  std::memcpy(bytes.data(), &header, sizeof header);
  EXPECT_EQ(decode_record(bytes, back).code(), StatusCode::kUnsupported);
}

TEST_F(RecordCodec, SmallOutput_IsCapacity) {
  const Record record = sample_record(3);
  const std::size_t size = encode(record).size();
  EXPECT_EQ(encode_record(record, std::span(out->data).first(size - 1), scratch->data).status().code(),
            StatusCode::kCapacity);
  EXPECT_TRUE(encode_record(record, std::span(out->data).first(size), scratch->data).ok());
}

TEST_F(RecordCodec, SmallScratch_IsRefused) {
  const auto status = encode_record(sample_record(3), out->data, std::span(scratch->data).first(100)).status();
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
}

// What may never be stored or used, each made of a valid record.
struct BadRecord {
  const char* what;
  void (*spoil)(Record&);
};

class RecordCheck : public testing::TestWithParam<BadRecord> {};

TEST_P(RecordCheck, Impossible_IsRefused) {
  Record record = sample_record(3, 2, 1);
  ASSERT_TRUE(check_record(record).ok());
  GetParam().spoil(record);
  EXPECT_EQ(check_record(record).code(), StatusCode::kCorrupt) << GetParam().what;
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    All, RecordCheck,
    testing::Values(BadRecord{"identity that nobody measured", [](Record& r) { r.sensors[1].T_rig_sensor = SE3(); }},
                    BadRecord{"moved reference", [](Record& r) { r.sensors[0].T_rig_sensor.t.x() = 0.1; }},
                    BadRecord{"reference with covariance", [](Record& r) { r.sensors[0].cov_rig_sensor(0, 0) = 1e-6; }},
                    BadRecord{"NaN translation", [](Record& r) { r.sensors[1].T_rig_sensor.t.y() = kNan; }},
                    BadRecord{"infinite rotation", [](Record& r) { r.sensors[1].T_rig_sensor.R(0, 0) = 1 / 0.0; }},
                    BadRecord{"scaled rotation", [](Record& r) { r.sensors[1].T_rig_sensor.R *= 1.001; }},
                    BadRecord{"mirrored axes", [](Record& r) { r.sensors[1].T_rig_sensor.R.col(0) *= -1; }},
                    BadRecord{"a light year away", [](Record& r) { r.sensors[1].T_rig_sensor.t.z() = 9.5e15; }},
                    BadRecord{"negative variance", [](Record& r) { r.sensors[1].cov_rig_sensor(2, 2) = -1e-3; }},
                    BadRecord{"NaN covariance", [](Record& r) { r.sensors[1].cov_rig_sensor(3, 3) = kNan; }},
                    BadRecord{"no focal length", [](Record& r) { r.sensors[1].intrinsics.fx_px = 0; }},
                    BadRecord{"no pixels", [](Record& r) { r.sensors[1].intrinsics.width_px = 0; }},
                    BadRecord{"unknown camera model",
                              [](Record& r) { r.sensors[1].intrinsics.model = static_cast<camera::Model>(7); }},
                    BadRecord{"unknown kind", [](Record& r) { r.sensors[2].kind = static_cast<SensorKind>(9); }},
                    BadRecord{"name twice", [](Record& r) { r.sensors[2].name = r.sensors[1].name; }},
                    BadRecord{"name with a colon", [](Record& r) { r.sensors[1].name = "cam: 1"; }},
                    BadRecord{"no name", [](Record& r) { r.sensors[1].name.clear(); }},
                    BadRecord{"serial with an escape", [](Record& r) { r.sensors[1].serial = "\x1b[2J"; }},
                    BadRecord{"reference out of range", [](Record& r) { r.reference = 3; }},
                    BadRecord{"no sensor", [](Record& r) { r.sensors.clear(); }},
                    BadRecord{"unknown verdict", [](Record& r) { r.verdict = static_cast<Verdict>(9); }},
                    BadRecord{"unknown action", [](Record& r) { r.action = static_cast<Action>(9); }},
                    BadRecord{"content from the future", [](Record& r) { r.content_generation = r.generation + 1; }},
                    BadRecord{"NaN chi2", [](Record& r) { r.chi2 = kNan; }},
                    BadRecord{"NaN rms", [](Record& r) { r.sensors[1].evidence.rms = kNan; }},
                    BadRecord{"unprintable reason", [](Record& r) { r.reasons[0] = "\n"; }}));

}  // namespace
}  // namespace roomcal::store
