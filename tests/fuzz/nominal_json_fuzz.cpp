#include "tests/fuzz/text_fuzz.h"
#include "tools/device/nominal.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  using namespace roomcal;
  using namespace roomcal::tools;
  return test::fuzz_text(data, size, [](const std::string& text) {
    Device device;
    device.name = device.rig_frame = "cam0";
    for (const char* name : {"cam0", "cam1"}) {
      Sensor sensor;
      sensor.name = name;
      sensor.intrinsics = {camera::Model::kPinholeRadtan, 640, 480, 500, 500, 320, 240, {}};
      device.sensors.push_back(sensor);
    }
    apply_nominal("input", text, device);
  });
}
