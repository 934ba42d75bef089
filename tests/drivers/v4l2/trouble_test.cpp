#include "drivers/v4l2/trouble.h"

#include <cerrno>

#include <gtest/gtest.h>

namespace roomcal::drivers {
namespace {

using ports::ImageFault;

TEST(Trouble, EveryErrnoOfEveryCall_IsAFaultButForNothingThere) {
  for (int call = 0; call < static_cast<int>(V4l2Call::kCount); ++call) {
    for (int error = 1; error < 4096; ++error) {
      const Trouble trouble = trouble_of(static_cast<V4l2Call>(call), error);
      const bool nothing_there = (static_cast<V4l2Call>(call) == V4l2Call::kDequeue && error == EAGAIN) ||
                                 (static_cast<V4l2Call>(call) == V4l2Call::kEvent && error == ENOENT);
      EXPECT_EQ(trouble.none(), nothing_there) << call << " " << error;
      EXPECT_EQ(trouble.error_number, error);
    }
  }
}

TEST(Trouble, WhatTheFieldTaught_IsInTheTable) {
  const auto fault = [](V4l2Call call, int error) { return trouble_of(call, error).fault; };
  for (int call = 0; call < static_cast<int>(V4l2Call::kCount); ++call) {
    EXPECT_EQ(fault(static_cast<V4l2Call>(call), ENODEV), ImageFault::kGone);
    EXPECT_EQ(fault(static_cast<V4l2Call>(call), ENXIO), ImageFault::kGone);
    EXPECT_EQ(fault(static_cast<V4l2Call>(call), EBUSY), ImageFault::kBusy);
    EXPECT_EQ(fault(static_cast<V4l2Call>(call), ENOMEM), ImageFault::kNoMemory);
    EXPECT_EQ(fault(static_cast<V4l2Call>(call), EIO), ImageFault::kTransient);
  }
  EXPECT_EQ(fault(V4l2Call::kOpen, ENOENT), ImageFault::kNotFound);
  EXPECT_EQ(fault(V4l2Call::kOpen, EACCES), ImageFault::kDenied);
  EXPECT_EQ(fault(V4l2Call::kSetFormat, EINVAL), ImageFault::kFormat);
  EXPECT_EQ(fault(V4l2Call::kStreamOn, ENOSPC), ImageFault::kNoBandwidth);
  EXPECT_EQ(fault(V4l2Call::kStreamOn, EPIPE), ImageFault::kFormat);
  EXPECT_EQ(fault(V4l2Call::kDequeue, EPIPE), ImageFault::kEndOfStream);
  EXPECT_EQ(fault(V4l2Call::kQueue, EINVAL), ImageFault::kStale);
  EXPECT_EQ(fault(V4l2Call::kDequeue, ENOTTY), ImageFault::kStale);
}

TEST(Trouble, NoneByDefault) {
  EXPECT_TRUE(Trouble{}.none());
  EXPECT_EQ(Trouble{}.error_number, 0);
}

}  // namespace
}  // namespace roomcal::drivers
