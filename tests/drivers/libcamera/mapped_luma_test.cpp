#include "drivers/libcamera/mapped_luma.h"

#include <cstring>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include "drivers/os/unique_fd.h"

namespace roomcal::drivers {
namespace {

using Plane = libcamera::FrameBuffer::Plane;

// A file in memory is mapped like a dma-buf, only that it needs no synchronization.
UniqueFd file_with(std::string_view text) {
  UniqueFd file(::memfd_create("luma", MFD_CLOEXEC));
  EXPECT_EQ(::write(file.get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
  return file;
}

Plane plane(const UniqueFd& file, unsigned int offset, unsigned int length) {
  Plane plane;
  plane.fd = libcamera::SharedFD(file.get());
  plane.offset = offset;
  plane.length = length;
  return plane;
}

std::string text_of(const MappedLuma& map) {
  std::string text(map.bytes().size(), '\0');
  std::memcpy(text.data(), map.bytes().data(), text.size());
  return text;
}

TEST(MappedLuma, FirstPlane_IsSeen) {
  const UniqueFd file = file_with("LUMAchroma");
  const std::vector<Plane> planes{plane(file, 0, 4), plane(file, 4, 6)};
  const libcamera::FrameBuffer buffer(planes);
  MappedLuma map;
  ASSERT_TRUE(map.map(buffer));
  map.begin_read();
  EXPECT_EQ(text_of(map), "LUMA");
  map.end_read();
}

TEST(MappedLuma, PlaneThatBeginsWithinAPage_IsSeenFromThere) {
  const UniqueFd file = file_with("headLUMA");
  const std::vector<Plane> planes{plane(file, 4, 4)};
  MappedLuma map;
  ASSERT_TRUE(map.map(libcamera::FrameBuffer(planes)));
  EXPECT_EQ(text_of(map), "LUMA");
}

TEST(MappedLuma, BufferThatCannotBeMapped_IsNone) {
  MappedLuma map;
  EXPECT_FALSE(map.map(libcamera::FrameBuffer(std::vector<Plane>{})));
  const UniqueFd file = file_with("x");
  std::vector<Plane> closed{plane(file, 0, 1)};
  closed[0].fd = libcamera::SharedFD();
  EXPECT_FALSE(map.map(libcamera::FrameBuffer(closed)));
  EXPECT_TRUE(map.bytes().empty());
}

}  // namespace
}  // namespace roomcal::drivers
