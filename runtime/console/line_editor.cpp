#include "runtime/console/line_editor.h"

#include <algorithm>

namespace roomcal::console {

namespace {

constexpr unsigned char control(char letter) { return static_cast<unsigned char>(letter - 'A' + 1); }
constexpr unsigned char kEsc = 0x1B;
constexpr unsigned char kDel = 0x7F;
constexpr unsigned kMaxCsiNumber = 1000;

bool is_printable(unsigned char byte) { return byte >= ' ' && byte <= '~'; }

}  // namespace

void LineEditor::drop() {
  size_ = cursor_ = 0;
  recalled_ = 0;
  key_ = Key::kPlain;
  json_ = tainted_ = too_long_ = ended_ = false;
}

void LineEditor::draw(TextWriter& echo) const {
  const bool shown = !ended_ && !json_;  // a line that was ended stands above already
  echo.text("\r").text(prompt_).text(shown ? line() : std::string_view()).text("\x1b[K");
  if (shown && cursor_ < size_) echo.text("\x1b[").unsigned_integer(size_ - cursor_).text("D");
}

LineEvent LineEditor::feed(char raw, TextWriter& echo) {
  const auto byte = static_cast<unsigned char>(raw);
  const bool second_of_crlf = after_cr_ && byte == '\n';
  after_cr_ = byte == '\r';
  if (second_of_crlf) return LineEvent::kNone;
  if (ended_) drop();
  if (json_) return feed_json(byte);
  if (key_ != Key::kPlain) {
    feed_escape(byte, echo);
    return LineEvent::kNone;
  }
  return feed_plain(byte, echo);
}

LineEvent LineEditor::end(TextWriter& echo) {
  if (!json_) echo.text("\n");
  ended_ = true;
  if (tainted_) return LineEvent::kNoise;
  if (too_long_) return LineEvent::kTooLong;
  if (!json_) history_.add(line());
  return LineEvent::kLine;
}

LineEvent LineEditor::feed_json(unsigned char byte) {
  TextWriter silent({});
  if (byte == '\r' || byte == '\n') return end(silent);
  if (!is_printable(byte) && byte != '\t')
    tainted_ = true;
  else if (size_ == line_.size())
    too_long_ = true;
  else
    line_[size_++] = static_cast<char>(byte);
  return LineEvent::kNone;
}

LineEvent LineEditor::feed_plain(unsigned char byte, TextWriter& echo) {
  if (byte == '\r' || byte == '\n') return end(echo);
  if (byte == control('I')) return LineEvent::kComplete;
  if (byte == kEsc) {
    key_ = Key::kEscape;
  } else if (byte == '{' && size_ == 0) {
    json_ = true;
    line_[size_++] = '{';
  } else if (is_printable(byte)) {
    const char c = static_cast<char>(byte);
    insert({&c, 1}, echo);
  } else {
    edit(byte, echo);
  }
  return LineEvent::kNone;
}

void LineEditor::insert(std::string_view text, TextWriter& echo) {
  if (size_ + text.size() > kMaxLine) {
    too_long_ = true;
    return;
  }
  const auto at = line_.begin() + static_cast<std::ptrdiff_t>(cursor_);
  std::copy_backward(at, line_.begin() + static_cast<std::ptrdiff_t>(size_),
                     line_.begin() + static_cast<std::ptrdiff_t>(size_ + text.size()));
  std::copy(text.begin(), text.end(), at);
  const bool at_end = cursor_ == size_;
  size_ += text.size();
  cursor_ += text.size();
  if (at_end)
    echo.text(text);
  else
    draw(echo);
}

void LineEditor::erase(std::size_t from, std::size_t to, TextWriter& echo) {
  if (from >= to) return;
  std::copy(line_.begin() + static_cast<std::ptrdiff_t>(to), line_.begin() + static_cast<std::ptrdiff_t>(size_),
            line_.begin() + static_cast<std::ptrdiff_t>(from));
  size_ -= to - from;
  cursor_ = from;
  too_long_ = false;  // whoever erases has seen that characters were refused
  draw(echo);
}

void LineEditor::erase_word(TextWriter& echo) {
  std::size_t from = cursor_;
  while (from > 0 && line_[from - 1] == ' ') --from;
  while (from > 0 && line_[from - 1] != ' ') --from;
  erase(from, cursor_, echo);
}

void LineEditor::move(std::size_t cursor, TextWriter& echo) {
  cursor_ = std::min(cursor, size_);
  draw(echo);
}

void LineEditor::replace(std::string_view text, TextWriter& echo) {
  std::copy(text.begin(), text.end(), line_.begin());
  size_ = cursor_ = text.size();
  draw(echo);
}

void LineEditor::recall(bool older, TextWriter& echo) {
  if (older ? recalled_ == history_.count() : recalled_ == 0) return;
  recalled_ += older ? 1 : std::size_t{0} - 1;
  replace(recalled_ == 0 ? std::string_view{} : history_.at(recalled_ - 1), echo);
}

void LineEditor::edit(unsigned char byte, TextWriter& echo) {
  switch (byte) {
    case control('H'):
    case kDel:
      return erase(cursor_ - std::min<std::size_t>(cursor_, 1), cursor_, echo);
    case control('D'):
      return erase(cursor_, std::min(cursor_ + 1, size_), echo);
    case control('A'):
      return move(0, echo);
    case control('E'):
      return move(size_, echo);
    case control('B'):
      return move(cursor_ - std::min<std::size_t>(cursor_, 1), echo);
    case control('F'):
      return move(cursor_ + 1, echo);
    case control('K'):
      return erase(cursor_, size_, echo);
    case control('U'):
      return erase(0, cursor_, echo);
    case control('W'):
      return erase_word(echo);
    case control('P'):
      return recall(true, echo);
    case control('N'):
      return recall(false, echo);
    case control('L'):
      return draw(echo);
    case control('C'):
      drop();
      echo.text("^C\n");
      return draw(echo);
    case 0:
    case 0xFF:
      tainted_ = tainted_ || size_ > 0;
      return;
    default:
      tainted_ = true;
  }
}

// ESC [ letter, ESC [ number ~, ESC O letter. Unknown keys do nothing; what is no key at all is noise.
void LineEditor::feed_escape(unsigned char byte, TextWriter& echo) {
  if (key_ == Key::kEscape) {
    key_ = byte == '[' ? Key::kCsi : byte == 'O' ? Key::kSs3 : Key::kPlain;
    csi_number_ = 0;
    tainted_ = tainted_ || key_ == Key::kPlain;
    return;
  }
  if (key_ == Key::kCsi && byte >= '0' && byte <= '9' && csi_number_ < kMaxCsiNumber) {
    csi_number_ = 10 * csi_number_ + (byte - '0');
    return;
  }
  if (key_ == Key::kCsi && byte == ';') return;
  key_ = Key::kPlain;
  if (byte == 'A' || byte == 'B') return recall(byte == 'A', echo);
  if (byte == 'C') return edit(control('F'), echo);
  if (byte == 'D') return edit(control('B'), echo);
  if (byte == 'H' || (byte == '~' && (csi_number_ == 1 || csi_number_ == 7))) return edit(control('A'), echo);
  if (byte == 'F' || (byte == '~' && (csi_number_ == 4 || csi_number_ == 8))) return edit(control('E'), echo);
  if (byte == '~' && csi_number_ == 3) return edit(control('D'), echo);
  tainted_ = tainted_ || byte < '@' || byte > '~';
}

}  // namespace roomcal::console
