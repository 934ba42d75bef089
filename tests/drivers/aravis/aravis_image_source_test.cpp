#include "drivers/aravis/aravis_image_source.h"

#include <arv.h>

#include "drivers/aravis/features.h"
#include "drivers/aravis/glib_handle.h"
#include "drivers/relay/software_trigger.h"
#include "tests/budget/heap_guard.h"
#include "tests/drivers/aravis/gige_rig.h"
#include "tests/drivers/aravis/sfnc_camera.h"

namespace roomcal::drivers {
namespace {

using ports::ImageFault;
using ports::SourceState;

using AravisImageSourceTest = GigeRig;

TEST_F(AravisImageSourceTest, FreeRunning_DeliversWholeImagesInOrder) {
  FakeGigeCamera camera({});
  auto source = make(options_for("FAKE1"));
  const Status started = source->start();
  ASSERT_TRUE(started.ok()) << started.detail();
  int64_t before_ns = 0;
  for (int i = 0; i < 50; ++i) {
    ASSERT_TRUE(next(*source, kS).ok()) << i;
    // The fake's picture: every pixel one more than its left neighbour, modulo 255.
    for (std::size_t x = 1; x < 512; ++x) ASSERT_EQ(pixels_[x], (pixels_[x - 1] + 1) % 255) << i;
    EXPECT_EQ(facts_.exposed.clock, ClockId::kDevice);
    EXPECT_GT(facts_.exposed.ns, before_ns);
    EXPECT_EQ(facts_.uncertainty_ns, 5 * kMs + 1000);  // half of the fake's exposure of 10 ms
    EXPECT_LT(clocks_.now_ns() - facts_.arrived_ns, kS);
    before_ns = facts_.exposed.ns;
  }
  EXPECT_EQ(source->health().state, SourceState::kStreaming);
  for (const std::string& line : log_.lines()) ADD_FAILURE() << line;
  EXPECT_EQ(source->ptp(), PtpState::kNone);
}

TEST_F(AravisImageSourceTest, Next_TakesNoHeap) {
  FakeGigeCamera camera({});
  auto source = make(options_for("FAKE1"));
  ASSERT_TRUE(source->start().ok());
  ASSERT_TRUE(next(*source, kS).ok());
  std::size_t calls = 0;
  for (int i = 0; i < 50; ++i) {
    budget::HeapGuard guard;
    const Status got = next(*source, kS);
    calls += guard.calls();
    ASSERT_TRUE(got.ok());
  }
  EXPECT_EQ(calls, 0U);
}

TEST_F(AravisImageSourceTest, WrongKey_IsNotFoundAndTheOthersAreNamed) {
  FakeGigeCamera camera({});
  auto source = make(options_for("NOBODY"));
  EXPECT_EQ(source->start().code(), StatusCode::kNotFound);
  EXPECT_EQ(log_.count("looking for NOBODY; cameras there: FAKE1 (Aravis-Fake-FAKE1 at 127.0.0.1)"), 1U);
  EXPECT_EQ(next(*source, 10 * kMs).code(), StatusCode::kUnavailable);
}

TEST_F(AravisImageSourceTest, EveryKindOfKey_FindsTheCamera) {
  FakeGigeCamera one({});
  FakeGigeCamera other({.address = "127.0.0.2", .serial = "FAKE2"});
  for (const char* key : {"FAKE2", "Aravis-Fake-FAKE2", "127.0.0.2"}) {
    auto source = make(options_for(key));
    EXPECT_TRUE(source->start().ok()) << key;
  }
}

TEST_F(AravisImageSourceTest, TwoCamerasOfOneSerialNumber_AreRefused) {
  // Of two fakes Aravis lists one only, as their maker and model are equal, too.
  arv_enable_interface("Fake");
  FakeGigeCamera one({.serial = "1"});
  auto source = make(options_for("1"));
  const Status started = source->start();
  EXPECT_EQ(started.code(), StatusCode::kNotFound);
  EXPECT_STREQ(started.detail(), "two cameras have this key; use the id, the MAC or the address");
  arv_disable_interface("Fake");
}

TEST_F(AravisImageSourceTest, Address_FindsTheSecondOfTwoThatAreAlike) {
  FakeGigeCamera one({.serial = "SAME"});
  FakeGigeCamera other({.address = "127.0.0.2", .serial = "SAME"});
  for (const char* address : {"127.0.0.1", "127.0.0.2"}) {
    auto source = make(options_for(address));
    EXPECT_TRUE(source->start().ok()) << address;
    EXPECT_EQ(images(*source, 5, 2 * kS), 5);
  }
  auto nobody = make(options_for("127.0.0.3"));
  EXPECT_EQ(nobody->start().code(), StatusCode::kNotFound);
}

TEST_F(AravisImageSourceTest, BusyCamera_IsSaidAndTakenWhenItIsFree) {
  FakeGigeCamera camera({});
  auto first = make(options_for("FAKE1"), "first");
  ASSERT_TRUE(first->start().ok());
  auto second = make(options_for("FAKE1"), "second");
  EXPECT_EQ(second->start().code(), StatusCode::kUnavailable);
  EXPECT_EQ(second->health().last_fault, ImageFault::kBusy);
  EXPECT_EQ(images(*first, 10, 2 * kS), 10) << "the one that has it is not disturbed";
  first->stop();
  EXPECT_EQ(images(*second, 10, 10 * kS), 10);
}

TEST_F(AravisImageSourceTest, FormatThatItDoesNotOffer_IsRefusedByName) {
  FakeGigeCamera camera({});
  AravisOptions options = options_for("FAKE1");
  options.pixel_format = "Mono12";
  auto source = make(options);
  EXPECT_EQ(source->start().code(), StatusCode::kUnsupported);
  EXPECT_EQ(log_.count("Mono12"), 1U);
  EXPECT_EQ(next(*source, 10 * kMs).code(), StatusCode::kUnavailable);
  EXPECT_EQ(source->health().state, SourceState::kFaulted);
}

TEST_F(AravisImageSourceTest, SizeThatItDoesNotHave_IsRefused) {
  FakeGigeCamera camera({});
  AravisOptions options = options_for("FAKE1");
  options.width_px = 4096;
  EXPECT_EQ(make(options)->start().code(), StatusCode::kUnsupported);
}

TEST_F(AravisImageSourceTest, OptionsThatCannotWork_AreRefusedBeforeAnybodyIsAsked) {
  AravisOptions options = options_for("FAKE1");
  options.pixel_format = "Mono12p";
  EXPECT_EQ(make(options)->start().code(), StatusCode::kUnsupported);
  options = options_for("FAKE1");
  options.buffers = 2;
  EXPECT_EQ(make(options)->start().code(), StatusCode::kUnsupported);
  options = options_for("FAKE1");
  options.height_px = 0;
  EXPECT_EQ(make(options)->start().code(), StatusCode::kUnsupported);
  options = options_for("");
  EXPECT_EQ(make(options)->start().code(), StatusCode::kUnsupported);
  EXPECT_EQ(AravisImageSource::buffer_bytes(options_for("FAKE1")), 6U * 512 * 512);
}

TEST_F(AravisImageSourceTest, DeepPixels_KeepTheirHighBits) {
  FakeGigeCamera camera({});
  AravisOptions options = options_for("FAKE1");
  options.pixel_format = "Mono16";
  options.width_px = 256;
  options.height_px = 128;
  auto source = make(options);
  ASSERT_TRUE(source->start().ok());
  ASSERT_TRUE(next(*source, kS, 256, 128).ok());
  // 256 more from pixel to pixel is one more in the high byte.
  for (std::size_t x = 1; x < 200; ++x) EXPECT_LE((pixels_[x] - pixels_[x - 1] + 256) % 256, 2) << x;
}

TEST_F(AravisImageSourceTest, LossyNetwork_CountsTornImagesAndKeepsTheStream) {
  FakeGigeCamera camera({.lost_per_thousand = 2});  // of some 190 packets an image
  auto source = make(options_for("FAKE1"));
  ASSERT_TRUE(source->start().ok());
  EXPECT_EQ(images(*source, 50, 20 * kS), 50);
  EXPECT_GT(faults(*source, ImageFault::kShort), 5U);
  EXPECT_GT(source->health().lost, 5U);
  EXPECT_EQ(source->health().restarts, 0U);
  EXPECT_EQ(log_.count("short image"), 1U);
}

TEST_F(AravisImageSourceTest, SoftwareTrigger_OneImageOfEachCameraForEachFire) {
  FakeGigeCamera one({});
  FakeGigeCamera other({.address = "127.0.0.2", .serial = "FAKE2"});
  AravisOptions options = options_for("FAKE1");
  options.trigger = AravisTrigger::kSoftware;
  auto left = make(options, "left");
  options.key = "FAKE2";
  auto right = make(options, "right");
  ASSERT_TRUE(left->start().ok());
  ASSERT_TRUE(right->start().ok());
  SoftwareTrigger trigger(clocks_);
  ASSERT_TRUE(trigger.add(*left).ok());
  ASSERT_TRUE(trigger.add(*right).ok());
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(next(*left, 5 * kMs).ok()) << "an image that nobody asked for";
    ASSERT_TRUE(trigger.fire().ok());
    ASSERT_TRUE(next(*left, kS).ok()) << i;
    const int64_t left_ns = facts_.exposed.ns;
    ASSERT_TRUE(next(*right, kS).ok()) << i;
    EXPECT_LT(std::abs(facts_.exposed.ns - left_ns), 150 * kMs);  // the fake looks for triggers ten times a second
  }
  EXPECT_EQ(left->health().images, 10U);
  EXPECT_EQ(left->health().restarts, 0U);
}

TEST_F(AravisImageSourceTest, LineTrigger_WaitsWithoutStall) {
  FakeGigeCamera camera({});
  AravisOptions options = options_for("FAKE1");
  options.trigger = AravisTrigger::kLine;
  options.trigger_source = "Line0";
  auto source = make(options);
  ASSERT_TRUE(source->start().ok());
  EXPECT_FALSE(next(*source, 4 * kS).ok());
  EXPECT_EQ(source->health().state, SourceState::kStreaming);
  EXPECT_EQ(source->health().restarts, 0U);
  camera.kill();
  for (int i = 0; i < 100 && source->health().state == SourceState::kStreaming; ++i) {
    EXPECT_FALSE(next(*source, 100 * kMs).ok());
  }
  EXPECT_EQ(source->health().last_fault, ImageFault::kGone) << "nobody misses an image, but somebody looks";
}

TEST_F(AravisImageSourceTest, PtpCamera_IsStampedByTheNetworksClock) {
  const SfncCameraFile description;
  FakeGigeCamera camera({.genicam_file = description.path()});
  AravisOptions options = options_for("FAKE1");
  options.ptp = PtpMode::kEnable;
  options.stamp_point = StampPoint::kExposureStart;
  auto source = make(options);
  ASSERT_TRUE(source->start().ok());
  EXPECT_EQ(images(*source, 10, 2 * kS), 10);
  EXPECT_EQ(source->ptp(), PtpState::kSlave);
  // The fake's clock is the host's real time, as it would be behind a master that keeps UTC.
  EXPECT_EQ(facts_.exposed.clock, ClockId::kRealtime);
  EXPECT_LT(clocks_.read(ClockId::kRealtime).ns - facts_.exposed.ns, 500 * kMs);
  EXPECT_LE(facts_.uncertainty_ns, 1000);
}

TEST_F(AravisImageSourceTest, Stop_GivesTheCameraBackAsItWas) {
  FakeGigeCamera camera({});
  AravisOptions options = options_for("FAKE1");
  options.width_px = options.height_px = 128;
  options.offset_x_px = 16;
  options.exposure_us = 3000;
  options.gain = 2;
  options.frame_rate_hz = 10;
  options.trigger = AravisTrigger::kSoftware;
  auto source = make(options);
  ASSERT_TRUE(source->start().ok());
  source->stop();
  const GObjectPtr<ArvDevice> device(arv_open_device("Aravis-Fake-FAKE1", nullptr));
  ASSERT_TRUE(device);
  Features features;
  features.attach(device.get());
  const auto get = [&](const char* name) { return std::string(features.get(name).view()); };
  EXPECT_EQ(get("Width"), "512");
  EXPECT_EQ(get("Height"), "512");
  EXPECT_EQ(get("OffsetX"), "0");
  EXPECT_EQ(get("ExposureTimeAbs"), "10000");
  EXPECT_EQ(get("GainRaw"), "0");
  EXPECT_EQ(get("AcquisitionFrameRate"), "25");
  EXPECT_EQ(get("TriggerMode"), "Off");
  EXPECT_EQ(get("TriggerSource"), "Line0");
}

TEST_F(AravisImageSourceTest, ActionTrigger_IsRefusedByACameraWithout) {
  FakeGigeCamera camera({});
  AravisOptions options = options_for("FAKE1");
  options.trigger = AravisTrigger::kAction;
  EXPECT_EQ(make(options)->start().code(), StatusCode::kUnsupported);
}

}  // namespace
}  // namespace roomcal::drivers
