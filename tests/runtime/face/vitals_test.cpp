#include "runtime/face/vitals.h"

#include <string>

#include <gtest/gtest.h>

namespace roomcal::face {
namespace {

constexpr int64_t kSecond = 1'000'000'000;
constexpr int64_t kNow = 100 * kSecond;

std::string complaint_of(const CameraVitals& camera) { return std::string(complaint(camera, kNow).view()); }
std::string complaint_of(const LidarVitals& lidar) { return std::string(complaint(lidar, kNow).view()); }

LidarVitals sending(int64_t last_packet_ns) {
  LidarVitals lidar;
  lidar.name = "lidar0";
  lidar.model = "vlp16";
  lidar.last_packet_ns = last_packet_ns;
  lidar.sweeps.packets = 1000;
  return lidar;
}

TEST(CameraComplaint, Streaming_HasNone) {
  CameraVitals camera;
  camera.health.state = ports::SourceState::kStreaming;
  camera.health.last_fault = ports::ImageFault::kGone;  // once; it is back
  EXPECT_EQ(complaint_of(camera), "");
}

TEST(CameraComplaint, AnyOtherState_NamesSensorFaultAndRemedy) {
  CameraVitals camera;
  camera.name = "cam3";
  camera.health.last_fault = ports::ImageFault::kGone;
  for (const ports::SourceState state :
       {ports::SourceState::kClosed, ports::SourceState::kRecovering, ports::SourceState::kFaulted}) {
    camera.health.state = state;
    const std::string text = complaint_of(camera);
    EXPECT_EQ(text.find("cam3: "), 0U) << text;
    EXPECT_NE(text.find(to_string(state)), std::string::npos) << text;
    EXPECT_NE(text.find(remedy(ports::ImageFault::kGone)), std::string::npos) << text;
  }
}

TEST(LidarComplaint, PacketsThatCome_HaveNone) { EXPECT_EQ(complaint_of(sending(kNow - kSecond)), ""); }

TEST(LidarComplaint, Silence_IsToldWithItsLength) {
  EXPECT_EQ(complaint_of(sending(0)).find("lidar0: no packet has come yet"), 0U);
  EXPECT_EQ(complaint_of(sending(kNow - 7 * kSecond)), "lidar0: no packet for 7 s: check its power and its cable");
}

TEST(LidarComplaint, InterfaceThatIsMissing_IsToldBeforeTheSilence) {
  LidarVitals lidar = sending(0);
  lidar.connected = false;
  EXPECT_EQ(complaint_of(lidar).find("lidar0: its network interface is not there"), 0U);
}

TEST(LidarComplaint, PacketsOfAnotherModel_AreNamed) {
  LidarVitals lidar = sending(kNow);
  lidar.sweeps.packets = 0;
  lidar.sweeps.unsupported = 5;
  EXPECT_EQ(complaint_of(lidar), "lidar0: its packets are not of a vlp16: check the model in the profile");
  lidar.sweeps.packets = 1;
  EXPECT_EQ(complaint_of(lidar), "") << "among its own";
}

}  // namespace
}  // namespace roomcal::face
