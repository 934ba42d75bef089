#include "tools/sweep/load_sweeps.h"

#include <algorithm>
#include <array>

#include <fmt/core.h>

#include "runtime/lidar/robosense.h"
#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/sweep/calibration_files.h"
#include "tools/sweep/cloud_files.h"
#include "tools/sweep/realign.h"

namespace roomcal::tools {

using lidar::Bytes;
using lidar::PacketKind;

lidar::Sweep LoadedSweep::view() const {
  lidar::Sweep sweep = facts;
  sweep.points = points;
  return sweep;
}

std::vector<std::string> flag_names(uint32_t flags) {
  constexpr std::array kNames = {"lost_packets", "partial",      "out_of_order", "full",
                                 "duplicates",   "other_sensor", "bad_packets",  "wrong_timing"};
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if ((flags >> i & 1) != 0) names.emplace_back(kNames[i]);
  return names;
}

namespace {

const lidar::ModelInfo& model_named(const std::string& name) {
  if (const lidar::ModelInfo* model = lidar::find_model(name)) return *model;
  std::string list;
  for (const lidar::ModelInfo& known : lidar::known_models()) list += fmt::format(" {}", known.name);
  throw ToolError(fmt::format("--sensor {}: no such LiDAR; one of:{}", name, list));
}

class Loader {
 public:
  Loader(const LoadRequest& request, const lidar::ModelInfo& model)
      : request_(request), model_(model), memory_(lidar::SweepBuilder::arena_bytes(request.options)), arena_(memory_) {}

  Recording load(const std::string& name, Bytes bytes) {
    recording_.packets = true;
    recording_.calibration = read_calibration(model_.model, request_.calibration);
    if (model_.family == lidar::Family::kRobosense) {
      recording_.calibration.dual_returns = request_.dual_returns;
      use_difop(name, bytes);
    }
    Result<lidar::SweepBuilder> builder = lidar::SweepBuilder::create(recording_.calibration, request_.options, arena_);
    require(builder.status(), name);
    builder_ = &builder.value();
    read_all(name, bytes);
    conclude(name);
    return std::move(recording_);
  }

 private:
  void read_all(const std::string& name, Bytes bytes) {
    PcapReader reader(name, bytes);
    Realigner realigner;
    const bool torn = cut_at_wrong_places(name, bytes);
    Datagram datagram;
    while (recording_.sweeps.size() < request_.max_sweeps && reader.next(datagram)) {
      if (torn) {
        realigner.add(datagram.payload);
      } else {
        take(datagram.payload);
      }
    }
    realigner.deliver([&](Bytes packet) {
      ++recording_.report.realigned;
      if (recording_.sweeps.size() < request_.max_sweeps) take(packet);
    });
    builder_->finish();
    keep();
    reader.finish();
    recording_.report.pcap = reader.counters();
  }

  bool cut_at_wrong_places(const std::string& name, Bytes bytes) const {
    if (model_.family != lidar::Family::kRobosense) return false;
    PcapReader reader(name, bytes);
    Datagram datagram;
    std::size_t whole = 0, torn = 0;
    while (reader.next(datagram)) ++(Realigner::torn(datagram.payload) ? torn : whole);
    return torn > whole;
  }

  void take(Bytes payload) {
    const PacketKind kind = lidar::classify_packet(model_.model, payload);
    if (kind != PacketKind::kPoints) {
      ++recording_.report.other_packets[to_string(kind)];
      return;
    }
    if (const lidar::ModelInfo* looks = lidar::identify_packet(payload)) ++recording_.report.look_like[looks->product];
    const Status status = builder_->push(payload);
    if (!status.ok()) ++recording_.report.refused[status.detail()];
    keep();
  }

  void keep() {
    if (!builder_->ready() || recording_.sweeps.size() == request_.max_sweeps) return;
    LoadedSweep sweep;
    sweep.points.assign(builder_->sweep().points.begin(), builder_->sweep().points.end());
    sweep.facts = builder_->sweep();
    sweep.facts.points = {};
    recording_.sweeps.push_back(std::move(sweep));
  }

  /// Angles that the recording itself brings, unless a file was given.
  void use_difop(const std::string& name, Bytes bytes) {
    PcapReader reader(name, bytes);
    Datagram datagram;
    while (reader.next(datagram)) {
      lidar::Calibration difop = recording_.calibration;
      if (!lidar::read_difop(datagram.payload, difop).ok()) continue;
      if (request_.calibration.empty()) recording_.calibration = difop;
      recording_.calibration.dual_returns = difop.dual_returns;
      return;
    }
    if (request_.calibration.empty())
      recording_.report.warnings.push_back(
          "no DIFOP packet and no --calibration: the maker's usual angles are used, not this unit's");
  }

  void conclude(const std::string& name) {
    LoadReport& report = recording_.report;
    report.counters = builder_->counters();
    report.return_mode = builder_->last_header().return_mode;
    report.product_byte = builder_->last_header().product_byte;
    report.motor_rpm = builder_->last_header().motor_rpm;
    report.returns = builder_->last_header().returns;
    if (report.counters.packets == 0) refuse_empty(name);
    refuse_other_model(name);
    warn();
  }

