#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "runtime/base/text_writer.h"
#include "runtime/console/line_history.h"

namespace roomcal::console {

inline constexpr std::size_t kMaxJsonLine = 1024;

enum class LineEvent : uint8_t {
  kNone,
  kLine,      ///< a whole line of printable characters; line() holds it until the next byte
  kNoise,     ///< a whole line with bytes in it that nobody types: it was dropped
  kTooLong,   ///< a whole line beyond its capacity: it was dropped
  kComplete,  ///< tab: the words before the cursor want completion
};

/// Bytes of a terminal to lines: VT100 keys, emacs keys, history. Bounded work a byte, no allocation.
///
/// | bytes | do |
/// |---|---|
/// | printable | insert at the cursor |
/// | CR, LF, CR LF | end the line |
/// | BS, DEL; ^D, ESC [3~ | erase before; at the cursor |
/// | ^A ^E, Home End; ^B ^F, arrows | move |
/// | ^U ^K ^W | erase to the beginning; to the end; the word before |
/// | ^P ^N, arrows up and down | history |
/// | ^C; ^L | drop the line; draw it again |
/// | NUL, 0xFF (a break, a floating line) | ignored while the line is empty |
/// | any other byte | the line is noise: it is dropped at its end, whatever it says |
///
/// A line whose first character is `{` is a machine's: no echo, no editing, up to kMaxJsonLine characters.
class LineEditor {
 public:
  /// @param[out] echo  what the terminal is to show.
  LineEvent feed(char byte, TextWriter& echo);

  std::string_view line() const { return {line_.data(), size_}; }
  std::string_view before_cursor() const { return {line_.data(), cursor_}; }
  bool is_json() const { return json_; }
  /// Something was typed and not ended.
  bool pending() const { return !ended_ && (size_ > 0 || tainted_ || too_long_ || key_ != Key::kPlain); }

  /// Inserts at the cursor as if typed; what does not fit is left out.
  void insert(std::string_view text, TextWriter& echo);
  void drop();
  /// Draws prompt, line and cursor on the terminal's present line; of a line that was ended, or a machine's, the
  /// prompt.
  void draw(TextWriter& echo) const;
  void set_prompt(std::string_view prompt) { prompt_ = prompt; }

 private:
  enum class Key : uint8_t { kPlain, kEscape, kCsi, kSs3 };

  LineEvent feed_json(unsigned char byte);
  LineEvent feed_plain(unsigned char byte, TextWriter& echo);
  LineEvent end(TextWriter& echo);
  void feed_escape(unsigned char byte, TextWriter& echo);
  void edit(unsigned char byte, TextWriter& echo);
  void erase(std::size_t from, std::size_t to, TextWriter& echo);
  void erase_word(TextWriter& echo);
  void move(std::size_t cursor, TextWriter& echo);
  void recall(bool older, TextWriter& echo);
  void replace(std::string_view text, TextWriter& echo);

  std::array<char, kMaxJsonLine> line_{};
  std::size_t size_ = 0;
  std::size_t cursor_ = 0;
  Key key_ = Key::kPlain;
  unsigned csi_number_ = 0;
  bool json_ = false;
  bool tainted_ = false;
  bool too_long_ = false;
  bool ended_ = false;
  bool after_cr_ = false;
  LineHistory history_;
  std::size_t recalled_ = 0;  ///< 0: the line being typed; n: n lines back
  std::string_view prompt_;
};

}  // namespace roomcal::console
