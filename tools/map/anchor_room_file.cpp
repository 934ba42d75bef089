#include "tools/map/anchor_room_file.h"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <unordered_map>
#include <utility>

#include <fmt/core.h>

#include "tools/common/error.h"

namespace roomcal::tools {
namespace {

using Projections = std::vector<double>;  // frame, key point, frame, key point ...

class Reader {
 public:
  Reader(const std::string& name, const std::string& text) : name_(name), rest_(text) {}

  AnchorRoom read() {
    while (next_line()) take_line();
    if (room_.point_room.empty()) fail("no MapPoints: not a map of the paper's authors?");
    if (room_.frames.empty()) fail("no FramePoses: not a map of the paper's authors?");
    for (const AnchorFrame& frame : room_.frames) check(frame);
    link();
    return std::move(room_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw ToolError(fmt::format("{}:{}: {}", name_, line_number_, what));
  }

  bool next_line() {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line_ = rest_.substr(0, end);
    rest_ = end == std::string_view::npos ? std::string_view{} : rest_.substr(end + 1);
    ++line_number_;
    return true;
  }

  void take_line() {
    const std::size_t indent = line_.find_first_not_of(' ');
    if (indent == std::string_view::npos || line_[indent] == '#') return;
    const std::size_t colon = line_.find(':', indent);
    if (colon == std::string_view::npos) fail("expected `key: value`");
    const std::string_view key = line_.substr(indent, colon - indent);
    const std::string_view value = line_.substr(colon + 1);
    if (indent == 0) {
      in_points_ = key == "MapPoints";
      in_frames_ = key == "FramePoses";
    } else if (value.find_first_not_of(" \r") == std::string_view::npos) {
      begin_item(key);
    } else {
      take_value(key, value);
    }
  }

  void begin_item(std::string_view key) {
    uint32_t id = 0;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), id);
    if (error != std::errc{} || end != key.data() + key.size()) fail("expected a number as the name of the item");
    if (in_points_) {
      room_.point_id.push_back(id);
      room_.point_room.push_back(Vec3::Constant(NAN));
      projections_.emplace_back();
    } else if (in_frames_) {
      room_.frames.emplace_back();
      room_.frames.back().id = id;
    }
  }

  void take_value(std::string_view key, std::string_view value) {
    if (in_points_ && !room_.point_room.empty()) {
      if (key == "position") room_.point_room.back() = vector3(numbers(value));
      if (key == "projections") projections_.back() = numbers(value);
    } else if (in_frames_ && !room_.frames.empty()) {
      AnchorFrame& frame = room_.frames.back();
      if (key == "pose") frame.T_room_left = pose(numbers(value));
      if (key == "2dKeypointsLeft") frame.left_px = pixels(numbers(value));
      if (key == "2dKeypointsRight") frame.right_px = pixels(numbers(value));
    }
  }

  /// All numbers of a flow sequence, its brackets and nesting ignored.
  std::vector<double> numbers(std::string_view value) const {
    std::vector<double> out;
    const char* at = value.data();
    const char* const end = at + value.size();
    while (at != end) {
      if (*at == '[' || *at == ']' || *at == ',' || *at == ' ' || *at == '\r') {
        ++at;
        continue;
      }
      double number = 0;
      const auto [next, error] = std::from_chars(at, end, number);
      if (error != std::errc{} || !std::isfinite(number)) fail("expected finite numbers in brackets");
      out.push_back(number);
      at = next;
    }
    return out;
  }

  Vec3 vector3(const std::vector<double>& n) const {
    if (n.size() != 3) fail("position: expected three numbers");
    return {n[0], n[1], n[2]};
  }

  SE3 pose(const std::vector<double>& n) const {
    if (n.size() != 7) fail("pose: expected axis (3), angle, translation (3)");
    const Vec3 axis(n[0], n[1], n[2]);
    if (std::abs(axis.norm() - 1.0) > 1e-3) fail("pose: the axis is not a unit vector");
    return {so3_exp(axis.normalized() * n[3]), Vec3(n[4], n[5], n[6])};
  }

  std::vector<Vec2> pixels(const std::vector<double>& n) const {
    if (n.size() % 2 != 0) fail("key points: expected pairs");
    std::vector<Vec2> out;
    for (std::size_t i = 0; i + 1 < n.size(); i += 2) out.emplace_back(n[i], n[i + 1]);
    return out;
  }

  void check(const AnchorFrame& frame) const {
    if (frame.left_px.size() == frame.right_px.size() && !frame.left_px.empty()) return;
    throw ToolError(fmt::format("{}: frame {}: left and right key points must be there and as many", name_, frame.id));
  }

  /// Projections name frames by number; those that are not in the file are skipped.
  void link() {
    std::unordered_map<uint32_t, std::size_t> place;
    for (std::size_t f = 0; f < room_.frames.size(); ++f) {
      place[room_.frames[f].id] = f;
      room_.frames[f].point.assign(room_.frames[f].left_px.size(), -1);
    }
    for (std::size_t p = 0; p < projections_.size(); ++p) {
      if (!room_.point_room[p].allFinite()) {
        throw ToolError(fmt::format("{}: map point {}: no position", name_, room_.point_id[p]));
      }
      for (std::size_t i = 0; i + 1 < projections_[p].size(); i += 2) {
        const double frame_id = projections_[p][i];
        const double key_point = projections_[p][i + 1];
        if (!(frame_id >= 0 && frame_id < 4e9 && key_point >= 0)) continue;
        const auto found = place.find(static_cast<uint32_t>(frame_id));
        if (found == place.end()) continue;
        std::vector<int>& point = room_.frames[found->second].point;
        if (key_point < static_cast<double>(point.size()))
          point[static_cast<std::size_t>(key_point)] = static_cast<int>(p);
      }
    }
  }

  const std::string& name_;
  std::string_view rest_;
  std::string_view line_;
  std::size_t line_number_ = 0;
  bool in_points_ = false;
  bool in_frames_ = false;
  AnchorRoom room_;
  std::vector<Projections> projections_;
};

}  // namespace

AnchorRoom parse_anchor_room(const std::string& name, const std::string& text) { return Reader(name, text).read(); }

}  // namespace roomcal::tools
