#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/console/line_editor.h"
#include "runtime/console/output_queue.h"
#include "runtime/console/reply.h"
#include "runtime/console/request.h"
#include "runtime/console/rights.h"
#include "runtime/console/verbs.h"
#include "runtime/ports/byte_sink.h"

namespace roomcal::console {

/// What the board does when a verb was asked for by somebody who may. Called from Console::feed(); must not wait: a
/// verb that takes long starts its work here and tells about it by events.
class CommandHandler {
 public:
  virtual ~CommandHandler() = default;
  /// @param reply  the answer, if the status is ok; otherwise the status is the answer and what was replied is dropped.
  virtual Status run(VerbId verb, std::span<const Word> arguments, Reply& reply) = 0;
};

struct ConsoleConfig {
  std::size_t answer_bytes = 40 * 1024;  ///< longest answer: an export of twelve sensors as one JSON string
  std::size_t queue_bytes = 48 * 1024;
  int64_t rights_hold_ns = 300'000'000'000;    ///< raised rights fall back after this
  int64_t json_timeout_ns = 2'000'000'000;     ///< a machine does not pause within a line
  int64_t typing_timeout_ns = 60'000'000'000;  ///< a person does, but then has gone
  std::string_view prompt = "roomcal";
  std::string_view how_to_raise = "hold the device's button, then try again";
};

/// Monotone counts since open().
struct ConsoleCounters {
  uint64_t lines = 0;
  uint64_t noise_lines = 0;   ///< dropped for bytes that nobody types
  uint64_t stale_lines = 0;   ///< begun and not ended in time
  uint64_t refused = 0;       ///< for lack of rights
  uint64_t long_answers = 0;  ///< did not fit into answer_bytes; an error was sent instead
};

/// The serial console: lines in, answers out, for a person or, where the line starts with `{`, for a machine.
///
/// Nothing happens before a whole, clean line names a verb exactly; what changes anything needs rights besides. Output
/// goes through a queue that drops whole messages and counts them, so no reader, however slow, holds the runtime up.
///
/// Not thread-safe. Memory from the arena (plan_console_bytes()); no heap. feed() does bounded work a byte, and one
/// call of the handler a line: a board that must not lose time to a flood feeds fewer bytes at once.
class Console {
 public:
  Console() = default;
  Console(const Console&) = delete;  // the editor points at the prompt
  Console& operator=(const Console&) = delete;

  /// @param handler  outlives the console.
  /// @return kOutOfMemory if the arena refuses.
  Status open(Arena& arena, CommandHandler& handler, const ConsoleConfig& config = {});

  void feed(std::span<const char> bytes, int64_t now_ns);
  /// Lets half lines and rights lapse; call it a few times a second.
  void tick(int64_t now_ns);
  /// Somebody proved to be at the device.
  void grant(Rights rights, int64_t now_ns);
  /// What happens by itself, progress above all: `fill` is called with a Reply. Like answers, events follow the mode of
  /// the last line; none is sent before the first line, so that a silent port stays silent.
  template <typename Fill>
  void event(std::string_view name, const Fill& fill) {
    if (!greeted_) return;
    TextWriter out(answer_);
    begin_event(name, out);
    Reply reply(out, json_);
    fill(reply);
    end_event(out);
  }
  void pump(ports::ByteSink& sink);

  Rights rights() const { return gate_.rights(); }
  const ConsoleCounters& counters() const { return counters_; }
  const OutputQueue& output() const { return queue_; }

 private:
  void take(LineEvent event, int64_t now_ns);
  void run_line();
  void run(const Request& request, Status parsed);
  Status dispatch(const Request& request, Reply& reply);
  Status help(std::span<const Word> arguments, Reply& reply) const;
  void answer_error(const Request& request, Status status);
  void offer_completions();
  void begin_event(std::string_view name, TextWriter& out) const;
  void end_event(TextWriter& out);
  void send(std::string_view message);
  void send_prompt();
  void update_prompt();

  CommandHandler* handler_ = nullptr;
  ConsoleConfig config_;
  LineEditor editor_;
  RightsGate gate_{0};
  OutputQueue queue_;
  std::span<char> answer_;
  FixedText<48> prompt_;
  ConsoleCounters counters_;
  uint64_t told_lost_ = 0;
  int64_t last_byte_ns_ = 0;
  bool json_ = false;
  bool greeted_ = false;
};

/// Bytes that open() takes from its arena.
constexpr std::size_t plan_console_bytes(const ConsoleConfig& config = {}) {
  return config.answer_bytes + config.queue_bytes + 64;
}

}  // namespace roomcal::console
