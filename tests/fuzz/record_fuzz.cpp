#include <cstring>
#include <memory>
#include <vector>

#include "runtime/base/crc32c.h"
#include "runtime/export/export.h"
#include "runtime/store/record_codec.h"

namespace {

using namespace roomcal;

struct alignas(16) Block {
  std::byte bytes[store::kMaxRecordBytes];
};

// What decodes must encode again, decode to the same bytes, and be exportable.
void use(const store::Record& record) {
  static Block out, again, scratch;
  static std::vector<char> text(32768);
  const Result<std::size_t> size = store::encode_record(record, out.bytes, scratch.bytes);
  if (!size.ok()) __builtin_trap();
  static store::Record back;
  if (!store::decode_record({out.bytes, size.value()}, back).ok()) __builtin_trap();
  const Result<std::size_t> size_again = store::encode_record(back, again.bytes, scratch.bytes);
  if (!size_again.ok() || size_again.value() != size.value()) __builtin_trap();
  if (std::memcmp(out.bytes, again.bytes, size.value()) != 0) __builtin_trap();
  for (int format = 0; format <= static_cast<int>(exports::Format::kOpenCv); ++format) {
    TextWriter writer(text);
    const Status status =
        exports::write(record, static_cast<exports::Format>(format), record.sensors[0].name.view(), writer);
    if (!status.ok() && status.code() != StatusCode::kNotFound) __builtin_trap();
  }
}

void walk(std::span<const std::byte> bytes) {
  static store::Record record;
  if (store::decode_record(bytes, record).ok()) use(record);
}

// With sums made to fit, so that the fuzzer gets past them to what they guard.
void reseal(std::span<std::byte> bytes) {
  store::RecordHeader header{};
  if (bytes.size() < sizeof header) return;
  header.magic = store::kMagic;
  header.version = store::kFormatVersion;
  header.payload_bytes = static_cast<uint32_t>(bytes.size() - sizeof header);
  header.payload_crc32c = crc32c(bytes.subspan(sizeof header));
  std::memcpy(bytes.data(), &header, sizeof header);
  header.header_crc32c = crc32c(bytes.first(offsetof(store::RecordHeader, header_crc32c)));
  std::memcpy(bytes.data(), &header, sizeof header);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  // A heap block of exactly this size, so that reading one byte too far is seen.
  const std::unique_ptr<std::byte[]> block(new std::byte[size]);
  if (size > 0) std::memcpy(block.get(), data, size);
  const std::span<std::byte> bytes(block.get(), size);
  walk(bytes);
  reseal(bytes);
  walk(bytes);
  return 0;
}
