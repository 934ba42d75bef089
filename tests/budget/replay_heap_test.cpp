// Replayed sensors make no heap call once their files are read, and none to read them.

#include <vector>

#include "drivers/replay/replay_image_source.h"
#include "drivers/replay/replay_packet_source.h"
#include "tests/budget/heap_guard.h"
#include "tests/drivers/replay/replay_folder.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

struct NoLog final : ports::Log {
  void note(std::string_view /*who*/, std::string_view /*what*/) override {}
};

struct Count final : ports::PacketVisitor {
  void take(const ports::Packet& /*packet*/) override { ++packets; }
  std::size_t packets = 0;
};

class ReplayHeap : public test::ReplayFolder {};

TEST_F(ReplayHeap, FromFilesToTheNextShot_NoCall) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer brings its own allocator";
#endif
  for (const char* shot : {"shot000", "shot001"}) {
    write_pgm(std::string(shot) + "/cam0.pgm", 64, 48, 0);
    write_pcap(std::string(shot) + "/lidar0.pcap", {0, 50'000}, 0);
  }
  const FolderPath folder = path();
  std::vector<std::byte> image_memory(2 * 64 * 48), packet_memory(200'000);
  std::vector<uint8_t> pixels(64 * 48);
  std::size_t calls = 0, images = 0;
  bool ok = true;
  Count count;
  {
    const budget::HeapGuard guard;
    fakes::ManualClocks clocks;
    NoLog log;
    ReplayCursor cursor;
    ok = cursor.open(folder, clocks.now_ns()).ok();
    ReplayImageSource camera({"cam0", 64, 48, 100'000'000}, cursor, clocks, log, image_memory);
    ReplayPacketSource lidar({"lidar0"}, cursor, clocks, packet_memory);
    ok = ok && camera.start().ok() && lidar.start().ok();
    for (int i = 0; i < 20; ++i) {
      ports::ImageFacts facts;
      images += camera.next(200'000'000, MutableImageView(pixels.data(), 64, 48), facts).ok() ? 1 : 0;
      lidar.drain(count);
      if (i % 5 == 4) cursor.advance(clocks.now_ns());
    }
    calls = guard.calls();
  }
  EXPECT_TRUE(ok);
  EXPECT_EQ(images, 20U);
  EXPECT_GT(count.packets, 20U);
  EXPECT_EQ(calls, 0U);
}

}  // namespace
}  // namespace roomcal::drivers
