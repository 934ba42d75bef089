#include "tools/sweep/sweep_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace roomcal::tools {

using nlohmann::json;

namespace {

/// Count, extremes and mean of ranges.
struct RangeFacts {
  uint64_t points = 0;
  double low_m = std::numeric_limits<double>::infinity(), high_m = 0, sum_m = 0;

  void add(double range_m) {
    ++points;
    low_m = std::min(low_m, range_m);
    high_m = std::max(high_m, range_m);
    sum_m += range_m;
  }
  json to_json() const {
    if (points == 0) return {{"points", 0}};
    return {{"points", points}, {"min_m", low_m}, {"max_m", high_m}, {"mean_m", sum_m / static_cast<double>(points)}};
  }
};

struct Facts {
  RangeFacts all;
  std::vector<RangeFacts> beams;
  std::vector<uint64_t> returns = std::vector<uint64_t>(3);
  double span_s = 0;
  std::size_t whole = 0;
};

Facts facts_of(const Recording& recording) {
  Facts facts;
  for (const LoadedSweep& sweep : recording.sweeps) {
    facts.beams.resize(std::max<std::size_t>(facts.beams.size(), sweep.facts.beam_count));
    for (const lidar::SweepPoint& point : sweep.points) {
      const double range_m = static_cast<double>(point.range_m);
      facts.all.add(range_m);
      facts.beams[point.beam].add(range_m);
      ++facts.returns[std::min<std::size_t>(point.return_index, 2)];
    }
    facts.whole += (sweep.facts.flags & lidar::kSweepPartial) == 0;
  }
  if (!recording.sweeps.empty()) {
    const lidar::Sweep &first = recording.sweeps.front().facts, &last = recording.sweeps.back().facts;
    facts.span_s = 1e-9 * static_cast<double>(last.stamp.ns - first.stamp.ns + last.duration_ns);
  }
  return facts;
}

json sweeps_json(const Recording& recording) {
  json sweeps = json::array();
  for (const LoadedSweep& sweep : recording.sweeps) {
    const lidar::Sweep& facts = sweep.facts;
    sweeps.push_back({{"stamp_ns", facts.stamp.ns},
                      {"duration_ms", 1e-6 * static_cast<double>(facts.duration_ns)},
                      {"points", sweep.points.size()},
                      {"packets", facts.packets},
                      {"lost_packets", facts.lost_packets},
                      {"flags", flag_names(facts.flags)}});
  }
  return sweeps;
}

json beams_json(const Recording& recording, const Facts& facts) {
  json beams = json::array();
  for (std::size_t i = 0; i < facts.beams.size(); ++i) {
    json beam = facts.beams[i].to_json();
    beam["beam"] = i;
    if (recording.packets && recording.calibration.model != lidar::Model::kMid360)
      beam["elevation_deg"] = rad_to_deg(recording.calibration.beams[i].elevation_rad);
    beams.push_back(std::move(beam));
  }
  return beams;
}

json losses_json(const LoadReport& report) {
  const lidar::SweepCounters& counters = report.counters;
  return {{"packets", counters.lost},
          {"refused", counters.unsupported + counters.corrupt},
          {"duplicates", counters.duplicates},
          {"late_used", counters.late_used},
          {"late_dropped", counters.late_dropped},
          {"clock_jumps", counters.restarts},
          {"azimuth_jumps", counters.azimuth_jumps},
          {"absurd_ranges", counters.absurd_ranges},
          {"points_beyond_capacity", counters.dropped_points},
          {"frames_malformed", report.pcap.malformed},
          {"frames_cut_short", report.pcap.cut_short},
          {"datagrams_unfinished", report.pcap.unfinished},
          {"file_truncated", report.pcap.truncated}};
}

json sensor_json(const LoadRequest& request, const Recording& recording) {
  const lidar::ModelInfo& model = lidar::info(recording.calibration.model);
  const LoadReport& report = recording.report;
  return {{"model", model.name},
          {"product", model.product},
          {"beams", recording.calibration.beam_count},
          {"calibration", request.calibration.string()},
          {"angles_of_this_unit", recording.calibration.from_unit},
          {"return_mode", fmt::format("{:#04x}", report.return_mode)},
          {"returns_per_firing", report.returns},
          {"factory_byte", fmt::format("{:#04x}", report.product_byte)},
          {"motor_rpm", report.motor_rpm},
          {"packets_look_like", report.look_like}};
}

}  // namespace

