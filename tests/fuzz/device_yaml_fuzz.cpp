#include "tests/fuzz/text_fuzz.h"
#include "tools/device/device_yaml.h"

// What is accepted must survive being written and read again.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  using namespace roomcal::tools;
  return test::fuzz_text(data, size, [](const std::string& text) {
    const Device device = parse_device_yaml("input", text);
    const std::string written = to_device_yaml(device);
    try {
      if (parse_device_yaml("input", written).sensors.size() != device.sensors.size()) __builtin_trap();
    } catch (const ToolError&) {
      __builtin_trap();
    }
  });
}
