// v4l2_probe --list
// v4l2_probe --key KEY --size WxH [--format GREY,YUYV,...] [--fps N] [--seconds N] [--exposure-us N] [--gain N]
//            [--trigger NAME=VALUE] [--reset-port] [--save FILE]
//
// Runs the V4L2 driver on a real kernel: vivid in a guest, or a camera on a desk. (vivid's stamps of an image's end are
// nine tenths of a period ahead of the image, and so "in the future": set its control timestamp_source to 1.)
//
// One JSON object a line and second on standard output, what the driver logs on standard error. Exit 0 if the last
// second brought images, 1 otherwise.

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "drivers/os/linux_clocks.h"
#include "drivers/v4l2/linux_kernel.h"
#include "drivers/v4l2/v4l2_image_source.h"

namespace {

using namespace roomcal;
using namespace roomcal::drivers;

constexpr int64_t kSecondNs = 1'000'000'000;

struct StderrLog final : ports::Log {
  void note(std::string_view who, std::string_view what) override {
    std::fprintf(stderr, "%.*s: %.*s\n", static_cast<int>(who.size()), who.data(), static_cast<int>(what.size()),
                 what.data());
  }
};

struct Arguments {
  V4l2Options options;
  int seconds = 10;
  bool list = false;
  std::string save;
};

[[noreturn]] void complain(const std::string& what) {
  std::fprintf(stderr, "v4l2_probe: %s\n", what.c_str());
  std::exit(100);
}

void take_formats(const std::string& text, V4l2Options& options) {
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const PixelFormat format = pixel_format_of(text.substr(begin, end - begin));
    if (format == PixelFormat::kCount) complain("no such format: " + text.substr(begin, end - begin));
    if (!options.formats.push_back(format)) complain("more than four formats");
    begin = end + 1;
  }
}

void take_trigger(const std::string& text, V4l2Options& options) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) complain("--trigger wants NAME=VALUE");
  options.trigger = TriggerMode::kExternal;
  options.trigger_control = {std::string_view(text).substr(0, equals), std::atoi(text.c_str() + equals + 1)};
}

// @return false for a word that is none.
bool take_valued(const std::string& word, const std::string& value, Arguments& arguments) {
  V4l2Options& options = arguments.options;
  if (word == "--key") {
    options.key = std::string_view(value);
  } else if (word == "--size") {
    if (std::sscanf(value.c_str(), "%dx%d", &options.width_px, &options.height_px) != 2) complain("--size wants WxH");
  } else if (word == "--format") {
    take_formats(value, options);
  } else if (word == "--fps") {
    options.fps = std::atof(value.c_str());
  } else if (word == "--seconds") {
    arguments.seconds = std::atoi(value.c_str());
  } else if (word == "--exposure-us") {
    options.exposure_us = std::atoi(value.c_str());
  } else if (word == "--gain") {
    options.gain = std::atoi(value.c_str());
  } else if (word == "--trigger") {
    take_trigger(value, options);
  } else if (word == "--save") {
    arguments.save = value;
  } else {
    return false;
  }
  return true;
}

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--list") {
      arguments.list = true;
    } else if (word == "--reset-port") {
      arguments.options.may_reset_port = true;
    } else if (i + 1 >= argc || !take_valued(word, argv[++i], arguments)) {
      complain("what is " + word + "? See the top of tests/guest/v4l2_probe.cpp");
    }
  }
  if (arguments.options.formats.empty()) take_formats("GREY,YUYV,NV12", arguments.options);
  return arguments;
}

int list_nodes() {
  LinuxV4l2Kernel kernel;
  std::array<NodeName, 64> names;
  const int count = kernel.list(names);
  if (count < 0) std::fprintf(stderr, "v4l2_probe: no video nodes: %s\n", std::strerror(-count));
  for (std::size_t i = 0; i < std::min(static_cast<std::size_t>(std::max(count, 0)), names.size()); ++i) {
    VideoNode node;
    if (kernel.describe(names[i].view(), node) < 0) continue;
    const auto text = [](const auto& fixed) { return std::string(fixed.view()); };
    std::printf("%s\n  path   %s\n  name   %s\n  serial %s\n  index  %d\n", text(node.name).c_str(),
                text(node.path).c_str(), text(node.title).c_str(), text(node.serial).c_str(), node.index);
  }
  return count > 0 ? 0 : 1;
}

