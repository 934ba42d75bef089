// Images that a driver should not have given: damaged, short, of a wrong buffer, wrongly stamped.

#include <gtest/gtest.h>

#include "drivers/v4l2/v4l2_image_source.h"
#include "tests/drivers/v4l2/rig.h"

namespace roomcal::drivers::test {
namespace {

using ports::ImageFault;
using ports::SourceState;

TEST(V4l2BadImages, BuffersMarkedDamaged_AreDroppedAndThreeInARowRestart) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(rig.next().ok());
    rig.camera.damage_flags = V4L2_BUF_FLAG_ERROR;
    rig.clocks.advance_to(rig.clocks.now_ns() + 34 * kMs);
    static_cast<void>(rig.next(0));
    rig.camera.damage_flags = 0;
  }
  EXPECT_EQ(rig.faults(ImageFault::kMarkedDamaged), 20U);
  EXPECT_EQ(rig.source().health().restarts, 0U);
  EXPECT_EQ(rig.source().health().lost, 0U);  // they came
  EXPECT_EQ(rig.lines.with("marked damaged"), 1);
  ASSERT_TRUE(rig.next().ok());
  rig.camera.damage_flags = V4L2_BUF_FLAG_ERROR;
  for (int i = 0; rig.source().health().restarts == 0 && i < 100; ++i) EXPECT_FALSE(rig.next(10 * kMs).ok());
  EXPECT_EQ(rig.faults(ImageFault::kMarkedDamaged), 23U);
}

TEST(V4l2BadImages, ImagesOneByteShort_AreNeverHandedOver) {
  Rig rig;
  rig.camera.missing_bytes = 1;
  ASSERT_TRUE(rig.source().start().ok());
  EXPECT_EQ(rig.images(2 * kS), 0);
  EXPECT_GE(rig.faults(ImageFault::kShort), 3U);
  EXPECT_EQ(rig.faults(ImageFault::kStall), 0U);
}

TEST(V4l2BadImages, BufferThatIsNotThere_Restarts) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.camera.returned_index = 100;
  while (rig.source().health().restarts == 0) static_cast<void>(rig.next(10 * kMs));
  EXPECT_EQ(rig.faults(ImageFault::kUnknownBuffer), 1U);
  rig.camera.returned_index = -1;
  EXPECT_GT(rig.images(kS), 20);
}

TEST(V4l2BadImages, SameBufferTwice_Restarts) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.camera.returned_index = 2;
  rig.clocks.advance_to(rig.clocks.now_ns() + 70 * kMs);  // two images, both said to be in buffer 2
  static_cast<void>(rig.next(0));
  rig.camera.returned_index = -1;
  EXPECT_EQ(rig.faults(ImageFault::kUnknownBuffer), 1U);
  EXPECT_GT(rig.images(kS), 20);
  EXPECT_EQ(rig.source().health().restarts, 1U);
  EXPECT_EQ(rig.state(), SourceState::kStreaming);
}

TEST(V4l2BadImages, StampsThatCannotBeBelieved_ImagesAreStampedByTheirArrival) {
  struct {
    ImageFault fault;
    void (*spoil)(FakeCamera&);
  } const cases[] = {
      {ImageFault::kStampFrozen, [](FakeCamera& c) { c.frozen_stamp = true; }},
      {ImageFault::kStampFuture, [](FakeCamera& c) { c.stamp_offset_ns = 5 * kS; }},
      {ImageFault::kStampTai, [](FakeCamera& c) { c.stamp_offset_ns = 37 * kS; }},
      {ImageFault::kStampUnknown, [](FakeCamera& c) { c.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_COPY; }},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(to_string(c.fault));
    Rig rig;
    ASSERT_TRUE(rig.source().start().ok());
    ASSERT_TRUE(rig.next().ok());
    c.spoil(rig.camera);
    for (int i = 0; i < 10; ++i) {
      ASSERT_TRUE(rig.next().ok());
      const int64_t complete_ns = rig.facts.arrived_ns;
      EXPECT_EQ(rig.facts.exposed.clock, ClockId::kMonotonic);
      EXPECT_LE(rig.facts.exposed.ns, complete_ns);
      EXPECT_LT(rig.facts.uncertainty_ns, 100 * kMs);
      EXPECT_GE(rig.facts.exposed.ns + rig.facts.uncertainty_ns, complete_ns - 1);  // it may have begun just now
    }
    EXPECT_EQ(rig.faults(c.fault), 10U);
    EXPECT_EQ(rig.state(), SourceState::kStreaming);
    EXPECT_EQ(rig.lines.with(to_string(c.fault)), 1);
  }
}

TEST(V4l2BadImages, StampsGoBackOnce_OnlyThatOneIsDoubted) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.camera.stamp_offset_ns = -50 * kMs;
  ASSERT_TRUE(rig.next().ok());
  rig.camera.stamp_offset_ns = 0;
  ASSERT_TRUE(rig.next().ok());
  EXPECT_EQ(rig.faults(ImageFault::kStampBackwards), 1U);
}

TEST(V4l2BadImages, SameStampAndNumberAsBefore_IsNotHandedOverTwice) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.camera.frozen_stamp = rig.camera.frozen_sequence = true;
  rig.images(kS);
  const uint64_t images = rig.source().health().images;
  EXPECT_LE(images, 4U);
  EXPECT_GT(rig.faults(ImageFault::kStampFrozen), 5U);
  EXPECT_GE(rig.faults(ImageFault::kStall), 1U);
}

TEST(V4l2BadImages, ImagesThatComeLate_AreNotHandedOver) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.camera.stamp_offset_ns = -2 * kS;
  EXPECT_EQ(rig.images(400 * kMs), 0);
  EXPECT_GT(rig.faults(ImageFault::kStampOld), 5U);
}

}  // namespace
}  // namespace roomcal::drivers::test
