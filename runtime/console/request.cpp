#include "runtime/console/request.h"

#include <charconv>

namespace roomcal::console {

namespace {

constexpr Status kTooManyWords{StatusCode::kOutOfRange, "more arguments than any verb takes; see help"};
constexpr Status kLongWord{StatusCode::kOutOfRange, "a word of more than 63 characters"};

constexpr Status bad(const char* detail) { return {StatusCode::kInvalidArgument, detail}; }

// Walks one flat JSON object. Every step looks at a bounded number of characters and moves forward only.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  void skip_space() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  bool take(char c) {
    skip_space();
    if (at_ == text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  bool at_end() {
    skip_space();
    return at_ == text_.size();
  }

  Status string(Word& out) {
    if (!take('"')) return bad("a string is missing");
    out.clear();
    std::size_t length = 0;
    while (at_ < text_.size() && text_[at_] != '"') {
      if (text_[at_] == '\t') return bad("a string holds a tab");
      if (text_[at_] == '\\' && !take_escape()) return bad("a string holds an escape other than \\\" \\\\ \\/");
      if (++length > Word().capacity()) return kLongWord;
      out.append(text_.substr(at_++, 1));
    }
    return take('"') ? ok_status() : bad("a string does not end");
  }

  Status integer(int64_t& out) {
    skip_space();
    const char* first = text_.data() + at_;
    const char* last = text_.data() + text_.size();
    const auto [end, error] = std::from_chars(first, last, out);
    const auto digits = static_cast<std::size_t>(end - first);
    const std::size_t sign = digits > 0 && *first == '-' ? 1 : 0;
    const bool leading_zero = digits > sign + 1 && first[sign] == '0';
    if (error != std::errc() || leading_zero) return bad("id is not a whole number of 64 bits");
    at_ += digits;
    return ok_status();
  }

 private:
  bool take_escape() {
    ++at_;
    return at_ < text_.size() && (text_[at_] == '"' || text_[at_] == '\\' || text_[at_] == '/');
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

Status parse_arguments(Reader& reader, Request& request) {
  if (!reader.take('[')) return bad("args is not an array of strings");
  if (reader.take(']')) return ok_status();
  do {
    Word word;
    ROOMCAL_TRY(reader.string(word));
    if (!request.arguments.push_back(word)) return kTooManyWords;
  } while (reader.take(','));
  return reader.take(']') ? ok_status() : bad("args does not end");
}

struct Seen {
  bool command = false, arguments = false, id = false;
};

Status parse_member(Reader& reader, Seen& seen, Request& request) {
  Word key;
  ROOMCAL_TRY(reader.string(key));
  if (!reader.take(':')) return bad("a colon is missing");
  bool* already = key.view() == "cmd"    ? &seen.command
                  : key.view() == "args" ? &seen.arguments
                  : key.view() == "id"   ? &seen.id
                                         : nullptr;
  if (already == nullptr) return bad("keys are cmd, args and id");
  if (*already) return bad("a key comes twice");
  *already = true;
  if (already == &seen.command) return reader.string(request.verb);
  if (already == &seen.arguments) return parse_arguments(reader, request);
  ROOMCAL_TRY(reader.integer(request.id));
  request.has_id = true;
  return ok_status();
}

}  // namespace

Status parse_words(std::string_view line, Request& request) {
  request = {};
  bool first = true;
  for (std::size_t at = line.find_first_not_of(' '); at != std::string_view::npos;
       at = line.find_first_not_of(' ', at)) {
    const std::string_view word = line.substr(at, line.find(' ', at) - at);
    at += word.size();
    if (word.size() > Word().capacity()) return kLongWord;
    if (first)
      request.verb = word;
    else if (!request.arguments.push_back(word))
      return kTooManyWords;
    first = false;
  }
  return ok_status();
}

Status parse_json(std::string_view line, Request& request) {
  request = {};
  request.json = true;
  Reader reader(line);
  Seen seen;
  if (!reader.take('{')) return bad("not an object");
  if (!reader.take('}')) {
    do {
      ROOMCAL_TRY(parse_member(reader, seen, request));
    } while (reader.take(','));
    if (!reader.take('}')) return bad("the object does not end");
  }
  if (!reader.at_end()) return bad("something follows the object");
  return seen.command ? ok_status() : bad("cmd is missing");
}

}  // namespace roomcal::console
