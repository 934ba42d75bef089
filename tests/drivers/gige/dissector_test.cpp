// Our datagrams as Wireshark reads them: somebody else's understanding of GVCP.
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "drivers/gige/gvcp.h"

namespace roomcal::drivers::gvcp {
namespace {

std::string output_of(const std::string& command) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(::popen(command.c_str(), "r"), &::pclose);
  std::string text;
  std::array<char, 4096> part{};
  while (pipe && std::fgets(part.data(), part.size(), pipe.get()) != nullptr) text += part.data();
  return text;
}

class DissectorTest : public testing::Test {
 protected:
  void SetUp() override {
    if (output_of("command -v tshark").empty() || output_of("command -v text2pcap").empty())
      GTEST_SKIP() << "tshark is not installed (apt-get install tshark)";
    folder_ = std::filesystem::temp_directory_path() / ("gvcp." + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override {
    if (!folder_.empty()) std::filesystem::remove_all(folder_);
  }

  std::string fields_of(const Datagram& datagram, const std::string& fields) {
    std::ofstream hex(folder_ / "hex");
    hex << "0000";
    for (const std::byte b : datagram) {
      std::array<char, 4> text{};
      std::snprintf(text.data(), text.size(), " %02x", std::to_integer<unsigned>(b));
      hex << text.data();
    }
    hex << "\n";
    hex.close();
    const std::string base = folder_.string();
    output_of("text2pcap -q -u 4000,3956 " + base + "/hex " + base + "/pcap 2>/dev/null");
    return output_of("tshark -r " + base + "/pcap -T fields -E separator=, -e " + fields + " 2>/dev/null");
  }

  std::filesystem::path folder_;
};

ActionCommand example() {
  ActionCommand command;
  command.id = 0x1234;
  command.device_key = 0xA1A2A3A4;
  command.group_key = 0xB1B2B3B4;
  command.group_mask = 0xC1C2C3C4;
  return command;
}

constexpr const char* kActionFields =
    "gvcp.cmd.command -e gvcp.cmd.flag.acq_required -e gvcp.cmd.flag.scheduledactioncommand -e "
    "gvcp.cmd.payloadlength -e gvcp.cmd.req_id -e gvcp.cmd.action.devicekey -e gvcp.cmd.action.groupkey -e "
    "gvcp.cmd.action.groupmask -e gvcp.cmd.action.time -e _ws.malformed";

TEST_F(DissectorTest, Action_IsReadAsItIsMeant) {
  EXPECT_EQ(fields_of(action_command(example()), kActionFields),
            "0x0100,0,0,0x000c,0x1234,0xa1a2a3a4,0xb1b2b3b4,0xc1c2c3c4,,\n");
}

TEST_F(DissectorTest, ScheduledAction_IsReadAsItIsMeant) {
  ActionCommand command = example();
  command.acknowledge = true;
  command.action_time = 0x0102030405060708;
  EXPECT_EQ(fields_of(action_command(command), kActionFields),
            "0x0100,1,1,0x0014,0x1234,0xa1a2a3a4,0xb1b2b3b4,0xc1c2c3c4,0x0102030405060708,\n");
}

TEST_F(DissectorTest, RegisterRead_NamesTheControlRegister) {
  EXPECT_EQ(fields_of(read_register(7, kControlRegister),
                      "gvcp.cmd.command -e gvcp.cmd.flag.acq_required -e gvcp.cmd.req_id -e "
                      "gvcp.cmd.readreg.bootstrapregister -e _ws.malformed"),
            "0x0080,1,0x0007,0x00000a00,\n");
}

}  // namespace
}  // namespace roomcal::drivers::gvcp