// What one second brought; gaps that a loss count or a restart explains are no surprise.
struct Second {
  uint64_t images = 0, lost = 0, interruptions = 0;
  int64_t longest_ns = 0, worst_age_ns = 0;
};

void print(int second, const Second& now, const ports::ImageHealth& health) {
  std::printf(
      "{\"second\":%d,\"state\":\"%s\",\"images\":%llu,\"lost\":%llu,\"interruptions\":%llu,\"longest_gap_ms\":%.1f,"
      "\"worst_age_ms\":%.1f,\"superseded\":%llu,\"restarts\":%u,\"reopens\":%u,\"port_resets\":%u,\"faults\":{",
      second, to_string(health.state), static_cast<unsigned long long>(now.images),
      static_cast<unsigned long long>(now.lost), static_cast<unsigned long long>(now.interruptions),
      static_cast<double>(now.longest_ns) / 1e6, static_cast<double>(now.worst_age_ns) / 1e6,
      static_cast<unsigned long long>(health.superseded), health.restarts, health.reopens, health.port_resets);
  const char* comma = "";
  for (std::size_t i = 0; i < ports::kImageFaults; ++i) {
    if (health.faults[i] == 0) continue;
    std::printf("%s\"%s\":%u", comma, to_string(static_cast<ports::ImageFault>(i)), health.faults[i]);
    comma = ",";
  }
  std::printf("},\"errno\":%d}\n", health.error_number);
  std::fflush(stdout);
}

class Probe {
 public:
  explicit Probe(const Arguments& arguments)
      : arguments_(arguments),
        source_("probe", arguments.options, kernel_, clocks_, log_),
        pixels_(static_cast<std::size_t>(arguments.options.width_px) *
                static_cast<std::size_t>(arguments.options.height_px)) {}

  int run() {
    const Status started = source_.start();
    if (!started.ok()) std::fprintf(stderr, "v4l2_probe: %s\n", started.detail());
    const int64_t began_ns = clocks_.now_ns();
    Second second;
    for (int i = 1; i <= arguments_.seconds; ++i) {
      second = {};
      for (const int64_t end_ns = began_ns + i * kSecondNs; clocks_.now_ns() < end_ns;) take(end_ns, second);
      print(i, second, source_.health());
    }
    save();
    return second.images > 0 ? 0 : 1;
  }

 private:
  void take(int64_t end_ns, Second& second) {
    const V4l2Options& options = arguments_.options;
    ports::ImageFacts facts;
    const int64_t wait_ns = end_ns - clocks_.now_ns();
    if (!source_.next(wait_ns, {pixels_.data(), options.width_px, options.height_px}, facts).ok()) return;
    ++second.images;
    second.lost += facts.lost_before;
    if (facts.first_after_gap) ++second.interruptions;
    if (last_ns_ != 0) second.longest_ns = std::max(second.longest_ns, facts.arrived_ns - last_ns_);
    second.worst_age_ns = std::max(second.worst_age_ns, facts.arrived_ns - facts.exposed.ns);
    last_ns_ = facts.arrived_ns;
  }

  // The last image, as PGM.
  void save() const {
    if (arguments_.save.empty()) return;
    std::ofstream out(arguments_.save, std::ios::binary);
    out << "P5\n" << arguments_.options.width_px << " " << arguments_.options.height_px << "\n255\n";
    out.write(reinterpret_cast<const char*>(pixels_.data()), static_cast<std::streamsize>(pixels_.size()));
    if (!out) std::fprintf(stderr, "v4l2_probe: cannot write %s\n", arguments_.save.c_str());
  }

  const Arguments& arguments_;
  LinuxV4l2Kernel kernel_;
  LinuxClocks clocks_;
  StderrLog log_;
  V4l2ImageSource source_;
  std::vector<uint8_t> pixels_;
  int64_t last_ns_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  if (arguments.list) return list_nodes();
  const auto none = [](int pixels) { return pixels < 1 || pixels > 16384; };
  if (none(arguments.options.width_px) || none(arguments.options.height_px)) complain("give --size WxH");
  return Probe(arguments).run();
}
