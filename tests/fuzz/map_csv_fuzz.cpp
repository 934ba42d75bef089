#include "tests/fuzz/text_fuzz.h"
#include "tools/map/map_import.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  using namespace roomcal::tools;
  return test::fuzz_text(data, size, [](const std::string& text) { static_cast<void>(parse_map_csv("input", text)); });
}
