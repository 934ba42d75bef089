#include "tests/fuzz/text_fuzz.h"
#include "tools/sweep/calibration_files.h"
#include "tools/sweep/load_sweeps.h"

// The first byte chooses the reader; the rest is the file.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  using namespace roomcal;
  using namespace roomcal::tools;
  if (size == 0) return 0;
  return test::fuzz_text(data + 1, size - 1, [&](const std::string& text) {
    const auto bytes = std::as_bytes(std::span<const char>(text));
    LoadRequest request;
    request.options.capacity = 5000;
    switch (data[0] % 7) {
      case 0:
        request.model = "vlp16";
        break;
      case 1:
        request.model = "helios16p";
        break;
      case 2:
        request.model = "mid360";
        break;
      case 3:
        static_cast<void>(parse_ouster_json("input", text));
        return;
      case 4:
        static_cast<void>(parse_velodyne_yaml(lidar::Model::kVlp16, "input", text));
        return;
      case 5:
        static_cast<void>(parse_hesai_csv(lidar::Model::kXt16, "input", text));
        return;
      default:
        static_cast<void>(parse_robosense_csv("input", text));
        return;
    }
    for (const LoadedSweep& sweep : load_sweeps("input", bytes, request).sweeps)
      if (sweep.points.size() > request.options.capacity && !text.starts_with("ply") && text[0] != '#' &&
          text[0] != 'V' && text[0] != 'F')
        __builtin_trap();
  });
}
