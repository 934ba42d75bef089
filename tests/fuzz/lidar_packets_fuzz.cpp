#include <memory>
#include <vector>

#include "runtime/lidar/ouster.h"
#include "runtime/lidar/sweep_builder.h"

// The first byte chooses the sensor, the second the length unit; packets follow, each with two bytes of length.
// Whatever the bytes are, sweeps keep their promises.
namespace {

using namespace roomcal;
using namespace roomcal::lidar;

std::vector<Calibration> make_calibrations() {
  std::vector<Calibration> result;
  for (const ModelInfo& model : known_models()) {
    std::vector<Beam> beams(model.model == Model::kOuster ? 32 : model.beams);
    for (std::size_t i = 0; i < beams.size(); ++i) beams[i].elevation_rad = 0.01 * static_cast<double>(i);
    if (model.model != Model::kOuster) {
      result.push_back(make_calibration(model.model, beams).value());
      continue;
    }
    for (int profile = 0; profile <= static_cast<int>(OusterProfile::kFiveWord); ++profile) {
      OusterFormat format;
      format.profile = static_cast<OusterProfile>(profile);
      format.columns_per_packet = 2;
      result.push_back(make_calibration(format, beams).value());
    }
  }
  return result;
}

void check(const Sweep& sweep) {
  for (const SweepPoint& p : sweep.points) {
    const bool sane = p.beam < sweep.beam_count && p.return_index <= 2 && p.range_m > 0 && p.azimuth_rad >= 0 &&
                      p.azimuth_rad < 6.2832F && p.x_m == p.x_m && p.y_m == p.y_m && p.z_m == p.z_m;
    if (!sane) __builtin_trap();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  static const std::vector<Calibration> kCalibrations = make_calibrations();
  if (size < 1) return 0;
  const Calibration& calibration = kCalibrations[data[0] % kCalibrations.size()];
  const SweepOptions options = {.capacity = 3000};
  std::vector<std::byte> memory(SweepBuilder::arena_bytes(options));
  Arena arena(memory);
  SweepBuilder builder = SweepBuilder::create(calibration, options, arena).value();
  std::size_t at = 1;
  while (at + 2 <= size) {
    const std::size_t wanted = data[at] | static_cast<std::size_t>(data[at + 1]) << 8;
    at += 2;
    const std::size_t count = std::min(wanted, size - at);
    // A heap block of exactly this size, so that reading one byte too far is seen.
    const std::unique_ptr<std::byte[]> packet(new std::byte[count]);
    for (std::size_t i = 0; i < count; ++i) packet[i] = static_cast<std::byte>(data[at + i]);
    at += count;
    const Bytes bytes(packet.get(), count);
    static_cast<void>(classify_packet(calibration.model, bytes));
    static_cast<void>(identify_packet(bytes));
    static_cast<void>(builder.push(bytes).ok());
    if (builder.ready()) check(builder.sweep());
  }
  builder.finish();
  if (builder.ready()) check(builder.sweep());
  return 0;
}
