#include "runtime/lidar/pcap.h"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal::lidar {
namespace {

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span<const char>(text));
  return {bytes.begin(), bytes.end()};
}

/// A frame at a time, of any link type, order and fraction.
class Capture {
 public:
  Capture(uint32_t magic, uint32_t link, bool big) : big_(big) {
    for (const uint32_t word : {magic, big ? 0x00020004U : 0x00040002U, 0U, 0U, 65535U, link}) put(word);
  }
  void frame(const std::vector<std::byte>& bytes, uint32_t seconds = 5, uint32_t fraction = 7) {
    put(seconds);
    put(fraction);
    put(static_cast<uint32_t>(bytes.size()));
    put(static_cast<uint32_t>(bytes.size()));
    out.insert(out.end(), bytes.begin(), bytes.end());
  }
  std::vector<std::byte> out;

 private:
  void put(uint32_t word) {
    for (int i = 0; i < 4; ++i) out.push_back(static_cast<std::byte>(word >> 8 * (big_ ? 3 - i : i)));
  }
  bool big_;
};

void be(std::vector<std::byte>& out, uint32_t value, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) out.push_back(static_cast<std::byte>(value >> (8 * i)));
}

std::vector<std::byte> udp(const std::string& payload) {
  std::vector<std::byte> out;
  be(out, 2368, 2);
  be(out, 2369, 2);
  be(out, static_cast<uint32_t>(8 + payload.size()), 2);
  be(out, 0, 2);
  const auto bytes = bytes_of(payload);
  out.insert(out.end(), bytes.begin(), bytes.end());
  return out;
}

std::vector<std::byte> ipv4(std::span<const std::byte> body, uint16_t fragment = 0, uint8_t protocol = 17) {
  std::vector<std::byte> out;
  be(out, 0x4500, 2);
  be(out, static_cast<uint32_t>(20 + body.size()), 2);
  be(out, 0x1234, 2);
  be(out, fragment, 2);
  be(out, 64, 1);
  be(out, protocol, 1);
  be(out, 0, 2);
  be(out, 0x0A000001, 4);
  be(out, 0x0A000002, 4);
  out.insert(out.end(), body.begin(), body.end());
  return out;
}

std::vector<std::byte> behind(std::size_t zeros, std::initializer_list<uint16_t> words,
                              std::span<const std::byte> packet) {
  std::vector<std::byte> out(zeros);
  for (const uint16_t word : words) be(out, word, 2);
  out.insert(out.end(), packet.begin(), packet.end());
  return out;
}

std::vector<std::string> payloads(const std::vector<std::byte>& file, PcapCounters* counters = nullptr) {
  const auto fragments = std::make_unique<IpFragments>();
  PcapReader reader = PcapReader::open(file, *fragments).value();
  std::vector<std::string> result;
  Datagram datagram;
  while (reader.next(datagram))
    result.emplace_back(reinterpret_cast<const char*>(datagram.payload.data()), datagram.payload.size());
  reader.finish();
  if (counters != nullptr) *counters = reader.counters();
  return result;
}

using Texts = std::vector<std::string>;

