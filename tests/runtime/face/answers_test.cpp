// Every verb of the console, answered from a store, the vitals and a desk that only notes what it was asked for.
#include "runtime/face/answers.h"

#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fakes/manual_clocks.h"
#include "tests/runtime/store/sample_record.h"
#include "tests/runtime/store/store_bench.h"

namespace roomcal::face {
namespace {

using console::Reply;
using console::VerbId;
using console::Word;

struct NotingDesk final : Desk {
  Status start(press::Kind kind) override { return note(std::string("start ") + to_string(kind)); }
  Status abort() override { return note("abort"); }
  Status look(std::string_view sensor) override { return note("look '" + std::string(sensor) + "'"); }
  Status selftest(std::string_view part, Reason& detail) override {
    detail = "works";
    return note("selftest " + std::string(part));
  }
  Status reboot() override { return note("reboot"); }
  void examine(Vitals& out) override { out = vitals; }
  void read_log(std::size_t lines, void (*visit)(void* context, std::string_view line), void* context) override {
    asked.push_back("log " + std::to_string(lines));
    visit(context, "1.000 cam0: \"back\"");
  }
  int64_t unix_s() const override { return 1'700'000'000; }

  Status note(const std::string& what) {
    asked.push_back(what);
    return status;
  }
  Vitals vitals;
  Status status;
  std::vector<std::string> asked;
};

/// A device with a store and nothing measured since its start.
class AnswersTest : public testing::Test {
 protected:
  AnswersTest() {
    known_.firmware = "roomcald 1.2";
    known_.board = "sim";
    known_.store = &bench_.store;
    renew();
  }
  void renew() { answers_ = std::make_unique<Answers>(desk_, known_); }

