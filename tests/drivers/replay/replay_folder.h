#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/replay/replay_cursor.h"
#include "tests/drivers/folder_of_test.h"

namespace roomcal::drivers::test {

/// A folder with images and recordings.
class ReplayFolder : public FolderOfTest {
 protected:
  FolderPath path() const { return std::string_view(folder_.string()); }
  /// A PGM whose pixels count up from `first`.
  void write_pgm(const std::string& file, int width, int height, int first) const {
    std::string bytes = "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n";
    for (int i = 0; i < width * height; ++i) bytes.push_back(static_cast<char>(first + i));
    write(file, bytes);
  }
  /// A pcap of raw IPv4: one datagram a stamp, each of one byte, which counts up from `first`.
  void write_pcap(const std::string& file, const std::vector<int64_t>& stamps_us, int first, int port = 2368) const {
    std::string out;
    for (const uint32_t word : {0xA1B2C3D4U, 0x00040002U, 0U, 0U, 65535U, 101U}) put(out, word, 4);
    for (const int64_t us : stamps_us) {
      put(out, static_cast<uint64_t>(us / 1'000'000), 4);
      put(out, static_cast<uint64_t>(us % 1'000'000), 4);
      for (int i = 0; i < 2; ++i) put(out, 29, 4);
      const std::string head("\x45\0\0\x1D\0\0\0\0\x40\x11\0\0\x0A\0\0\1\x0A\0\0\2", 20);
      out += head;
      for (const int word : {2368, port, 9, 0}) put_be(out, word);
      out.push_back(static_cast<char>(first++));
    }
    write(file, out);
  }

 private:
  static void put(std::string& out, uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) out.push_back(static_cast<char>(value >> (8 * i)));
  }
  static void put_be(std::string& out, int value) {
    out.push_back(static_cast<char>(value >> 8));
    out.push_back(static_cast<char>(value));
  }
};

}  // namespace roomcal::drivers::test
