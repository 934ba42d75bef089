#include <array>
#include <bit>
#include <cmath>
#include <sstream>

#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/common/yaml.h"
#include "tools/sweep/cloud_files.h"
#include "tools/sweep/cloud_numbers.h"

namespace roomcal::tools {

using lidar::Bytes;

namespace {

constexpr std::size_t kMaxHead = 64 * 1024, kMaxFields = 256;

struct TypeName {
  const char* name;
  char type;
  std::size_t bytes;
};
constexpr std::array kTypes = {
    TypeName{"char", 'I', 1},  TypeName{"int8", 'I', 1},    TypeName{"uchar", 'U', 1},  TypeName{"uint8", 'U', 1},
    TypeName{"short", 'I', 2}, TypeName{"int16", 'I', 2},   TypeName{"ushort", 'U', 2}, TypeName{"uint16", 'U', 2},
    TypeName{"int", 'I', 4},   TypeName{"int32", 'I', 4},   TypeName{"uint", 'U', 4},   TypeName{"uint32", 'U', 4},
    TypeName{"float", 'F', 4}, TypeName{"float32", 'F', 4}, TypeName{"double", 'F', 8}, TypeName{"float64", 'F', 8},
};

struct PlyHead {
  std::string format;
  std::vector<CloudField> fields;  ///< of the vertices
  std::size_t points = 0, body_at = 0;
};

class PlyHeadReader {
 public:
  PlyHeadReader(const std::string& name, Bytes bytes)
      : name_(name), text_(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), kMaxHead)) {}

  PlyHead read() {
    std::size_t at = 0;
    for (std::string key; key != "end_header";) {
      const std::size_t end = text_.find('\n', at);
      if (end == std::string::npos) fail("the head has no end_header");
      std::istringstream line(text_.substr(at, end - at));
      at = end + 1;
      key.clear();
      line >> key;
      take_line(key, line);
    }
    head_.body_at = at;
    if (!vertices_) fail("the head has no element vertex");
    if (head_.fields.empty()) fail("the vertices have no properties");
    return head_;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw ToolError(name_ + ": " + what); }

  void take_line(const std::string& key, std::istringstream& line) {
    std::string a, b;
    if (key == "format") {
      line >> head_.format;
    } else if (key == "element") {
      line >> a >> b;
      take_element(a, b);
    } else if (key == "property" && in_vertex_) {
      line >> a >> b;
      take_property(a, b);
    }
  }

  void take_element(const std::string& element, const std::string& count) {
    in_vertex_ = element == "vertex";
    if (!in_vertex_) {
      if (!vertices_)
        fail(fmt::format("element `{}` stands before the vertices; put them first", element.substr(0, 40)));
      return;
    }
    if (vertices_) fail("element vertex stands twice");
    vertices_ = true;
    double value = 0;
    if (!parse_finite(count, value) || value < 0 || value > kMaxCloudPoints || value != std::floor(value))
      fail("the number of vertices is not understood");
    head_.points = static_cast<std::size_t>(value);
  }

  void take_property(const std::string& type, const std::string& field) {
    if (head_.fields.size() == kMaxFields) fail("too many properties");
    for (const TypeName& known : kTypes) {
      if (type != known.name) continue;
      head_.fields.push_back({field, known.type, known.bytes, 1});
      return;
    }
    fail(fmt::format("property type `{}` is not read for vertices", type.substr(0, 40)));
  }

  const std::string& name_;
  std::string text_;
  PlyHead head_;
  bool in_vertex_ = false, vertices_ = false;
};

CloudTable from_text(const std::string& name, const PlyHead& head, Bytes body) {
  CloudTable table{head.fields, std::vector<std::vector<double>>(head.fields.size()), head.points};
  CloudTextReader reader(name, body);
  for (std::size_t i = 0; i < head.points; ++i)
    for (std::vector<double>& column : table.values) column.push_back(reader.number());
  return table;
}

CloudTable from_binary(const std::string& name, const PlyHead& head, Bytes body, std::endian order) {
  std::size_t stride = 0;
  for (const CloudField& field : head.fields) stride += field.bytes;
  if (body.size() / stride < head.points)
    throw ToolError(fmt::format("{}: ends after {} of {} points", name, body.size() / stride, head.points));
  CloudTable table{head.fields, std::vector<std::vector<double>>(head.fields.size()), head.points};
  for (std::size_t i = 0, at = 0; i < head.points; ++i) {
    for (std::size_t f = 0; f < head.fields.size(); at += head.fields[f++].bytes)
      table.values[f].push_back(read_cloud_number(body.subspan(at, head.fields[f].bytes), head.fields[f].type, order));
  }
  return table;
}

}  // namespace

CloudTable parse_ply(const std::string& name, Bytes bytes) {
  const PlyHead head = PlyHeadReader(name, bytes).read();
  const Bytes body = bytes.subspan(head.body_at);
  if (head.format == "ascii") return from_text(name, head, body);
  if (head.format == "binary_little_endian") return from_binary(name, head, body, std::endian::little);
  if (head.format == "binary_big_endian") return from_binary(name, head, body, std::endian::big);
  throw ToolError(name + ": the format is none of ascii, binary_little_endian, binary_big_endian");
}

}  // namespace roomcal::tools