  std::string others() const {
    std::string text;
    for (const auto& [product, count] : recording_.report.look_like)
      if (product != model_.product) text += fmt::format("{}{} of a {}", text.empty() ? "" : ", ", count, product);
    return text;
  }

  std::string remedy() const {
    for (const lidar::ModelInfo& known : lidar::known_models())
      if (known.product != std::string(model_.product) && recording_.report.look_like.contains(known.product))
        return fmt::format("use --sensor {}", known.name);
    return "check --sensor";
  }

  [[noreturn]] void refuse_empty(const std::string& name) const {
    const LoadReport& report = recording_.report;
    if (const std::string seen = others(); !seen.empty())
      throw ToolError(fmt::format("{}: no packet of a {}, but {}; {}", name, model_.product, seen, remedy()));
    if (!report.refused.empty()) {
      throw ToolError(fmt::format("{}: no packet of a {}: {} refused ({}); check --sensor and --calibration", name,
                                  model_.product, report.refused.begin()->second, report.refused.begin()->first));
    }
    throw ToolError(fmt::format("{}: {} UDP datagrams, none a point packet of a {}; was its data port recorded?", name,
                                report.pcap.datagrams, model_.product));
  }

  /// A factory byte alone may lie (early VLP-16 do); together with the other model's pace it does not.
  void refuse_other_model(const std::string& name) const {
    const lidar::SweepCounters& counters = recording_.report.counters;
    const bool named = counters.other_sensor * 2 > counters.packets;
    const bool paced = counters.out_of_pace * 2 > counters.packets;
    if (!named || !paced || model_.family != lidar::Family::kVelodyne) return;
    throw ToolError(fmt::format("{}: packets are not of a {} by their factory byte ({:#04x}) and their pace: {}; {}",
                                name, model_.product, recording_.report.product_byte, others(), remedy()));
  }

  void warn() {
    LoadReport& report = recording_.report;
    const lidar::SweepCounters& counters = report.counters;
    const auto warn_if = [&](bool wrong, const std::string& text) {
      if (wrong) report.warnings.push_back(text);
    };
    const bool velodyne = model_.family == lidar::Family::kVelodyne;
    warn_if(counters.other_sensor > 0,
            velodyne || model_.family == lidar::Family::kHesai || model_.family == lidar::Family::kRobosense
                ? fmt::format("{} packets carry the factory byte {:#04x}, which is not a {}'s{}", counters.other_sensor,
                              report.product_byte, model_.product,
                              velodyne ? "; their pace is (early units do this): check the label" : "; check --sensor")
                : fmt::format("{} packets name another serial number than the metadata: give this unit's file",
                              counters.other_sensor));
    warn_if(counters.out_of_pace * 2 > counters.packets,
            fmt::format("packets do not come at the pace of a {} in this mode; check --sensor{}", model_.product,
                        model_.family == lidar::Family::kRobosense ? " and --dual" : " and its return mode"));
    warn_if(counters.azimuth_jumps > 0,
            fmt::format("{} times the azimuth jumps without a pause: damaged packets", counters.azimuth_jumps));
    warn_if(counters.checksum_wrong > 0, fmt::format("{} packets have a wrong checksum", counters.checksum_wrong));
    warn_if(report.pcap.truncated, "the file ends within a packet; the recorder was stopped or the disk was full");
    warn_if(report.pcap.cut_short > 0,
            fmt::format("{} frames were recorded cut short; record with the snap length 65535", report.pcap.cut_short));
    warn_if(report.pcap.unfinished > 0,
            fmt::format("{} datagrams miss fragments; record nearer to the sensor", report.pcap.unfinished));
    warn_if(report.realigned > 0,
            fmt::format("the recording is cut at the wrong places: {} packets were put together again, what was lost "
                        "at the cuts is left out",
                        report.realigned));
  }

  const LoadRequest& request_;
  const lidar::ModelInfo& model_;
  std::vector<std::byte> memory_;
  Arena arena_;
  lidar::SweepBuilder* builder_ = nullptr;
  Recording recording_;
};

Recording load_cloud(const std::string& name, Bytes bytes) {
  Recording recording;
  recording.sweeps.push_back(read_cloud(name, bytes));
  return recording;
}

}  // namespace

Recording load_sweeps(const std::string& name, Bytes bytes, const LoadRequest& request) {
  if (is_cloud(bytes)) return load_cloud(name, bytes);
  if (request.model.empty()) throw ToolError(name + ": a recording of packets needs the LiDAR's model; give --sensor");
  return Loader(request, model_named(request.model)).load(name, bytes);
}

Recording load_sweeps(const LoadRequest& request) {
  const AlignedBytes bytes = read_bytes(request.file);
  return load_sweeps(request.file.string(), bytes.span(), request);
}

}  // namespace roomcal::tools
