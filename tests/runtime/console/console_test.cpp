#include "runtime/console/console.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/truth/random.h"

namespace roomcal::console {
namespace {

constexpr int64_t kSecond = 1'000'000'000;

struct Handler final : CommandHandler {
  Status run(VerbId verb, std::span<const Word> arguments, Reply& reply) override {
    std::string call(verbs()[static_cast<std::size_t>(verb)].name);
    for (const Word& argument : arguments) call.append(",").append(argument.view());
    calls.push_back(call);
    reply.text("state", "IDLE");
    if (verb == VerbId::kExport) reply.document("file", std::string(export_bytes, 'x'));
    return verb == VerbId::kDiff ? Status(StatusCode::kNotFound, "nothing to compare") : ok_status();
  }
  std::vector<std::string> calls;
  std::size_t export_bytes = 10;
};

struct Sink final : ports::ByteSink {
  std::size_t write_some(std::span<const char> bytes) override {
    text.append(bytes.data(), bytes.size());
    return bytes.size();
  }
  std::string text;
};

struct Bench {
  explicit Bench(const ConsoleConfig& config = {}) : block(plan_console_bytes(config)), arena(block) {
    EXPECT_TRUE(console.open(arena, handler, config).ok());
  }
  /// What comes out while these bytes go in.
  std::string type(std::string_view keys, int64_t now_ns = kSecond) {
    console.feed(keys, now_ns);
    return drain();
  }
  std::string drain() {
    Sink sink;
    console.pump(sink);
    return sink.text;
  }

