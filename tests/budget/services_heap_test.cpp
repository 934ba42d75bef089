// The services around a calibration make no heap call either: store, exports, console.

#include <vector>

#include <gtest/gtest.h>

#include "runtime/console/console.h"
#include "runtime/export/export.h"
#include "runtime/store/diff.h"
#include "runtime/store/store.h"
#include "tests/budget/heap_guard.h"
#include "tests/runtime/store/sample_record.h"

namespace roomcal {
namespace {

// A medium without a heap of its own.
class ArrayMedium final : public ports::Medium {
 public:
  explicit ArrayMedium(std::span<std::byte> bytes) : bytes_(bytes) {}
  std::size_t size_bytes() const override { return bytes_.size(); }
  std::size_t page_bytes() const override { return 256; }
  Status read(std::size_t offset, std::span<std::byte> out) override {
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), out.size(), out.begin());
    return ok_status();
  }
  Status write_page(std::size_t offset, std::span<const std::byte> page) override {
    std::copy(page.begin(), page.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
    return ok_status();
  }
  Status sync() override { return ok_status(); }
  Status drop_caches() override { return ok_status(); }

 private:
  std::span<std::byte> bytes_;
};

struct Handler final : console::CommandHandler {
  Status run(console::VerbId /*verb*/, std::span<const console::Word> /*arguments*/, console::Reply& reply) override {
    reply.number("x", 0.1, 3, "m");
    return ok_status();
  }
};

struct NoSink final : ports::ByteSink {
  std::size_t write_some(std::span<const char> bytes) override { return bytes.size(); }
};

class ServicesHeap : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "the sanitizer brings its own allocator";
#endif
  }

  const store::Record first_ = store::test::sample_record(1, 4, 2), second_ = store::test::sample_record(2, 4, 2);
};

TEST_F(ServicesHeap, StoreFromOpenToUndo_NoCall) {
  std::vector<std::byte> bytes(store::kSlotCount * 4096, std::byte{0xFF}), block(store::plan_store_bytes(256));
  store::History history;
  std::size_t calls = 0;
  bool ok = true;
  {
    const budget::HeapGuard guard;
    ArrayMedium medium(bytes);
    Arena arena(block);
    store::Store store;
    ok = store.open(medium, arena).ok() && store.provision(first_, 1).ok();
    for (int i = 0; i < 12; ++i) ok = ok && store.commit(i % 2 == 0 ? second_ : first_, 2).ok();
    ok = ok && store.undo(3).ok() && store.restore_factory(4).ok();
    store.list(history);
    static_cast<void>(store::diff(first_, second_));
    static_cast<void>(store.diagnosis());
    calls = guard.calls();
  }
  EXPECT_TRUE(ok);
  EXPECT_EQ(history.size(), 10U);
  EXPECT_EQ(calls, 0U);
}

TEST_F(ServicesHeap, EveryExport_NoCall) {
  std::vector<char> text(32768);
  std::size_t calls = 0;
  bool ok = true;
  {
    const budget::HeapGuard guard;
    for (int format = 0; format <= static_cast<int>(exports::Format::kOpenCv); ++format) {
      TextWriter out(text);
      ok = ok && exports::write(first_, static_cast<exports::Format>(format), "cam0", out).ok();
    }
    calls = guard.calls();
  }
  EXPECT_TRUE(ok);
  EXPECT_EQ(calls, 0U);
}

TEST_F(ServicesHeap, ConsoleInBothModes_NoCall) {
  std::vector<std::byte> block(console::plan_console_bytes());
  std::size_t calls = 0;
  uint64_t lines = 0;
  {
    const budget::HeapGuard guard;
    Arena arena(block);
    Handler handler;
    NoSink sink;
    console::Console console;
    static_cast<void>(console.open(arena, handler));
    console.grant(console::Rights::kService, 0);
    for (int i = 0; i < 100; ++i) {
      console.feed(
          std::string_view("he\t\rexp\tk\t\r\x1b[A\x01x\x05\x7f\r{\"cmd\":\"status\",\"id\":1}\n{\"cmd\":\n\x80\r"), i);
      console.event("progress", [](console::Reply& reply) { reply.integer("percent", 1); });
      console.pump(sink);
    }
    lines = console.counters().lines;
    calls = guard.calls();
  }
  EXPECT_EQ(lines, 500U);
  EXPECT_EQ(calls, 0U);
}

}  // namespace
}  // namespace roomcal