  /// The answer for a machine; of a refusal its detail.
  std::string ask(VerbId verb, std::initializer_list<std::string_view> arguments = {}) {
    std::vector<Word> words(arguments.begin(), arguments.end());
    text_.assign(64 * 1024, '\0');
    TextWriter out(text_);
    Reply reply(out, true);
    status_ = answers_->run(verb, words, reply);
    EXPECT_FALSE(out.overflowed());
    if (status_.ok()) return std::string(out.view());
    EXPECT_NE(status_.detail(), nullptr);
    return status_.detail();
  }
  void commit(uint64_t seed) {
    const Status committed = bench_.store.commit(store::test::sample_record(seed), 1'700'000'000);
    ASSERT_TRUE(committed.ok()) << committed.detail();
  }

  NotingDesk desk_;
  store::test::StoreBench bench_;
  Known known_;
  std::unique_ptr<Answers> answers_;
  std::string text_;
  Status status_;
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST_F(AnswersTest, DeviceThatCouldNotBeArmed_AnswersEveryVerb) {
  known_ = {};
  renew();
  desk_.status = {StatusCode::kUnavailable, "the device is not armed: see `status`"};
  desk_.vitals.safe_mode = true;
  desk_.vitals.trouble = "map: room.room is not there: copy it";
  for (std::size_t verb = 1; verb < console::kVerbCount; ++verb) {
    const bool exports = static_cast<VerbId>(verb) == VerbId::kExport;
    const std::string answer = exports ? ask(VerbId::kExport, {"json"}) : ask(static_cast<VerbId>(verb));
    const bool lists_sensors = static_cast<VerbId>(verb) == VerbId::kSensors;  // it has none
    EXPECT_EQ(answer.empty(), lists_sensors) << console::verbs()[verb].name;
  }
  const std::string status = ask(VerbId::kStatus);
  EXPECT_TRUE(has(status, "\"mode\":\"SAFE\",\"trouble\":\"map: room.room is not there: copy it\"")) << status;
  EXPECT_TRUE(has(ask(VerbId::kHealth), "\"well\":false"));
  EXPECT_EQ(ask(VerbId::kUndo), "the store could not be opened: see `health`");
  EXPECT_TRUE(has(ask(VerbId::kMap), "no map could be read"));
}

TEST_F(AnswersTest, VerbsThatWork_AreHandedToTheDesk) {
  EXPECT_EQ(ask(VerbId::kVerify), "\"started\":\"verify\"");
  EXPECT_EQ(ask(VerbId::kCalibrate), "\"started\":\"calibrate\"");
  EXPECT_EQ(ask(VerbId::kCalibrate, {"dry-run"}), "\"started\":\"dry-run\"");
  EXPECT_EQ(ask(VerbId::kCalibrate, {"abort"}), "");
  EXPECT_EQ(ask(VerbId::kGrab), "\"started\":\"grab\"");
  EXPECT_EQ(ask(VerbId::kGrab, {"cam1"}), "\"started\":\"grab\"");
  EXPECT_EQ(ask(VerbId::kSelftest), "\"sensors\":\"works\"");
  EXPECT_EQ(ask(VerbId::kSelftest, {"led"}), "\"led\":\"works\"");
  EXPECT_EQ(ask(VerbId::kReboot), "\"reboot\":\"in a second\"");
  EXPECT_EQ(desk_.asked,
            (std::vector<std::string>{"start verify", "start calibrate", "start dry-run", "abort", "look ''",
                                      "look 'cam1'", "selftest sensors", "selftest led", "reboot"}));
  desk_.status = {StatusCode::kUnavailable, "something runs already"};
  for (const VerbId verb : {VerbId::kVerify, VerbId::kCalibrate, VerbId::kGrab, VerbId::kSelftest, VerbId::kReboot})
    EXPECT_EQ(ask(verb), "something runs already");
}

TEST_F(AnswersTest, Log_TakesANumberOfLines) {
  EXPECT_EQ(ask(VerbId::kLog), "\"lines\":[\"1.000 cam0: \\\"back\\\"\"]");
  ask(VerbId::kLog, {"5"});
  EXPECT_EQ(desk_.asked, (std::vector<std::string>{"log 20", "log 5"}));
  for (const std::string_view bad : {"many", "-1", "5x", "99999999999999999999999"}) {
    EXPECT_EQ(ask(VerbId::kLog, {bad}), "log takes a number of lines");
    EXPECT_EQ(status_.code(), StatusCode::kInvalidArgument);
  }
}

TEST_F(AnswersTest, TriggerThatCannotBeHad_IsToldWithWhatTookItsPlace) {
  desk_.vitals.trigger = "free";
  desk_.vitals.trigger_trouble = "trigger: no such line: cameras run free";
  EXPECT_TRUE(has(ask(VerbId::kSensors), "\"trigger\":\"free\""));
  EXPECT_TRUE(has(ask(VerbId::kHealth), "\"trigger: no such line: cameras run free\""));
}

TEST_F(AnswersTest, Uncalibrated_IsNeverIdentity) {
  EXPECT_TRUE(has(ask(VerbId::kStatus), "\"state\":\"IDLE\",\"store\":\"UNCALIBRATED\""));
  for (const VerbId verb : {VerbId::kDiff, VerbId::kUndo, VerbId::kRestoreFactory}) {
    ask(verb);
    EXPECT_EQ(status_.code(), StatusCode::kNotFound) << static_cast<int>(verb);
  }
  EXPECT_TRUE(has(ask(VerbId::kExport, {"json"}), "UNCALIBRATED"));
  EXPECT_EQ(ask(VerbId::kHistory), "\"store\":\"UNCALIBRATED\",\"records\":[]");
  EXPECT_TRUE(has(ask(VerbId::kResult), "nothing was measured"));
}

TEST_F(AnswersTest, HistoryDiffAndUndo_FollowTheStore) {
  commit(1);
  commit(2);
  EXPECT_TRUE(has(ask(VerbId::kStatus), "\"store\":\"CALIBRATED\",\"generation\":2,\"content_generation\":2"));
  const std::string history = ask(VerbId::kHistory);
  EXPECT_LT(history.find("\"generation\":2"), history.find("\"generation\":1")) << history;
  EXPECT_TRUE(has(history, "\"in_force\":true"));
  const std::string diff = ask(VerbId::kDiff);
  EXPECT_TRUE(has(diff, "\"from_generation\":1,\"to_generation\":2")) << diff;
  EXPECT_TRUE(has(diff, "\"distance_m\":")) << diff;
  EXPECT_TRUE(has(ask(VerbId::kDiff, {"2", "1"}), "\"from_generation\":2,\"to_generation\":1"));
  const std::string undone = ask(VerbId::kUndo);
  EXPECT_TRUE(has(undone, "\"generation\":3,\"content_generation\":1")) << undone;
  EXPECT_TRUE(has(ask(VerbId::kDiff, {"2"}), "\"from_generation\":2,\"to_generation\":3"));
  ask(VerbId::kDiff);
  EXPECT_EQ(status_.code(), StatusCode::kNotFound) << "before the first content there is none";
}

TEST_F(AnswersTest, GenerationsThatAreNone_AreRefused) {
  commit(1);
  for (const std::string_view bad : {"latest", "-1", "1.5", "1 ", "99999999999999999999999"}) {
    EXPECT_EQ(ask(VerbId::kDiff, {bad}), "a generation is a whole number: see `history`") << bad;
    EXPECT_EQ(ask(VerbId::kDiff, {"1", bad}), "a generation is a whole number: see `history`") << bad;
  }
  ask(VerbId::kDiff, {"77"});
  EXPECT_EQ(status_.code(), StatusCode::kNotFound);
}

TEST_F(AnswersTest, Factory_IsToldAndRestored) {
  ASSERT_TRUE(bench_.store.provision(store::test::sample_record(9), 1'690'000'000).ok());
  EXPECT_TRUE(has(ask(VerbId::kStatus), "\"store\":\"FACTORY\""));
  commit(1);
  const std::string restored = ask(VerbId::kRestoreFactory);
  EXPECT_TRUE(has(restored, "\"generation\":2,\"content_generation\":0")) << restored;
}

TEST_F(AnswersTest, Export_KnowsEveryFormatThatTheConsoleOffers) {
  commit(1);
  for (const std::string_view format : console::find_verb("export")->choices) {
    const std::string answer =
        format == "camera_info" ? ask(VerbId::kExport, {format, "cam0"}) : ask(VerbId::kExport, {format});
    EXPECT_TRUE(status_.ok()) << format << ": " << answer;
    EXPECT_GT(answer.size(), 200U) << format;
    EXPECT_TRUE(answer.starts_with("\"document\":\"")) << format;
  }
  ask(VerbId::kExport, {"pdf"});
  EXPECT_FALSE(status_.ok());
  ask(VerbId::kExport, {"camera_info", "nobody"});
  EXPECT_FALSE(status_.ok());
}

TEST_F(AnswersTest, Health_TellsEverythingThatIsWrongInOneList) {
  Vitals& v = desk_.vitals;
  EXPECT_EQ(ask(VerbId::kHealth), "\"complaints\":[],\"well\":true");
  CameraVitals camera;
  camera.name = "cam0";
  camera.health.last_fault = ports::ImageFault::kGone;
  ASSERT_TRUE(v.cameras.push_back(camera));
  LidarVitals lidar;
  lidar.name = "lidar0";
  ASSERT_TRUE(v.lidars.push_back(lidar));
  v.has_can = true;
  v.can = ports::CanState::kBusOff;
  v.servo_trouble = "servo: node 5 does not answer";
  v.has_stillness = true;
  v.stillness = {false, "can0: the vehicle moves"};
  v.locked_bytes = 1000;
  const std::string health = ask(VerbId::kHealth);
  for (const char* part :
       {"cam0: ", "lidar0: ", "can: bus-off", "servo: node 5", "the vehicle moves", "LimitMEMLOCK", "\"well\":false"})
    EXPECT_TRUE(has(health, part)) << part << " is not in " << health;
}

TEST_F(AnswersTest, DamageInTheStore_IsAComplaint) {
  commit(1);
  commit(2);
  for (std::size_t at = 0; at < 200; ++at) bench_.medium.durable_byte(store::test::kSlotBytes + at) ^= std::byte{0xFF};
  bench_.restart();
  const std::string health = ask(VerbId::kHealth);
  EXPECT_TRUE(has(health, "\"well\":false")) << health;
}

TEST_F(AnswersTest, SensorsMemAndClock_TellTheVitals) {
  Vitals& v = desk_.vitals;
  CameraVitals camera;
  camera.name = "cam0";
  camera.driver = "v4l2";
  camera.health.faults[static_cast<std::size_t>(ports::ImageFault::kShort)] = 3;
  ASSERT_TRUE(v.cameras.push_back(camera));
  LidarVitals lidar;
  lidar.name = "lidar0";
  lidar.packets.kernel_drops = 17;
  ASSERT_TRUE(v.lidars.push_back(lidar));
  ThreadVitals thread;
  thread.name = "session";
  thread.stack_peak = 4711;
  ASSERT_TRUE(v.threads.push_back(thread));
  ArenaVitals arena;
  arena.name = "step";
  arena.peak = 12345;
  ASSERT_TRUE(v.arenas.push_back(arena));
  v.has_can = true;
  v.can_counters.bus_offs = 2;
  v.clocks = {10'000'000'000, 1'700'000'000'000'000'000, 12'000'000'000, 0};
  v.now_ns = v.clocks.monotonic_ns;
  const std::string sensors = ask(VerbId::kSensors);
  for (const char* part :
       {"\"cam0\":{\"driver\":\"v4l2\"", "\"faults\":{\"", ":3}", "\"kernel_drops\":17", "\"bus_offs\":2"})
    EXPECT_TRUE(has(sensors, part)) << part << " is not in " << sensors;
  const std::string mem = ask(VerbId::kMem);
  for (const char* part : {"\"step\":{", "\"peak\":12345", "\"session\":{", "\"stack_peak\":4711"})
    EXPECT_TRUE(has(mem, part)) << part << " is not in " << mem;
  const std::string clock = ask(VerbId::kClock);
  EXPECT_TRUE(has(clock, "\"boottime\":{\"s\":12.0,\"ahead_of_monotonic_s\":2.0")) << clock;
  EXPECT_FALSE(has(clock, "\"tai\"")) << "a clock that the host does not have";
}

TEST_F(AnswersTest, WhileAPressRuns_ItsThreadOwnsStoreAndReport) {
  const auto device = std::make_unique<calib::Device>();
  const map::RoomMap room;
  const map::TriangleIndex index;
  calib::Session session{*device, room, index, {}};
  const grab::Sources sources;
  const fakes::ManualClocks clocks;
  grab::Grabber grabber(sources, {}, clocks);
  Arenas arenas;
  const auto press = std::make_unique<press::Press>(
      press::Parts{session, grabber, bench_.store, arenas, clocks, "firmware", "serial", nullptr, nullptr, "free"});
  commit(1);
  known_.press = press.get();
  renew();
  EXPECT_TRUE(has(ask(VerbId::kStatus), "\"state\":\"IDLE\",\"result\":\"NONE\",\"store\":\"CALIBRATED\""));
  press->begin();
  EXPECT_EQ(ask(VerbId::kStatus), "\"state\":\"WAIT_STILL\",\"percent\":0");
  for (const VerbId verb : {VerbId::kResult, VerbId::kHistory, VerbId::kDiff, VerbId::kUndo, VerbId::kRestoreFactory}) {
    EXPECT_TRUE(has(ask(verb), "a press runs")) << static_cast<int>(verb);
    EXPECT_EQ(status_.code(), StatusCode::kUnavailable);
  }
  EXPECT_TRUE(has(ask(VerbId::kExport, {"json"}), "a press runs"));
  EXPECT_TRUE(has(ask(VerbId::kHealth), "\"well\":true"));
}

}  // namespace
}  // namespace roomcal::face
