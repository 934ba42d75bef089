#include "tools/sweep/pcap.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/refusal.h"
#include "tools/simulate/pcap_writer.h"

namespace roomcal::tools {
namespace {

using test::contains;
using test::refusal;

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span<const char>(text));
  return {bytes.begin(), bytes.end()};
}

TEST(PcapReader, WhatTheWriterWrote_IsReadBack) {
  PcapWriter writer;
  for (const char* text : {"one", "two", "three"}) writer.add(bytes_of(text), 1'700'000'000'123'456'000, 2368);
  PcapReader reader("capture", writer.bytes());
  std::vector<std::byte> all;
  for (Datagram datagram; reader.next(datagram);) {
    EXPECT_EQ(datagram.arrival_ns, 1'700'000'000'123'456'000);
    EXPECT_EQ(datagram.destination_port, 2368);
    all.insert(all.end(), datagram.payload.begin(), datagram.payload.end());
  }
  EXPECT_EQ(all, bytes_of("onetwothree"));
  reader.finish();
  EXPECT_EQ(reader.counters().datagrams, 3U);
}

TEST(PcapReader, SomethingElse_IsNamed) {
  const auto says = [](const std::vector<std::byte>& file, const std::string& part) {
    const std::string got = refusal([&] { PcapReader reader("a.pcap", file); });
    EXPECT_TRUE(contains(got, "a.pcap") && contains(got, part)) << got;
  };
  says({}, "too short");
  says(bytes_of("\x0A\x0D\x0D\x0A, and more of it behind"), "editcap");
  says(bytes_of("This is a shopping list, not a recording."), "no pcap file");
  std::vector<std::byte> wireless = PcapWriter().bytes();
  wireless[20] = std::byte{147};
  says(wireless, "link type 147");
}

}  // namespace
}  // namespace roomcal::tools
