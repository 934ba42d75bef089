#include "tests/fuzz/text_fuzz.h"
#include "tools/device/device_yaml.h"
#include "tools/device/wiring_yaml.h"

// What is accepted must survive being written and read again.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  using namespace roomcal::tools;
  return test::fuzz_text(data, size, [](const std::string& text) {
    const Device device = parse_device_yaml("input", text);
    const std::string written = to_device_yaml(device);
    try {
      const Device again = parse_device_yaml("input", written);
      if (again.sensors.size() != device.sensors.size()) __builtin_trap();
      for (std::size_t i = 0; i < device.sensors.size(); ++i)
        if (to_text(again.sensors[i].camera_wiring) != to_text(device.sensors[i].camera_wiring) ||
            to_text(again.sensors[i].lidar_wiring) != to_text(device.sensors[i].lidar_wiring))
          __builtin_trap();
      if (wiring_text(again.wiring) != wiring_text(device.wiring)) __builtin_trap();
      if (to_text(again.grab) != to_text(device.grab)) __builtin_trap();
    } catch (const ToolError&) {
      __builtin_trap();
    }
  });
}