  std::vector<std::byte> block;
  Arena arena;
  Handler handler;
  Console console;
};

using Calls = std::vector<std::string>;

TEST(Console, VerbOnALine_IsAnsweredToAPerson) {
  Bench bench;
  EXPECT_EQ(bench.type("status\r"), "status\r\nstate: IDLE\r\nroomcal> ");
  EXPECT_EQ(bench.handler.calls, Calls{"status"});
}

TEST(Console, JsonLine_GetsOneJsonLine) {
  Bench bench;
  EXPECT_EQ(bench.type("{\"cmd\":\"status\",\"id\":7}\n"),
            "{\"id\":7,\"cmd\":\"status\",\"ok\":true,\"data\":{\"state\":\"IDLE\"}}\r\n");
  EXPECT_EQ(bench.type("{\"cmd\":\"nonsense\"}\n"),
            "{\"cmd\":\"nonsense\",\"ok\":false,\"error\":{\"code\":\"not found\",\"detail\":\"no such verb; help "
            "lists them\"}}\r\n");
  EXPECT_EQ(bench.type("{\"cmd\":\"diff\"}\n"),
            "{\"cmd\":\"diff\",\"ok\":false,\"error\":{\"code\":\"not found\",\"detail\":\"nothing to compare\"}}\r\n");
}

TEST(Console, ModesAlternate_LineByLine) {
  Bench bench;
  bench.type("{\"cmd\":\"status\"}\n");
  EXPECT_EQ(bench.type("status\r"), "status\r\nstate: IDLE\r\nroomcal> ");
  // A machine's answer begins on its own line.
  EXPECT_EQ(bench.type("{\"cmd\":\"status\"}\n"),
            "\r\n{\"cmd\":\"status\",\"ok\":true,\"data\":{\"state\":\"IDLE\"}}\r\n");
}

TEST(Console, DangerousVerbs_NeedRightsAndSaySo) {
  Bench bench;
  EXPECT_EQ(
      bench.type("calibrate\r"),
      "calibrate\r\ncalibrate: needs the right to operate; hold the device's button, then try again\r\nroomcal> ");
  bench.type("reboot\r");
  EXPECT_TRUE(bench.handler.calls.empty());
  EXPECT_EQ(bench.console.counters().refused, 2U);
  bench.console.grant(Rights::kOperate, kSecond);
  bench.drain();
  EXPECT_EQ(bench.type("calibrate\r"), "calibrate\r\nstate: IDLE\r\nroomcal+> ");
  bench.type("reboot\r");
  EXPECT_EQ(bench.handler.calls, Calls{"calibrate"});
  bench.console.grant(Rights::kService, kSecond);
  bench.type("reboot\r");
  EXPECT_EQ(bench.handler.calls, (Calls{"calibrate", "reboot"}));
}

TEST(Console, Rights_LapseEvenIfNobodyTicks) {
  Bench bench;
  bench.console.grant(Rights::kService, kSecond);
  bench.type("reboot\r", kSecond + 299 * kSecond);
  bench.type("reboot\r", kSecond + 300 * kSecond);
  EXPECT_EQ(bench.handler.calls, Calls{"reboot"});
}

TEST(Console, Arguments_AreCheckedAgainstTheTable) {
  Bench bench;
  for (const char* line : {"export\r", "export pdf\r", "export json a b\r", "status now\r", "map verify twice\r"})
    bench.type(line);
  EXPECT_TRUE(bench.handler.calls.empty());
  bench.type("export camera_info cam0\r");
  EXPECT_EQ(bench.handler.calls, Calls{"export,camera_info,cam0"});
}

TEST(Console, Help_ListsAllAndOne) {
  Bench bench;
  const std::string all = bench.type("help\r");
  for (const Verb& verb : verbs())
    EXPECT_NE(all.find(std::string("\n").append(verb.name)), std::string::npos) << verb.name;
  const std::string one = bench.type("help export\r");
  EXPECT_NE(one.find("export FORMAT [CAMERA] - "), std::string::npos);
  EXPECT_NE(one.find("export autoware"), std::string::npos);
  EXPECT_EQ(one.find("reboot"), std::string::npos);
  EXPECT_NE(bench.type("{\"cmd\":\"help\",\"args\":[\"undo\"]}\n").find("rights: service"), std::string::npos);
}

TEST(Console, Tab_CompletesOrLists) {
  Bench bench;
  EXPECT_EQ(bench.type("stat\t"), "status ");
  bench.type(
      "\x15"
      "exp\tkal\t\r");
  EXPECT_EQ(bench.handler.calls, Calls{"export,kalibr"});
  EXPECT_EQ(bench.type("re\t"), "re\r\nresult  restore-factory  reboot  \r\n\rroomcal> re\x1b[K");
  EXPECT_EQ(bench.type("s\t"), "s\r\nresult  restore-factory  \r\n\rroomcal> res\x1b[K");
  EXPECT_EQ(bench.type("t\t"), "tore-factory ");
}

TEST(Console, Noise_StartsNothing) {
  truth::Random random(5);
  Bench bench;
  bench.console.grant(Rights::kService, kSecond);
  std::string noise(200'000, ' ');
  for (char& c : noise) c = static_cast<char>(random.bits());
  bench.type(noise);
  for (const std::string& call : bench.handler.calls) ADD_FAILURE() << "noise called " << call;
  EXPECT_GT(bench.console.counters().noise_lines, 100U);
  EXPECT_NE(bench.type("\rstatus\r").find("IDLE"), std::string::npos);
}

TEST(Console, FlippedBitInADangerousLine_NeverRunsAnotherVerb) {
  const std::string line = "restore-factory\r";
  for (std::size_t bit = 0; bit < 8 * line.size(); ++bit) {
    Bench bench;
    bench.console.grant(Rights::kService, kSecond);
    std::string flipped = line;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << bit % 8));
    bench.type(flipped);
    EXPECT_TRUE(bench.handler.calls.empty()) << bit;
  }
}

TEST(Console, HalfLine_IsDroppedInTime) {
  Bench bench;
  bench.console.grant(Rights::kService, kSecond);
  bench.type("{\"cmd\":\"reb", kSecond);
  bench.console.tick(2 * kSecond);
  bench.type("oot\"}\n", 4 * kSecond);
  EXPECT_TRUE(bench.handler.calls.empty());
  EXPECT_EQ(bench.console.counters().stale_lines, 1U);
  bench.type("reb", 5 * kSecond);
  bench.console.tick(66 * kSecond);
  EXPECT_NE(bench.drain().find("not ended in time"), std::string::npos);
  bench.type("oot\r", 67 * kSecond);
  EXPECT_TRUE(bench.handler.calls.empty());
}

TEST(Console, SlowReader_LosesWholeMessagesAndIsTold) {
  ConsoleConfig config;
  config.answer_bytes = 512;
  config.queue_bytes = 256;
  Bench bench(config);
  for (int i = 0; i < 50; ++i) bench.console.feed(std::string_view("{\"cmd\":\"status\"}\n"), kSecond);
  EXPECT_EQ(bench.handler.calls.size(), 50U);
  EXPECT_GT(bench.console.output().lost_messages(), 30U);
  const std::string first = bench.drain();
  EXPECT_EQ(first.size() % std::string("{\"cmd\":\"status\",\"ok\":true,\"data\":{\"state\":\"IDLE\"}}\r\n").size(),
            0U);
  EXPECT_EQ(bench.type("{\"cmd\":\"status\"}\n").find("{\"ev\":\"lost\",\"messages\":"), 0U);
}

TEST(Console, AnswerTooLong_IsAnError) {
  Bench bench;
  bench.handler.export_bytes = 100'000;
  EXPECT_NE(bench.type("export json\r").find("export: the answer is longer than the console's buffer"),
            std::string::npos);
  EXPECT_EQ(bench.console.counters().long_answers, 1U);
}

TEST(Console, Events_FollowTheModeAndKeepWhatIsTyped) {
  Bench bench;
  const auto progress = [&] { bench.console.event("progress", [](Reply& reply) { reply.integer("percent", 40); }); };
  progress();
  EXPECT_EQ(bench.drain(), "");  // nobody has spoken yet
  bench.type("status\rhal");
  progress();
  EXPECT_EQ(bench.drain(), "\r\x1b[K* progress\r\npercent: 40\r\n\rroomcal> hal\x1b[K");
  bench.type("\x15{\"cmd\":\"status\"}\n");
  progress();
  EXPECT_EQ(bench.drain(), "{\"ev\":\"progress\",\"data\":{\"percent\":40}}\r\n");
}

TEST(Console, EventAfterEnter_LeavesAnEmptyPrompt) {
  Bench bench;
  bench.type("calibrate\x02\x02\r");
  bench.console.event("progress", [](Reply& reply) { reply.integer("percent", 40); });
  EXPECT_EQ(bench.drain(), "\r\x1b[K* progress\r\npercent: 40\r\n\rroomcal> \x1b[K");
  bench.console.grant(Rights::kOperate, kSecond);
  EXPECT_EQ(bench.drain(), "\r\x1b[K* rights\r\nnow: operate\r\n\rroomcal+> \x1b[K");
}

TEST(Console, RefusedArena_IsOutOfMemory) {
  std::vector<std::byte> block(plan_console_bytes() / 2);
  Arena arena(block);
  Handler handler;
  Console console;
  EXPECT_EQ(console.open(arena, handler).code(), StatusCode::kOutOfMemory);
}

}  // namespace
}  // namespace roomcal::console
