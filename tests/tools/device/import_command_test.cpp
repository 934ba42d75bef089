#include "tools/device/import_command.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/tools/refusal.h"
#include "tools/device/device_yaml.h"

namespace roomcal::tools {
namespace {

namespace fs = std::filesystem;

void run(std::vector<std::string> words) {
  CLI::App app;
  int exit_code = 0;
  add_import_command(app, exit_code);
  std::reverse(words.begin(), words.end());  // CLI11 wants them so
  app.parse(words);
}

std::string temporary(const std::string& name) { return (fs::path(testing::TempDir()) / name).string(); }

TEST(ImportCommand, DevicesWithTruth_AreMountedNearTheirNominal) {
  const char* data = std::getenv("ROOMCAL_DATA");
  const fs::path root = (data != nullptr ? fs::path(data) : fs::path(ROOMCAL_SOURCE_DIR) / "../shared/data") / "room-a";
  if (!fs::exists(root)) GTEST_SKIP() << root << " is not here; set ROOMCAL_DATA";
  for (const std::string name : {"stereo", "robot", "backpack", "tls"}) {
    const std::string out = temporary(name + ".yaml");
    run({"import", "kalibr", (root / name / "camchain.yaml").string(), "--nominal",
         (root / name / "nominal.json").string(), "-o", out});
    const Device device = read_device(out);
    EXPECT_EQ(device.name, name);
    EXPECT_EQ(device.rig_frame, "cam0");
    for (const Sensor& sensor : device.sensors) EXPECT_EQ(sensor.nominal.has_value(), sensor.name != "cam0");
    fs::remove(out);
  }
}

TEST(ImportCommand, BadCamchain_IsRefusedAndWritesNothing) {
  const std::string chain = temporary("bad_camchain.yaml"), out = temporary("bad_device.yaml");
  std::ofstream(chain) << "cam0:\n  camera_model: ds\n";
  const std::string message = test::refusal([&] { run({"import", "kalibr", chain, "-o", out}); });
  EXPECT_TRUE(test::contains(message, "bad_camchain.yaml:2: cam0: camera_model `ds` is not supported")) << message;
  EXPECT_FALSE(fs::exists(out));
  fs::remove(chain);
}

}  // namespace
}  // namespace roomcal::tools
