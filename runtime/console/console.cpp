#include "runtime/console/console.h"

#include <algorithm>

namespace roomcal::console {

namespace {

constexpr std::size_t kEchoBytes = 3 * kMaxLine + 128;  // what one key can make a terminal redraw

void write_id(const Request& request, TextWriter& out) {
  out.text("{");
  if (request.has_id) out.text("\"id\":").integer(request.id).text(",");
}

}  // namespace

Status Console::open(Arena& arena, CommandHandler& handler, const ConsoleConfig& config) {
  config_ = config;
  handler_ = &handler;
  answer_ = arena.allocate<char>(config.answer_bytes);
  const std::span<char> ring = arena.allocate<char>(config.queue_bytes);
  if (answer_.empty() || ring.empty()) return out_of_arena("the console's buffers");
  queue_ = OutputQueue(ring);
  gate_ = RightsGate(config.rights_hold_ns);
  update_prompt();
  return ok_status();
}

void Console::update_prompt() {
  constexpr std::string_view kMarks[] = {"> ", "+> ", "#> "};
  prompt_ = config_.prompt;
  prompt_.append(kMarks[static_cast<std::size_t>(gate_.rights())]);
  editor_.set_prompt(prompt_.view());
}

void Console::send(std::string_view message) {
  if (queue_.lost_messages() > told_lost_) {
    char text[96];
    TextWriter out(text);
    const uint64_t lost = queue_.lost_messages();
    out.text(json_ ? "{\"ev\":\"lost\",\"messages\":" : "[")
        .unsigned_integer(lost - told_lost_)
        .text(json_ ? "}\n" : " messages lost]\n");
    if (out.view().size() + message.size() + 2 < queue_.capacity() - queue_.size() && queue_.push(out.view(), "\r\n"))
      told_lost_ = lost;
  }
  static_cast<void>(queue_.push(message, "\r\n"));
}

void Console::send_prompt() {
  if (!json_) send(prompt_.view());
}

void Console::pump(ports::ByteSink& sink) { queue_.pump(sink); }

void Console::feed(std::span<const char> bytes, int64_t now_ns) {
  tick(now_ns);
  last_byte_ns_ = now_ns;
  for (const char byte : bytes) {
    char text[kEchoBytes];
    TextWriter echo(text);
    const LineEvent event = editor_.feed(byte, echo);
    if (!echo.view().empty()) send(echo.view());
    if (event != LineEvent::kNone) take(event, now_ns);
  }
}

void Console::take(LineEvent event, int64_t now_ns) {
  if (event == LineEvent::kComplete) return offer_completions();
  static_cast<void>(gate_.lapse(now_ns));
  update_prompt();
  if (editor_.is_json() && !json_ && greeted_) send("\n");  // leaves the prompt's line to the person's terminal
  greeted_ = true;
  json_ = editor_.is_json();
  Request request;
  request.json = json_;
  if (event == LineEvent::kLine) {
    ++counters_.lines;
    run_line();
  } else if (event == LineEvent::kNoise) {
    ++counters_.noise_lines;
    answer_error(request, {StatusCode::kInvalidArgument, "the line had noise in it; nothing was done"});
  } else {
    answer_error(request, {StatusCode::kOutOfRange, "the line is too long; nothing was done"});
  }
  send_prompt();
}

void Console::tick(int64_t now_ns) {
  if (gate_.lapse(now_ns)) {
    update_prompt();
    event("rights", [](Reply& reply) { reply.text("now", to_string(Rights::kObserve)); });
  }
  const int64_t timeout_ns = editor_.is_json() ? config_.json_timeout_ns : config_.typing_timeout_ns;
  if (!editor_.pending() || now_ns - last_byte_ns_ < timeout_ns) return;
  ++counters_.stale_lines;
  Request request;
  request.json = json_ = editor_.is_json();
  editor_.drop();
  if (!json_) send("\n");
  answer_error(request, {StatusCode::kUnavailable, "the line was not ended in time; nothing was done"});
  send_prompt();
}

void Console::grant(Rights rights, int64_t now_ns) {
  gate_.grant(rights, now_ns);
  update_prompt();
  event("rights", [this](Reply& reply) { reply.text("now", to_string(gate_.rights())); });
}

void Console::run_line() {
  Request request;
  const Status parsed = json_ ? parse_json(editor_.line(), request) : parse_words(editor_.line(), request);
  if (parsed.ok() && request.verb.empty() && !json_) return;
  run(request, parsed);
}

void Console::run(const Request& request, Status parsed) {
  if (!parsed.ok()) return answer_error(request, parsed);
  TextWriter out(answer_);
  if (json_) {
    write_id(request, out);
    out.text("\"cmd\":").quoted(request.verb.view()).text(",\"ok\":true,\"data\":{");
  }
  Reply reply(out, json_);
  const Status status = dispatch(request, reply);
  if (!status.ok()) return answer_error(request, status);
  if (json_) out.text("}}\n");
  if (!out.overflowed()) return send(out.view());
  ++counters_.long_answers;
  answer_error(request, {StatusCode::kCapacity, "the answer is longer than the console's buffer"});
}

Status Console::dispatch(const Request& request, Reply& reply) {
  const Verb* verb = find_verb(request.verb.view());
  if (verb == nullptr) return {StatusCode::kNotFound, "no such verb; help lists them"};
  const std::span<const Word> arguments = request.arguments.span();
  if (arguments.size() < verb->min_arguments || arguments.size() > verb->max_arguments)
    return {StatusCode::kInvalidArgument, "the verb takes other arguments; see help"};
  const bool is_choice = std::any_of(verb->choices.begin(), verb->choices.end(),
                                     [&](std::string_view choice) { return arguments[0].view() == choice; });
  if (!arguments.empty() && !verb->choices.empty() && !is_choice)
    return {StatusCode::kInvalidArgument, "the verb has no such choice; see help"};
  if (verb->rights > gate_.rights()) {
    ++counters_.refused;
    return {StatusCode::kUnavailable, nullptr};  // worded by answer_error(), which knows the verb
  }
  return verb->id == VerbId::kHelp ? help(arguments, reply) : handler_->run(verb->id, arguments, reply);
}

Status Console::help(std::span<const Word> arguments, Reply& reply) const {
  const Verb* only = arguments.empty() ? nullptr : find_verb(arguments[0].view());
  if (!arguments.empty() && only == nullptr) return {StatusCode::kNotFound, "no such verb; help lists them"};
  for (const Verb& verb : verbs()) {
    if (only != nullptr && only != &verb) continue;
    FixedText<160> line(verb.name);
    for (const std::string_view part :
         {std::string_view(verb.arguments.empty() ? "" : " "), verb.arguments, std::string_view(" - "), verb.summary,
          std::string_view(verb.rights == Rights::kObserve ? "" : " (rights: ")})
      line.append(part);
    if (verb.rights != Rights::kObserve) line.append(verb.rights == Rights::kOperate ? "operate)" : "service)");
    if (reply.json())
      reply.text(verb.name, line.view());
    else
      reply.document({}, line.view());
    for (std::size_t i = 0; only != nullptr && i < verb.choices.size(); ++i) {
      FixedText<80> choice(verb.name);
      choice.append(" ");
      choice.append(verb.choices[i]);
      reply.document(choice.view(), choice.view());
    }
  }
  return ok_status();
}

void Console::answer_error(const Request& request, Status status) {
  FixedText<200> detail;
  if (status.detail() != nullptr) {
    detail.append(status.detail());
  } else {
    const Verb* verb = find_verb(request.verb.view());
    detail.append("needs the right to ");
    detail.append(to_string(verb == nullptr ? Rights::kService : verb->rights));
    detail.append("; ");
    detail.append(config_.how_to_raise);
  }
  char text[640];
  TextWriter out(text);
  if (json_) {
    write_id(request, out);
    out.text("\"cmd\":")
        .quoted(request.verb.view())
        .text(",\"ok\":false,\"error\":{\"code\":")
        .quoted(to_string(status.code()));
    out.text(",\"detail\":").quoted(detail.view()).text("}}\n");
  } else {
    out.text(request.verb.view()).text(request.verb.empty() ? "" : ": ").text(detail.view()).text("\n");
  }
  send(out.view());
}

void Console::begin_event(std::string_view name, TextWriter& out) const {
  if (json_)
    out.text("{\"ev\":").quoted(name).text(",\"data\":{");
  else
    out.text("\r\x1b[K* ").text(name).text("\n");
}

void Console::end_event(TextWriter& out) {
  if (json_)
    out.text("}}\n");
  else
    editor_.draw(out);  // what was being typed comes back below
  if (out.overflowed()) {
    ++counters_.long_answers;
    return;
  }
  send(out.view());
}

// One word: put it in. Several: put in what they share, or list them if that is nothing.
void Console::offer_completions() {
  struct Found {
    std::string_view shared;
    std::size_t count = 0;
    FixedText<480> list;
  } found;
  const VisitWord visit = [](void* context, std::string_view word) {
    Found& all = *static_cast<Found*>(context);
    std::size_t same = 0;
    while (same < std::min(all.shared.size(), word.size()) && all.shared[same] == word[same]) ++same;
    all.shared = all.count == 0 ? word : all.shared.substr(0, same);
    ++all.count;
    all.list.append(word);
    all.list.append("  ");
  };
  const std::size_t typed = complete(editor_.before_cursor(), visit, &found);
  if (found.count == 0) return;
  char text[kEchoBytes + 512];
  TextWriter echo(text);
  if (found.shared.size() > typed || found.count == 1) {
    editor_.insert(found.shared.substr(typed), echo);
    if (found.count == 1) editor_.insert(" ", echo);
  } else {
    echo.text("\n").text(found.list.view()).text("\n");
    editor_.draw(echo);
  }
  send(echo.view());
}

}  // namespace roomcal::console
