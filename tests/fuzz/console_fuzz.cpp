// Bytes as they may come down a serial line, at full rights, read back slowly: people's lines and JSON alike. Whatever
// comes, a verb is called only with arguments that its table allows, and a JSON line is answered by one line of JSON.

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "runtime/console/console.h"

namespace {

using namespace roomcal;
using namespace roomcal::console;

struct Handler final : CommandHandler {
  Status run(VerbId id, std::span<const Word> arguments, Reply& reply) override {
    const Verb& verb = verbs()[static_cast<std::size_t>(id)];
    if (arguments.size() < verb.min_arguments || arguments.size() > verb.max_arguments) __builtin_trap();
    reply.text("verb", verb.name);
    reply.open_list("arguments");
    for (const Word& word : arguments) reply.text({}, word.view());
    reply.close_list();
    return id == VerbId::kDiff ? Status(StatusCode::kNotFound, "nothing to compare") : ok_status();
  }
};

struct Sink final : ports::ByteSink {
  std::size_t write_some(std::span<const char> bytes) override {
    const std::size_t taken = std::min<std::size_t>(bytes.size(), 1500);
    text.append(bytes.data(), taken);
    return taken;
  }
  std::string text;
};

struct Bench {
  Bench() : arena(block) {
    if (!console.open(arena, handler, config).ok()) __builtin_trap();
    console.grant(Rights::kService, 0);
  }

  ConsoleConfig config{.answer_bytes = 4096, .queue_bytes = 8192};
  std::vector<std::byte> block = std::vector<std::byte>(plan_console_bytes(config));
  Arena arena;
  Handler handler;
  Console console;
  Sink sink;
};

// Bytes as they come, with time passing, events in between and a slow reader.
void as_it_comes(std::span<const char> bytes) {
  Bench bench;
  int64_t now_ns = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 64) {
    bench.console.feed(bytes.subspan(at, std::min<std::size_t>(64, bytes.size() - at)), now_ns);
    bench.console.event("progress", [](Reply& reply) { reply.integer("percent", 1); });
    bench.console.pump(bench.sink);
    now_ns += 500'000'000;
  }
}

// The same as a machine's lines: each gets exactly one line of JSON.
void as_json_lines(std::string_view text) {
  Bench bench;
  while (!text.empty()) {
    const std::size_t end = text.find_first_of("\r\n");
    std::string line = "{";
    line.append(text.substr(0, end)).append("\n");
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    bench.sink.text.clear();
    bench.console.feed(line, 0);
    bench.console.pump(bench.sink);
    bench.console.pump(bench.sink);
    bench.console.pump(bench.sink);
    const std::string& answer = bench.sink.text;
    if (answer.find('\n') != answer.size() - 1 || !nlohmann::json::accept(answer)) __builtin_trap();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  as_it_comes(text);
  as_json_lines(text);
  return 0;
}
