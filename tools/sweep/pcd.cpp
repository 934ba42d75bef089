#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <sstream>

#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/common/yaml.h"
#include "tools/sweep/cloud_files.h"
#include "tools/sweep/cloud_numbers.h"

namespace roomcal::tools {

using lidar::Bytes;

namespace {

constexpr std::size_t kMaxHead = 64 * 1024;

struct PcdHead {
  std::vector<CloudField> fields;
  std::size_t points = 0, width = 0, height = 1;
  std::string data;
  std::size_t body_at = 0;
};

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

class PcdHeadReader {
 public:
  PcdHeadReader(const std::string& name, Bytes bytes)
      : name_(name), text_(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), kMaxHead)) {}

  PcdHead read() {
    std::size_t at = 0;
    while (head_.data.empty()) {
      const std::size_t end = text_.find('\n', at);
      if (end == std::string::npos) fail("the head has no DATA line");
      take_line(words_of(text_.substr(at, end - at)));
      at = end + 1;
    }
    head_.body_at = at;
    if (head_.fields.empty()) fail("the head has no FIELDS");
    if (head_.points == 0) head_.points = head_.width * head_.height;
    if (head_.points > kMaxCloudPoints) fail("more points than any sweep has; is this one cloud?");
    return head_;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw ToolError(name_ + ": " + what); }

  std::size_t whole(const std::string& word, std::size_t most) const {
    double value = 0;
    if (!parse_finite(word, value) || value < 0 || value > static_cast<double>(most) || value != std::floor(value))
      fail(fmt::format("`{}` is not a whole number of 0 to {}", word, most));
    return static_cast<std::size_t>(value);
  }

  void take_line(const std::vector<std::string>& words) {
    if (words.empty() || words[0][0] == '#') return;
    if (words[0] == "FIELDS") {
      head_.fields.assign(words.size() - 1, {});
      for (std::size_t i = 1; i < words.size(); ++i) head_.fields[i - 1].name = words[i];
    } else if (words[0] == "SIZE" || words[0] == "TYPE" || words[0] == "COUNT") {
      if (words.size() - 1 != head_.fields.size()) fail(words[0] + " and FIELDS have different lengths");
      for (std::size_t i = 1; i < words.size(); ++i) take_column(words[0], words[i], head_.fields[i - 1]);
    } else if (words.size() == 2 && words[0] == "WIDTH") {
      head_.width = whole(words[1], kMaxCloudPoints);
    } else if (words.size() == 2 && words[0] == "HEIGHT") {
      head_.height = whole(words[1], kMaxCloudPoints);
    } else if (words.size() == 2 && words[0] == "POINTS") {
      head_.points = whole(words[1], kMaxCloudPoints);
    } else if (words.size() == 2 && words[0] == "DATA") {
      head_.data = words[1];
    } else if (words[0] != "VERSION" && words[0] != "VIEWPOINT") {
      fail(fmt::format("`{}` is no line of a PCD head", words[0].substr(0, 40)));
    }
  }

  void take_column(const std::string& key, const std::string& word, CloudField& field) const {
    if (key == "SIZE") field.bytes = whole(word, 8);
    if (key == "COUNT") field.count = whole(word, 4096);
    if (key == "TYPE") field.type = word.size() == 1 ? word[0] : '?';
    const bool size_ok = field.bytes == 1 || field.bytes == 2 || field.bytes == 4 || field.bytes == 8;
    if (!size_ok || field.count == 0 || (field.type != 'F' && field.type != 'I' && field.type != 'U'))
      fail(fmt::format("field `{}`: {} {} is not understood", field.name, key, word));
  }

  const std::string& name_;
  std::string text_;
  PcdHead head_;
};

/// Binary: point after point. Compressed: field after field.
CloudTable from_binary(const std::string& name, const PcdHead& head, Bytes body, bool by_field) {
  std::size_t stride = 0;
  for (const CloudField& field : head.fields) stride += field.bytes * field.count;
  if (body.size() / stride < head.points)
    throw ToolError(fmt::format("{}: ends after {} of {} points", name, body.size() / stride, head.points));
  CloudTable table{head.fields, std::vector<std::vector<double>>(head.fields.size()), head.points};
  std::size_t before = 0;
  for (std::size_t f = 0; f < head.fields.size(); ++f) {
    const CloudField& field = head.fields[f];
    const std::size_t size = field.bytes * field.count;
    table.values[f].resize(head.points);
    for (std::size_t i = 0; i < head.points; ++i) {
      const std::size_t at = by_field ? before * head.points + i * size : i * stride + before;
      table.values[f][i] = read_cloud_number(body.subspan(at, field.bytes), field.type, std::endian::little);
    }
    before += size;
  }
  return table;
}

