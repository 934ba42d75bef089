#include "drivers/replay/pgm.h"

namespace roomcal::drivers {

namespace {

constexpr int kMaxSide_px = 65535;

class HeadReader {
 public:
  explicit HeadReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  char next() { return at_ < bytes_.size() ? static_cast<char>(bytes_[at_++]) : '\0'; }
  std::size_t at() const { return at_; }

  /// A number and the one character behind it; -1 if there is none up to kMaxSide_px.
  int number() {
    char c = next();
    while (is_space(c) || c == '#') {
      if (c == '#') skip_line();
      c = next();
    }
    int value = c >= '0' && c <= '9' ? 0 : -1;
    for (; c >= '0' && c <= '9' && value <= kMaxSide_px; c = next()) value = 10 * value + (c - '0');
    return is_space(c) && value <= kMaxSide_px ? value : -1;
  }

 private:
  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  void skip_line() {
    for (char c = next(); c != '\n' && c != '\0';) c = next();
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

}  // namespace

Result<PgmHead> read_pgm_head(std::span<const std::byte> bytes) {
  HeadReader reader(bytes.first(bytes.size() < kMaxPgmHead ? bytes.size() : kMaxPgmHead));
  if (reader.next() != 'P' || reader.next() != '5')
    return Status{StatusCode::kUnsupported, "is no binary PGM; convert it to 8-bit grey (P5)"};
  PgmHead head;
  head.width_px = reader.number();
  head.height_px = reader.number();
  const int white = reader.number();
  head.pixels_at = reader.at();
  if (head.width_px <= 0 || head.height_px <= 0 || white <= 0)
    return Status{StatusCode::kCorrupt, "its PGM head makes no sense"};
  if (white != 255) return Status{StatusCode::kUnsupported, "is a PGM of other than 8 bits; convert it to 8-bit grey"};
  return head;
}

}  // namespace roomcal::drivers
