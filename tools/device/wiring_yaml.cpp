#include "tools/device/wiring_yaml.h"

#include <limits>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/common/error.h"
#include "tools/device/wiring_fields.h"

namespace roomcal::tools {

namespace {

/// Collects the keys that a struct knows.
struct KeyList {
  std::vector<std::string_view> keys;

  template <typename Enum, std::size_t kCount>
  void choice(std::string_view key, Enum&, const std::array<std::string_view, kCount>&) {
    keys.push_back(key);
  }
  template <typename Text>
  void text(std::string_view key, Text&) {
    keys.push_back(key);
  }
  template <typename Texts>
  void texts(std::string_view key, Texts&) {
    keys.push_back(key);
  }
  template <typename Number>
  void number(std::string_view key, Number&) {
    keys.push_back(key);
  }
  void flag(std::string_view key, bool&) { keys.push_back(key); }
};

/// Fills a struct from the keys that are there.
class FieldReader {
 public:
  FieldReader(const YamlText& yaml, const YAML::Node& node, const std::string& what)
      : yaml_(yaml), node_(node), what_(what) {}

  template <typename Enum, std::size_t kCount>
  void choice(std::string_view key, Enum& value, const std::array<std::string_view, kCount>& names) {
    const YAML::Node node = find(key);
    if (!node.IsDefined()) return;
    const std::string text = yaml_.text(node, path(key));
    for (std::size_t i = 0; i < kCount; ++i)
      if (names[i] == text) {
        value = static_cast<Enum>(i);
        return;
      }
    yaml_.fail(node, fmt::format("{} `{}`; known are {}", path(key), text, fmt::join(names, ", ")));
  }
  template <std::size_t kCapacity>
  void text(std::string_view key, FixedText<kCapacity>& value) {
    if (const YAML::Node node = find(key); node.IsDefined()) value = take<kCapacity>(node, path(key));
  }
  template <std::size_t kCapacity, std::size_t kCount>
  void texts(std::string_view key, FixedVector<FixedText<kCapacity>, kCount>& values) {
    const YAML::Node node = find(key);
    if (!node.IsDefined()) return;
    if (!node.IsSequence() || node.size() > kCount)
      yaml_.fail(node, fmt::format("{}: a list of at most {}", path(key), kCount));
    values.clear();
    for (const auto& item : node) static_cast<void>(values.push_back(take<kCapacity>(item, path(key))));
  }
  template <typename Number>
  void number(std::string_view key, Number& value) {
    const YAML::Node node = find(key);
    if (!node.IsDefined()) return;
    if constexpr (std::is_floating_point_v<Number>) {
      value = yaml_.number(node, path(key));
    } else {
      const double read = yaml_.number(node, path(key));
      if (!(read >= static_cast<double>(std::numeric_limits<Number>::min()) &&
            read <= static_cast<double>(std::numeric_limits<Number>::max()) && read == std::floor(read)))
        yaml_.fail(node, fmt::format("{}: a whole number up to {}", path(key), std::numeric_limits<Number>::max()));
      value = static_cast<Number>(read);
    }
  }
  void flag(std::string_view key, bool& value) {
    const YAML::Node node = find(key);
    if (!node.IsDefined()) return;
    const std::string text = yaml_.text(node, path(key));
    if (text != "true" && text != "false") yaml_.fail(node, fmt::format("{}: true or false", path(key)));
    value = text == "true";
  }

 private:
  YAML::Node find(std::string_view key) const { return node_[std::string(key)]; }
  std::string path(std::string_view key) const { return fmt::format("{}: {}", what_, key); }
  template <std::size_t kCapacity>
  FixedText<kCapacity> take(const YAML::Node& node, const std::string& what) const {
    const std::string text = node.IsScalar() && node.Scalar().empty() ? std::string() : yaml_.text(node, what);
    if (text.size() > kCapacity) yaml_.fail(node, fmt::format("{}: at most {} characters", what, kCapacity));
    return FixedText<kCapacity>(std::string_view(text));
  }

