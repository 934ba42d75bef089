#include <cstring>
#include <memory>

#include "runtime/lidar/pcap.h"

// Whatever the file is, payloads lie within it or within the memory for fragments, and every frame is accounted for.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  using namespace roomcal::lidar;
  // A heap block of exactly this size, so that reading one byte too far is seen.
  const std::unique_ptr<std::byte[]> file(new std::byte[size]);
  if (size > 0) std::memcpy(file.get(), data, size);
  const auto fragments = std::make_unique<IpFragments>();
  auto opened = PcapReader::open({file.get(), size}, *fragments);
  if (!opened.ok()) return 0;
  PcapReader& reader = opened.value();
  for (int pass = 0; pass < 2; ++pass) {
    for (Datagram datagram; reader.next(datagram);) {
      uint32_t sum = 0;
      for (const std::byte b : datagram.payload) sum += std::to_integer<uint32_t>(b);
      if (datagram.payload.size() > 65527 || sum > 255 * datagram.payload.size()) __builtin_trap();
    }
    reader.rewind();
  }
  reader.finish();
  const PcapCounters& counters = reader.counters();
  const uint64_t told = counters.datagrams + counters.not_ip + counters.not_udp + counters.malformed;
  if (told > counters.frames || told + counters.fragments < counters.frames) __builtin_trap();
  if (counters.unfinished > counters.fragments) __builtin_trap();
  return 0;
}