json sweep_json(const std::string& file, const LoadRequest& request, const Recording& recording) {
  const Facts facts = facts_of(recording);
  const LoadReport& report = recording.report;
  json result = {{"file", file},
                 {"sweeps", sweeps_json(recording)},
                 {"whole_sweeps", facts.whole},
                 {"points", facts.all.points},
                 {"points_by_return", facts.returns},
                 {"ranges", facts.all.to_json()},
                 {"time_span_s", facts.span_s},
                 {"beams", beams_json(recording, facts)},
                 {"warnings", report.warnings}};
  if (!recording.packets) return result;
  result["sensor"] = sensor_json(request, recording);
  result["packets"] = report.counters.packets;
  result["other_packets"] = report.other_packets;
  result["refused_packets"] = report.refused;
  result["realigned_packets"] = report.realigned;
  result["losses"] = losses_json(report);
  return result;
}

namespace {

void print_counts(const char* what, const std::map<std::string, uint64_t>& counts) {
  for (const auto& [name, count] : counts) fmt::print("  {}: {} {}\n", what, count, name);
}

void print_beams(const Recording& recording, const Facts& facts) {
  fmt::print("  beam elevation_deg   points   min_m   mean_m    max_m\n");
  for (std::size_t i = 0; i < facts.beams.size(); ++i) {
    const RangeFacts& beam = facts.beams[i];
    const double elevation = recording.packets ? rad_to_deg(recording.calibration.beams[i].elevation_rad) : 0;
    const double mean = beam.points == 0 ? 0 : beam.sum_m / static_cast<double>(beam.points);
    fmt::print("  {:4} {:13.3f} {:8} {:7.3f} {:8.3f} {:8.3f}\n", i, elevation, beam.points,
               beam.points == 0 ? 0 : beam.low_m, mean, beam.high_m);
  }
}

}  // namespace

void print_sweeps(const std::string& file, const LoadRequest&, const Recording& recording) {
  const Facts facts = facts_of(recording);
  const LoadReport& report = recording.report;
  fmt::print("{}: {} sweeps ({} whole), {} points, {:.3f} s, ranges {:.3f} to {:.3f} m\n", file,
             recording.sweeps.size(), facts.whole, facts.all.points, facts.span_s,
             facts.all.points == 0 ? 0 : facts.all.low_m, facts.all.high_m);
  if (recording.packets) {
    fmt::print("  {}: {} packets, {} lost, {} refused, {} twice, {} late, return mode {:#04x}, {} rpm\n",
               lidar::info(recording.calibration.model).product, report.counters.packets, report.counters.lost,
               report.counters.unsupported + report.counters.corrupt, report.counters.duplicates,
               report.counters.late_used + report.counters.late_dropped, report.return_mode, report.motor_rpm);
    print_counts("other packets", report.other_packets);
    print_counts("refused", report.refused);
  }
  for (std::size_t i = 0; i < recording.sweeps.size(); ++i) {
    std::string flags;
    for (const std::string& name : flag_names(recording.sweeps[i].facts.flags)) flags += " " + name;
    if (!flags.empty()) fmt::print("  sweep {}: {} points:{}\n", i, recording.sweeps[i].points.size(), flags);
  }
  print_beams(recording, facts);
  for (const std::string& warning : report.warnings) fmt::print("  warning: {}\n", warning);
}

}  // namespace roomcal::tools