  const YamlText& yaml_;
  const YAML::Node& node_;
  const std::string& what_;
};

/// Writes the fields that differ from a struct of defaults, as a flow mapping.
template <typename Wiring>
class FieldWriter {
 public:
  std::string write(Wiring wiring) {
    Wiring defaults;
    FieldWriter other;
    walk(defaults, other);
    walk(wiring, *this);
    std::string text;
    for (std::size_t i = 0; i < items_.size(); ++i)
      if (items_[i] != other.items_[i]) text += (text.empty() ? "{" : ", ") + items_[i];
    return text.empty() ? text : text + "}";
  }

  template <typename Enum, std::size_t kCount>
  void choice(std::string_view key, Enum& value, const std::array<std::string_view, kCount>& names) {
    items_.push_back(fmt::format("{}: {}", key, names[static_cast<std::size_t>(value)]));
  }
  template <typename Text>
  void text(std::string_view key, Text& value) {
    items_.push_back(fmt::format("{}: {}", key, yaml_quoted(value.view())));
  }
  template <typename Texts>
  void texts(std::string_view key, Texts& values) {
    std::vector<std::string> all;
    for (const auto& value : values) all.push_back(yaml_quoted(value.view()));
    items_.push_back(fmt::format("{}: [{}]", key, fmt::join(all, ", ")));
  }
  template <typename Number>
  void number(std::string_view key, Number& value) {
    items_.push_back(fmt::format("{}: {}", key, value));
  }
  void flag(std::string_view key, bool& value) { items_.push_back(fmt::format("{}: {}", key, value)); }

 private:
  std::vector<std::string> items_;
};

template <typename Wiring>
Wiring read(const YamlText& yaml, const YAML::Node& node, const std::string& what) {
  Wiring wiring;
  KeyList known;
  walk(wiring, known);
  yaml.allow_keys(node, known.keys, what);
  FieldReader reader(yaml, node, what);
  walk(wiring, reader);
  return wiring;
}

template <typename Wiring>
std::string write(const Wiring& wiring) {
  return FieldWriter<Wiring>().write(wiring);
}

}  // namespace

profile::CameraWiring read_camera_wiring(const YamlText& yaml, const YAML::Node& node, const std::string& what) {
  return read<profile::CameraWiring>(yaml, node, what);
}
profile::LidarWiring read_lidar_wiring(const YamlText& yaml, const YAML::Node& node, const std::string& what) {
  return read<profile::LidarWiring>(yaml, node, what);
}
profile::GrabWiring read_grab(const YamlText& yaml, const YAML::Node& node) {
  return read<profile::GrabWiring>(yaml, node, "grab");
}

profile::Wiring read_wiring(const YamlText& yaml, const YAML::Node& node) {
  profile::Wiring wiring;
  std::vector<std::string_view> known{"replay"};
  walk_sections(wiring, [&](std::string_view key, auto&) { known.push_back(key); });
  yaml.allow_keys(node, known, "wiring");
  walk_sections(wiring, [&](std::string_view key, auto& section) {
    using Section = std::remove_reference_t<decltype(section)>;
    const YAML::Node there = node[std::string(key)];
    if (there.IsDefined()) section = read<Section>(yaml, there, fmt::format("wiring: {}", key));
  });
  if (const YAML::Node replay = node["replay"]; replay.IsDefined()) {
    const std::string folder = yaml.text(replay, "wiring: replay");
    if (folder.size() > profile::PathText::capacity())
      yaml.fail(replay, fmt::format("wiring: replay: at most {} characters", profile::PathText::capacity()));
    wiring.replay_folder = std::string_view(folder);
  }
  return wiring;
}

std::string to_text(const profile::CameraWiring& wiring) { return write(wiring); }
std::string to_text(const profile::LidarWiring& wiring) { return write(wiring); }
std::string to_text(const profile::GrabWiring& grab) { return write(grab); }

std::string wiring_text(const profile::Wiring& wiring) {
  std::string text;
  profile::Wiring copy = wiring;
  walk_sections(copy, [&](std::string_view key, const auto& section) {
    if (const std::string fields = write(section); !fields.empty()) text += fmt::format("  {}: {}\n", key, fields);
  });
  if (!wiring.replay_folder.empty()) text += fmt::format("  replay: {}\n", yaml_quoted(wiring.replay_folder.view()));
  return text.empty() ? text : "wiring:\n" + text;
}

}  // namespace roomcal::tools
