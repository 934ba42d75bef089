#include "board/common/bench.h"

#include <algorithm>
#include <cstdio>
#include <vector>

namespace roomcal::board {

namespace {

/// One figure of every run, milliseconds.
struct Series {
  const char* name = "";
  std::vector<double> ms;

  void print() {
    std::sort(ms.begin(), ms.end());
    std::printf("%-16s %10.2f %10.2f ms\n", name, ms[ms.size() / 2], ms.back());
  }
};

/// What is timed: the stages of a session, then the press around them.
class Times {
 public:
  Times() {
    for (std::size_t i = 0; i < kStages; ++i) series_[i].name = to_string(static_cast<calib::Stage>(i));
    series_[kStages].name = "compute in all";
    series_[kStages + 1].name = "grab";
  }
  void add(const press::Report& report, const calib::Outcome& outcome) {
    for (std::size_t i = 0; i < kStages; ++i) put(i, outcome.stage_ns[i]);
    put(kStages, report.compute_ns);
    put(kStages + 1, report.grab_ns);
  }
  void print() {
    std::printf("%-16s %10s %10s\n", "stage", "median", "worst");
    for (Series& series : series_) series.print();
  }

 private:
  static constexpr auto kStages = static_cast<std::size_t>(calib::Stage::kCount);
  void put(std::size_t i, int64_t ns) { series_[i].ms.push_back(static_cast<double>(ns) * 1e-6); }
  std::array<Series, kStages + 2> series_;
};

void print_memory(const face::Vitals& vitals) {
  std::printf("\n%-16s %12s %12s\n", "memory", "used at most", "of bytes");
  for (const face::ArenaVitals& arena : vitals.arenas)
    std::printf("%-16.*s %12zu %12zu\n", static_cast<int>(arena.name.size()), arena.name.data(), arena.peak,
                arena.capacity);
  std::printf("\n%-16s %12s %12s %8s %8s\n", "stack", "used at most", "of bytes", "minor", "major faults");
  for (const face::ThreadVitals& thread : vitals.threads)
    std::printf("%-16.*s %12zu %12zu %8llu %8llu\n", static_cast<int>(thread.name.view().size()),
                thread.name.view().data(), thread.stack_peak, thread.stack_bytes,
                static_cast<unsigned long long>(thread.minor_faults),
                static_cast<unsigned long long>(thread.major_faults));
}

void print_extrinsics(const calib::Outcome& outcome) {
  std::printf("\nT_rig_sensor: x y z, m, and rotation vector, rad\n");
  for (const calib::LocatedSensor& sensor : located_sensors(outcome)) {
    if (!sensor.in_rig) continue;
    const Vec3& t = sensor.T_rig_sensor.t;
    const Vec3 r = so3_log(sensor.T_rig_sensor.R);
    std::printf("%-8.*s %.9f %.9f %.9f  %.9f %.9f %.9f\n", static_cast<int>(sensor.name.view().size()),
                sensor.name.view().data(), t.x(), t.y(), t.z(), r.x(), r.y(), r.z());
  }
}

void complain(const press::Report& report) {
  std::fprintf(stderr, "roomcald: %s\n", to_string(report.result));
  for (const Reason& reason : report.reasons)
    std::fprintf(stderr, "roomcald: %.*s\n", static_cast<int>(reason.view().size()), reason.view().data());
}

}  // namespace

int run_bench(Machine& machine, int runs, const std::function<void()>& meanwhile) {
  Times times;
  for (int i = 0; i < runs; ++i) {
    static_cast<void>(machine.press_thread().start(press::Kind::kVerify));
    while (machine.press_thread().busy()) meanwhile();
    const press::Press& press = *machine.press();
    if (!press.has_outcome() || !may_write(press.outcome().verdict)) return complain(press.report()), 1;
    times.add(press.report(), press.outcome());
  }
  std::printf("%d runs\n", runs);
  times.print();
  face::Vitals vitals;
  machine.examine(vitals);
  print_memory(vitals);
  print_extrinsics(machine.press()->outcome());
  return 0;
}

}  // namespace roomcal::board
