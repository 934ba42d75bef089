// A profile through `roomcal provision`'s writer and the device's reader, whole and damaged.

#include <cstdio>
#include <cstring>
#include <functional>
#include <set>

#include <gtest/gtest.h>

#include "runtime/calib/limit_table.h"
#include "runtime/profile/format.h"
#include "runtime/profile/profile.h"
#include "tests/fuzz/sealed.h"
#include "tests/runtime/profile/sample_profile.h"
#include "tests/tools/device/wiring_walk.h"
#include "tests/tools/refusal.h"
#include "tools/provision/profile_file.h"

namespace roomcal::profile {
namespace {

using test::full_profile;
using test::small_profile;
using test::text_of;
using tools::AlignedBytes;
using tools::build_profile;

Profile through_bytes(const Profile& profile) {
  const AlignedBytes bytes = build_profile(profile);
  Profile back;
  Reason what;
  EXPECT_TRUE(decode_profile(bytes.span(), back, what).ok()) << what.view();
  EXPECT_TRUE(what.empty());
  return back;
}

/// Bytes with one string of the payload replaced by another of its length, and the sums made to fit.
AlignedBytes with_replaced(const Profile& profile, std::string_view from, std::string_view to) {
  AlignedBytes bytes = build_profile(profile);
  const std::string_view all(reinterpret_cast<const char*>(bytes.span().data()), bytes.span().size());
  const std::size_t at = all.find(from);
  EXPECT_NE(at, std::string_view::npos);
  std::memcpy(bytes.span().data() + at, to.data(), to.size());
  fuzz::reseal<SealedHeader>(bytes.span(), kProfileKind.magic, kProfileKind.version);
  return bytes;
}

TEST(ProfileCodec, FullProfile_EveryFieldComesBack) {
  const Profile profile = full_profile();
  EXPECT_EQ(text_of(through_bytes(profile)), text_of(profile));
  std::printf("a profile of 3 cameras and 3 LiDARs takes %zu bytes\n", build_profile(profile).span().size());
}

TEST(ProfileCodec, SmallProfile_TakesTheDefaults) {
  const Profile profile = small_profile();
  EXPECT_EQ(text_of(through_bytes(profile)), text_of(profile));
}

// A field that is written but not read, or read into another one, shows here by its name.
TEST(ProfileCodec, EachWiringFieldAlone_ComesBack) {
  std::set<std::string> texts;
  const auto try_field = [&](const Profile& profile, std::string_view name) {
    const std::string text = text_of(profile);
    EXPECT_TRUE(texts.insert(text).second) << name << " does not show";
    EXPECT_EQ(text_of(through_bytes(profile)), text) << name;
  };
  const auto change = [&](auto part, std::size_t fields) {
    for (std::size_t i = 0; i < fields; ++i) {
      Profile profile = full_profile();
      tools::test::ChangeField changed(i);
      tools::walk(part(profile), changed);
      try_field(profile, changed.changed());
    }
  };
  using tools::test::walked_fields;
  change([](Profile& p) -> CameraWiring& { return p.cameras[2].wiring; }, walked_fields<CameraWiring>());
  change([](Profile& p) -> LidarWiring& { return p.lidars[1].wiring; }, walked_fields<LidarWiring>());
  change([](Profile& p) -> GrabWiring& { return p.grab; }, walked_fields<GrabWiring>());
  Wiring sections;
  tools::walk_sections(sections, [&](std::string_view key, auto& section) {
    using Section = std::remove_reference_t<decltype(section)>;
    const auto part = [key](Profile& p) -> Section& {
      Section* found = nullptr;
      tools::walk_sections(p.wiring, [&](std::string_view candidate, auto& other) {
        if constexpr (std::is_same_v<std::remove_reference_t<decltype(other)>, Section>)
          if (candidate == key) found = &other;
      });
      return *found;
    };
    change(part, walked_fields<Section>());
  });
  EXPECT_GE(texts.size(), 50U);
}

TEST(ProfileCodec, EveryOtherField_ComesBack) {
  const std::vector<std::function<void(Profile&)>> changes = {
      [](Profile& p) { p.device = "another"; },
      [](Profile& p) { p.serial = "X"; },
      [](Profile& p) { p.cameras[0].name = "front"; },
      [](Profile& p) { p.cameras[0].serial = "X"; },
      [](Profile& p) { p.cameras[0].serial.clear(); },
      [](Profile& p) { p.cameras[0].intrinsics.model = camera::Model::kPinholeRadtan; },
      [](Profile& p) { p.cameras[0].intrinsics.width_px = 640; },
      [](Profile& p) { p.cameras[0].intrinsics.height_px = 480; },
      [](Profile& p) { p.cameras[0].intrinsics.fx_px += 1; },
      [](Profile& p) { p.cameras[0].intrinsics.fy_px += 1; },
      [](Profile& p) { p.cameras[0].intrinsics.cx_px += 1; },
      [](Profile& p) { p.cameras[0].intrinsics.cy_px += 1; },
      [](Profile& p) { p.cameras[0].intrinsics.distortion[0] += 1e-3; },
      [](Profile& p) { p.cameras[0].intrinsics.distortion[3] += 1e-3; },
      [](Profile& p) { p.cameras[0].sigma_px = 0; },
      [](Profile& p) { p.cameras[0].nominal = {}; },
      [](Profile& p) { p.cameras[0].nominal.sigma_t_m = 0.01; },
      [](Profile& p) { p.cameras[0].nominal.sigma_rot_rad = 0.01; },
      [](Profile& p) { p.cameras[0].nominal.T_rig_sensor.t.z() = 0.5; },
      [](Profile& p) { p.cameras[0].nominal.T_rig_sensor.R.transposeInPlace(); },
      [](Profile& p) { p.cameras[0].wiring.formats.clear(); },
      [](Profile& p) { p.lidars[0].calibration.from_unit = false; },
      [](Profile& p) { p.lidars[0].calibration.dual_returns = true; },
      [](Profile& p) { p.lidars[0].nominal = {}; },
      [](Profile& p) { p.lidars[2].on_turntable = false; },
      [](Profile& p) { p.lidars[2].turntable.axis_lidar = Vec3::UnitX(); },
      [](Profile& p) { p.lidars[2].turntable.T_lidar_profiler.t.z() = 0.5; },
      [](Profile& p) { p.lidars[2].turntable.T_lidar_profiler.R = Mat33::Identity(); },
      [](Profile& p) { p.lidars.clear(); },
      [](Profile& p) { p.wiring.replay_folder.clear(); },
  };
  std::set<std::string> texts{text_of(full_profile())};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    Profile profile = full_profile();
    changes[i](profile);
    EXPECT_TRUE(texts.insert(text_of(profile)).second) << "change " << i << " does not show";
    EXPECT_EQ(text_of(through_bytes(profile)), text_of(profile)) << "change " << i;
  }
}

TEST(ProfileCodec, EachLimitAlone_ComesBack) {
  for (const calib::LimitField& field : calib::limit_table())
    for (const double value : {field.least, field.most}) {
      Profile profile = small_profile();
      ASSERT_TRUE(set_limit(profile.limits, field, value)) << field.name;
      EXPECT_EQ(get_limit(through_bytes(profile).limits, field), value) << field.name;
    }
}

TEST(ProfileCodec, EveryEnumerationValue_ComesBack) {
  Profile profile = full_profile();
  const auto each = [&](auto& value, auto last) {
    using Enum = std::remove_reference_t<decltype(value)>;
    const Enum before = value;
    for (int i = 0; i <= static_cast<int>(last); ++i) {
      value = static_cast<Enum>(i);
      EXPECT_EQ(text_of(through_bytes(profile)), text_of(profile)) << i;
    }
    value = before;
  };
  each(profile.cameras[0].wiring.driver, ImageDriver::kAravis);
  each(profile.cameras[0].wiring.trigger, TriggerMode::kAction);
  each(profile.cameras[0].wiring.stamp_point, StampPoint::kExposureEnd);
  each(profile.cameras[0].wiring.sync, SyncRole::kClient);
  each(profile.lidars[0].wiring.driver, PacketDriver::kUdp);
  each(profile.wiring.trigger.kind, TriggerKind::kCan);
  each(profile.wiring.button.kind, ButtonKind::kLine);
  each(profile.wiring.light.kind, LightKind::kLine);
  each(profile.wiring.store.kind, StoreKind::kNvmem);
  each(profile.lidars[1].calibration.ouster.profile, lidar::OusterProfile::kFiveWord);
}

TEST(ProfileCodec, EveryLidarModel_ComesBackWithItsAngles) {
  std::vector<std::string> models = {"tls", "os0", "os1", "os2"};
  for (const lidar::ModelInfo& model : lidar::known_models()) models.emplace_back(model.name);
  for (const std::string& model : models) {
    Profile profile = small_profile();
    ASSERT_TRUE(profile.lidars.push_back(test::lidar_of("lidar0", model)));
    EXPECT_EQ(text_of(through_bytes(profile)), text_of(profile)) << model;
  }
}

TEST(ProfileCodec, LargestProfile_Fits) {
  Profile profile = full_profile();
  const CameraProfile camera = profile.cameras[0];
  while (profile.cameras.push_back(camera)) {
    CameraProfile& last = profile.cameras.back();
    last.name = std::string_view(std::string(30, 'n') + std::to_string(profile.cameras.size()));
    last.serial = std::string_view(std::string(30, 's') + std::to_string(profile.cameras.size()));
    last.wiring.key = std::string_view(std::string(126, 'k') + std::to_string(profile.cameras.size()));
  }
  const LidarProfile lidar = profile.lidars[1];
  while (profile.lidars.push_back(lidar)) {
    LidarProfile& last = profile.lidars.back();
    last.name = std::string_view(std::string(29, 'n') + std::to_string(20 + profile.lidars.size()));
    last.serial = std::string_view(std::string(29, 's') + std::to_string(20 + profile.lidars.size()));
    last.wiring.port = static_cast<uint16_t>(8000 + profile.lidars.size());
  }
  profile.wiring.replay_folder = std::string_view(std::string(127, 'r'));
  EXPECT_EQ(text_of(through_bytes(profile)), text_of(profile));
}

TEST(ProfileCodec, BadProfile_IsNotBuilt) {
  Profile profile = full_profile();
  profile.cameras[2].wiring.buffers = 1;
  EXPECT_EQ(tools::test::refusal([&] { build_profile(profile); }), "profile: cam2: buffers is not between 2 and 16");
}

TEST(DecodeProfile, AnyFlippedByte_IsRefusedWithAReason) {
  AlignedBytes bytes = build_profile(small_profile());
  for (std::size_t at = 0; at < bytes.span().size(); ++at) {
    bytes.span()[at] ^= std::byte{0x40};
    Profile back;
    Reason what;
    EXPECT_FALSE(decode_profile(bytes.span(), back, what).ok()) << "byte " << at;
    EXPECT_FALSE(what.empty()) << "byte " << at;
    bytes.span()[at] ^= std::byte{0x40};
  }
}

// Damage that the sums do not see (somebody who makes profiles by other means): what is taken can work, and is written
// back to a profile that reads the same.
TEST(DecodeProfile, AnyFlippedBitUnderFittingSums_IsRefusedOrAWorkingProfile) {
  Profile profile = small_profile();
  ASSERT_TRUE(profile.lidars.push_back(test::lidar_of("lidar0", "r2000")));
  profile.wiring.button = {ButtonKind::kLine, "", 0, "4"};
  const AlignedBytes good = build_profile(profile);
  std::size_t taken = 0, refused = 0;
  for (std::size_t bit = 8 * sizeof(SealedHeader); bit < 8 * good.span().size(); ++bit) {
    AlignedBytes bytes = good;
    bytes.span()[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    fuzz::reseal<SealedHeader>(bytes.span(), kProfileKind.magic, kProfileKind.version);
    Profile back;
    Reason what;
    if (!decode_profile(bytes.span(), back, what).ok()) {
      EXPECT_FALSE(what.empty()) << "bit " << bit;
      ++refused;
      continue;
    }
    EXPECT_TRUE(check_profile(back, what).ok()) << "bit " << bit << ": " << what.view();
    EXPECT_EQ(text_of(through_bytes(back)), text_of(back)) << "bit " << bit;
    ++taken;
  }
  EXPECT_GE(taken, 1000U);
  EXPECT_GE(refused, 1000U);
}

TEST(DecodeProfile, CutFile_IsRefusedAtAnyLength) {
  const AlignedBytes bytes = build_profile(full_profile());
  for (std::size_t size = 0; size < bytes.span().size(); size += size < 64 ? 1 : 97) {
    Profile back;
    Reason what;
    EXPECT_EQ(decode_profile(bytes.span().first(size), back, what).code(), StatusCode::kCorrupt) << size;
    EXPECT_NE(what.view().find(size < sizeof(SealedHeader) ? "shorter than" : "cut short"), std::string_view::npos);
  }
}

TEST(DecodeProfile, BytesBehindTheProfile_AreNotLookedAt) {
  const AlignedBytes bytes = build_profile(small_profile());
  AlignedBytes longer(bytes.span().size() + 100);
  std::ranges::copy(bytes.span(), longer.span().begin());
  Profile back;
  Reason what;
  EXPECT_TRUE(decode_profile(longer.span(), back, what).ok());
}

TEST(DecodeProfile, UnalignedBytes_AreInvalidArgument) {
  const AlignedBytes bytes = build_profile(small_profile());
  AlignedBytes shifted(bytes.span().size() + 1);
  std::ranges::copy(bytes.span(), shifted.span().begin() + 1);
  Profile back;
  Reason what;
  EXPECT_EQ(decode_profile(std::as_const(shifted).span().subspan(1), back, what).code(), StatusCode::kInvalidArgument);
}

TEST(DecodeProfile, AnotherVersion_IsUnsupportedAndSaysSo) {
  AlignedBytes bytes = build_profile(small_profile());
  fuzz::reseal<SealedHeader>(bytes.span(), kProfileKind.magic, kProfileKind.version + 1);
  Profile back;
  Reason what;
  EXPECT_EQ(decode_profile(bytes.span(), back, what).code(), StatusCode::kUnsupported);
  EXPECT_EQ(what.view(), kProfileKind.other_version);
}

TEST(DecodeProfile, SomethingElse_IsNamed) {
  AlignedBytes bytes = build_profile(small_profile());
  fuzz::reseal<SealedHeader>(bytes.span(), {'r', 'o', 'o', 'm', 'r', 'e', 'c', '\n'}, 1);
  Profile back;
  Reason what;
  EXPECT_EQ(decode_profile(bytes.span(), back, what).code(), StatusCode::kCorrupt);
  EXPECT_EQ(what.view(), kProfileKind.absent);
}

TEST(DecodeProfile, ModelOrLimitOfAnotherFirmware_IsUnsupported) {
  Profile profile = full_profile();
  Profile back;
  Reason what;
  EXPECT_EQ(decode_profile(with_replaced(profile, "vlp16", "vlp99").span(), back, what).code(),
            StatusCode::kUnsupported);
  EXPECT_NE(what.view().find("LiDAR model"), std::string_view::npos);
  EXPECT_EQ(decode_profile(with_replaced(profile, "min_inliers", "min_outlier").span(), back, what).code(),
            StatusCode::kUnsupported);
  EXPECT_NE(what.view().find("limit"), std::string_view::npos);
}

TEST(DecodeProfile, ValuesThatCannotBe_AreCorruptAndNameTheSensor) {
  Profile back;
  Reason what;
  EXPECT_EQ(decode_profile(with_replaced(full_profile(), "cam2", "cam0").span(), back, what).code(),
            StatusCode::kCorrupt);
  EXPECT_EQ(what.view(), "cam0: two sensors have this name: rename one");
}

}  // namespace
}  // namespace roomcal::profile