CloudTable from_compressed(const std::string& name, const PcdHead& head, Bytes body) {
  if (body.size() < 8) throw ToolError(name + ": the compressed part has no sizes");
  const std::size_t packed = lidar::le32(body, 0), size = lidar::le32(body, 4);
  // LZF packs at most 264 bytes into 3.
  if (packed > body.size() - 8 || size > 100 * packed + 1)
    throw ToolError(name + ": the compressed part is shorter than it says");
  std::vector<std::byte> plain(size);
  if (!lzf_decompress(body.subspan(8, packed), plain)) throw ToolError(name + ": the compressed part is damaged");
  return from_binary(name, head, plain, true);
}

CloudTable from_text(const std::string& name, const PcdHead& head, Bytes body) {
  CloudTable table{head.fields, std::vector<std::vector<double>>(head.fields.size()), head.points};
  CloudTextReader reader(name, body);
  for (std::size_t i = 0; i < head.points; ++i) {
    for (std::size_t f = 0; f < head.fields.size(); ++f) {
      const double first = reader.number();
      for (std::size_t k = 1; k < head.fields[f].count; ++k) static_cast<void>(reader.number());
      table.values[f].push_back(first);
    }
  }
  return table;
}

}  // namespace

CloudTable parse_pcd(const std::string& name, Bytes bytes) {
  const PcdHead head = PcdHeadReader(name, bytes).read();
  const Bytes body = bytes.subspan(head.body_at);
  if (head.data == "ascii") return from_text(name, head, body);
  if (head.data == "binary") return from_binary(name, head, body, false);
  if (head.data == "binary_compressed") return from_compressed(name, head, body);
  throw ToolError(
      fmt::format("{}: DATA {} is not read; ascii, binary, binary_compressed are", name, head.data.substr(0, 40)));
}

/// M. Lehmann, liblzf: literal runs (control < 32) and references of 3 to 264 bytes, up to 8 kB back.
bool lzf_decompress(Bytes in, std::span<std::byte> out) {
  std::size_t from = 0, to = 0;
  while (from < in.size()) {
    const std::size_t control = lidar::u8(in, from++);
    if (control < 32) {
      const std::size_t count = control + 1;
      if (count > in.size() - from || count > out.size() - to) return false;
      std::copy_n(in.begin() + static_cast<std::ptrdiff_t>(from), count, out.begin() + static_cast<std::ptrdiff_t>(to));
      from += count;
      to += count;
      continue;
    }
    std::size_t count = control >> 5;
    if (count == 7) {
      if (from == in.size()) return false;
      count += lidar::u8(in, from++);
    }
    count += 2;
    if (from == in.size()) return false;
    const std::size_t back = ((control & 31) << 8 | lidar::u8(in, from++)) + 1;
    if (back > to || count > out.size() - to) return false;
    for (std::size_t i = 0; i < count; ++i, ++to) out[to] = out[to - back];  // byte by byte: runs overlap
  }
  return to == out.size();
}

namespace {

struct PcdPoint {
  float x, y, z, range, azimuth;
  int32_t offset_ns;
  uint16_t beam, reflectivity;
  uint32_t sweep;
  uint32_t return_index;
};
static_assert(sizeof(PcdPoint) == 36 && std::endian::native == std::endian::little);

}  // namespace

std::vector<std::byte> write_pcd(std::span<const LoadedSweep> sweeps) {
  std::size_t points = 0;
  for (const LoadedSweep& sweep : sweeps) points += sweep.points.size();
  const std::string head = fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
      "FIELDS x y z range azimuth offset_ns beam reflectivity sweep return_index\nSIZE 4 4 4 4 4 4 2 2 4 4\n"
      "TYPE F F F F F I U U U U\nCOUNT 1 1 1 1 1 1 1 1 1 1\nWIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\n"
      "DATA binary\n",
      points);
  std::vector<std::byte> bytes(head.size() + points * sizeof(PcdPoint));
  std::memcpy(bytes.data(), head.data(), head.size());
  std::size_t at = head.size();
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    for (const lidar::SweepPoint& p : sweeps[i].points) {
      const PcdPoint point = {p.x_m,         p.y_m,          p.z_m,
                              p.range_m,     p.azimuth_rad,  p.offset_ns,
                              p.beam,        p.reflectivity, static_cast<uint32_t>(i),
                              p.return_index};
      std::memcpy(bytes.data() + at, &point, sizeof point);
      at += sizeof point;
    }
  }
  return bytes;
}

}  // namespace roomcal::tools
