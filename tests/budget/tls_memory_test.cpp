// Fixed memory on board tls, which wants a bus with a drive on it: ten calibrations in a row with every heap call of
// the device's threads counted from arming on: none, no page fault, no arena that refused, peaks within the budget
// file. The others of the boards: board_memory_test.py; the supervisor's part of the bus: can_heap_test.cpp.

#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/board/tls_bench.h"
#include "tests/budget/heap_guard.h"

namespace roomcal::board {
namespace {

constexpr int kCalibrations = 10;
// A table in a hurry: the memory is the same.
constexpr double kHalfTurn_s = 1.2, kHaste = 10;

nlohmann::json budget() {
  return nlohmann::json::parse(std::ifstream(ROOMCAL_SOURCE_DIR "/tests/budget/boards.json")).at("tls");
}

void check_arenas(const face::Vitals& vitals, const nlohmann::json& budget) {
  std::size_t session = 0;
  for (const face::ArenaVitals& arena : vitals.arenas) {
    EXPECT_EQ(arena.refusals, 0U) << arena.name;
    if (arena.name != "board") session += arena.peak;
  }
  EXPECT_LE(session, budget.at("session_arena").get<std::size_t>());
  std::printf("tls: %d calibrations, session %zu B", kCalibrations, session);
}

void check_threads(const face::Vitals& vitals, const nlohmann::json& budget) {
  for (const face::ThreadVitals& thread : vitals.threads) {
    const bool session = thread.name.view() == "session";
    EXPECT_LE(thread.stack_peak, budget.at(session ? "session_stack" : "sensor_stack").get<std::size_t>())
        << thread.name.view();
    EXPECT_LT(thread.stack_peak, thread.stack_bytes) << thread.name.view();
    EXPECT_TRUE(!vitals.locked || thread.minor_faults + thread.major_faults == 0) << thread.name.view();
    std::printf(", stack of %s %zu B", std::string(thread.name.view()).c_str(), thread.stack_peak);
  }
  std::printf("\n");
}

TEST(TlsMemory, TenCalibrationsInARow_TakeNothingAfterArming) {
  budget::ThreadsHeapGuard::stand_outside();
  test::TlsBench bench(kHalfTurn_s, kHaste, budget::ThreadsHeapGuard::stand_outside);
  ASSERT_TRUE(bench.trouble().empty()) << bench.trouble().view();
  {
    budget::ThreadsHeapGuard guard;
    for (int i = 0; i < kCalibrations; ++i) {
      const press::Report& report = bench.press(press::Kind::kCalibrate);
      ASSERT_TRUE(report.stored) << to_string(report.result) << ": "
                                 << (report.reasons.empty() ? "" : report.reasons[0].view());
    }
    EXPECT_EQ(guard.calls(), 0U);
  }
  face::Vitals vitals;
  bench.machine().examine(vitals);
  check_arenas(vitals, budget());
  check_threads(vitals, budget());
}

// A guard that counts nothing would be content with everything.
TEST(TlsMemory, HeapCallOfAnyThread_IsCountedUnlessItStandsOutside) {
  struct Taker final : drivers::Thread::Body {
    void run() override {
      if (outside) budget::ThreadsHeapGuard::stand_outside();
      block = std::make_unique<char[]>(100);
    }
    bool outside = false;
    std::unique_ptr<char[]> block;
  };
  for (const bool outside : {false, true}) {
    Taker taker;
    taker.outside = outside;
    drivers::Thread thread;
    ASSERT_TRUE(thread.start({}, taker).ok());
    thread.join();
    taker.block.reset();
    budget::ThreadsHeapGuard guard;
    ASSERT_TRUE(thread.start({}, taker).ok());
    thread.join();
    std::size_t counted = guard.calls();
    EXPECT_EQ(counted >= 1, !outside) << counted;
  }
}

}  // namespace
}  // namespace roomcal::board