TEST(PcapReader, EveryOrderAndFraction_GivesPayloadPortsAndStamp) {
  for (const bool big : {false, true}) {
    for (const bool nano : {false, true}) {
      Capture capture(nano ? 0xA1B23C4D : 0xA1B2C3D4, 1, big);
      capture.frame(behind(12, {0x0800}, ipv4(udp("hello"))));
      const auto fragments = std::make_unique<IpFragments>();
      PcapReader reader = PcapReader::open(capture.out, *fragments).value();
      Datagram datagram;
      ASSERT_TRUE(reader.next(datagram));
      EXPECT_EQ(datagram.payload.size(), 5U);
      EXPECT_EQ(datagram.source_port, 2368);
      EXPECT_EQ(datagram.destination_port, 2369);
      EXPECT_EQ(datagram.arrival_ns, 5'000'000'000 + (nano ? 7 : 7000));
      EXPECT_FALSE(reader.next(datagram));
    }
  }
}

TEST(PcapReader, EveryLinkType_IsStripped) {
  const auto packet = ipv4(udp("hello"));
  const auto expect = [&](uint32_t link, const std::vector<std::byte>& frame) {
    Capture capture(0xA1B2C3D4, link, false);
    capture.frame(frame);
    EXPECT_EQ(payloads(capture.out), Texts{"hello"}) << "link type " << link;
  };
  expect(1, behind(12, {0x0800}, packet));
  expect(1, behind(12, {0x8100, 7, 0x0800}, packet));
  expect(1, behind(12, {0x88A8, 7, 0x8100, 9, 0x0800}, packet));
  expect(113, behind(14, {0x0800}, packet));
  expect(276, behind(0, {0x0800, 0, 0, 0, 0, 0, 0, 0, 0, 0}, packet));
  expect(101, packet);
  expect(228, packet);
  expect(0, behind(4, {}, packet));
  std::vector<std::byte> six;
  be(six, 0x60000000, 4);
  be(six, 13, 2);
  be(six, 17 << 8 | 64, 2);
  six.resize(40);
  const auto body = udp("hello");
  six.insert(six.end(), body.begin(), body.end());
  expect(101, six);
}

TEST(PcapReader, Fragments_ArePutTogetherInAnyOrder) {
  const auto whole = udp(std::string(3000, 'x') + "end");
  const std::span<const std::byte> all = whole;
  const std::vector<std::vector<std::byte>> pieces = {
      ipv4(all.subspan(0, 1480), 0x2000), ipv4(all.subspan(1480, 1480), 0x2000 | 185), ipv4(all.subspan(2960), 370)};
  for (const auto& order : {std::vector{0, 1, 2}, std::vector{2, 0, 1}, std::vector{1, 1, 0, 2}}) {
    Capture capture(0xA1B2C3D4, 101, false);
    for (const int i : order) capture.frame(pieces[static_cast<std::size_t>(i)]);
    ASSERT_EQ(payloads(capture.out).size(), 1U);
    EXPECT_EQ(payloads(capture.out)[0], std::string(3000, 'x') + "end");
  }
  Capture capture(0xA1B2C3D4, 101, false);
  capture.frame(pieces[0]);
  capture.frame(pieces[2]);
  PcapCounters counters;
  EXPECT_TRUE(payloads(capture.out, &counters).empty());
  EXPECT_EQ(counters.unfinished, 1U);
}

TEST(PcapReader, WhatIsNotUdp_IsCountedByKind) {
  Capture capture(0xA1B2C3D4, 1, false);
  capture.frame(behind(12, {0x0806}, bytes_of("who has")));
  capture.frame(behind(12, {0x0800}, ipv4(udp("tcp really"), 0, 6)));
  capture.frame(std::vector<std::byte>(5));
  auto liar = ipv4(udp("long"));
  liar[25] = std::byte{200};  // UDP length
  capture.frame(behind(12, {0x0800}, liar));
  capture.frame(behind(12, {0x0800}, ipv4(udp("good"))));
  PcapCounters counters;
  EXPECT_EQ(payloads(capture.out, &counters), Texts{"good"});
  EXPECT_EQ(counters.not_ip, 1U);
  EXPECT_EQ(counters.not_udp, 1U);
  EXPECT_EQ(counters.malformed, 2U);
}

TEST(PcapReader, IpLengthBeyondTheFrame_TheUdpLengthDecides) {
  Capture capture(0xA1B2C3D4, 1, false);
  auto packet = ipv4(udp("position"));
  packet[2] = std::byte{4};
  capture.frame(behind(12, {0x0800}, packet));
  EXPECT_EQ(payloads(capture.out), Texts{"position"});
}

TEST(PcapReader, CutAnywhere_GivesTheWholeFramesBeforeIt) {
  Capture capture(0xA1B2C3D4, 101, false);
  for (int i = 0; i < 3; ++i) capture.frame(ipv4(udp("payload")));
  const std::size_t frame = (capture.out.size() - 24) / 3;
  for (std::size_t size = 24; size <= capture.out.size(); ++size) {
    PcapCounters counters;
    const std::vector<std::byte> cut(capture.out.begin(), capture.out.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(payloads(cut, &counters).size(), (size - 24) / frame);
    EXPECT_EQ(counters.truncated, (size - 24) % frame != 0);
  }
}

TEST(PcapReader, Rewound_GivesTheSameAgain) {
  Capture capture(0xA1B2C3D4, 101, false);
  for (const char* text : {"one", "two"}) capture.frame(ipv4(udp(text)));
  const auto fragments = std::make_unique<IpFragments>();
  PcapReader reader = PcapReader::open(capture.out, *fragments).value();
  Datagram datagram;
  for (int i = 0; i < 2; ++i) {
    std::size_t bytes = 0;
    while (reader.next(datagram)) bytes += datagram.payload.size();
    EXPECT_EQ(bytes, 6U);
    reader.rewind();
  }
  EXPECT_EQ(reader.counters().datagrams, 4U);
  PcapReader unopened;
  unopened.rewind();
  EXPECT_FALSE(unopened.next(datagram));
}

TEST(PcapReader, SomethingElse_IsRefused) {
  const auto fragments = std::make_unique<IpFragments>();
  const auto answer = [&](const std::vector<std::byte>& file) {
    return PcapReader::open(file, *fragments).status().code();
  };
  EXPECT_EQ(answer({}), StatusCode::kCorrupt);
  EXPECT_EQ(answer(bytes_of("\x0A\x0D\x0D\x0A, and more of it behind")), StatusCode::kUnsupported);
  EXPECT_EQ(answer(bytes_of("This is a shopping list, not a recording.")), StatusCode::kCorrupt);
  EXPECT_EQ(answer(Capture(0xA1B2C3D4, 147, false).out), StatusCode::kUnsupported);
}

}  // namespace
}  // namespace roomcal::lidar
