#include "runtime/lidar/ip_fragments.h"

#include <algorithm>

namespace roomcal::lidar {

namespace {

bool same_datagram(const IpFragment& a, const IpFragment& b) {
  return a.source == b.source && a.destination == b.destination && a.identification == b.identification;
}

}  // namespace

void IpFragments::forget_datagram_of(const IpFragment& piece) {
  const IpFragment of = piece;  // may be one of those that go
  auto* const end =
      std::remove_if(pieces_.begin(), pieces_.end(), [&](const IpFragment& other) { return same_datagram(other, of); });
  pieces_.truncate(static_cast<std::size_t>(end - pieces_.begin()));
}

// As RFC 791 has it, a datagram's time runs from its first piece; the first of all pieces is the oldest.
void IpFragments::forget_old(uint64_t frame) {
  while (!pieces_.empty()) {
    const bool old = frame - pieces_[0].frame > kMaxWaitFrames;
    if (!old && !pieces_.full()) return;
    forget_datagram_of(pieces_[0]);
    ++unfinished_;
  }
}

IpFragments::Answer IpFragments::add(const IpFragment& piece, Bytes& whole) {
  if (piece.body.empty() || piece.at > kMaxBody || piece.body.size() > kMaxBody - piece.at) return Answer::kMalformed;
  forget_old(piece.frame);
  const auto again = [&](const IpFragment& other) { return same_datagram(other, piece) && other.at == piece.at; };
  if (std::any_of(pieces_.begin(), pieces_.end(), again)) return Answer::kWaits;
  static_cast<void>(pieces_.push_back(piece));  // forget_old() left room
  std::size_t total = 0, present = 0;
  for (const IpFragment& other : pieces_) {
    if (!same_datagram(other, piece)) continue;
    present += other.body.size();
    if (!other.more) total = other.at + other.body.size();
  }
  if (total == 0 || present < total) return Answer::kWaits;
  const Answer answer = present == total ? join(piece, total, whole) : Answer::kMalformed;
  forget_datagram_of(piece);
  return answer;
}

/// As many bytes are there as there should be: they make the whole, unless they overlap.
IpFragments::Answer IpFragments::join(const IpFragment& latest, std::size_t total, Bytes& whole) {
  std::size_t reached = 0;
  while (reached < total) {
    const auto follows = [&](const IpFragment& other) { return same_datagram(other, latest) && other.at == reached; };
    const auto* next = std::find_if(pieces_.begin(), pieces_.end(), follows);
    if (next == pieces_.end()) return Answer::kMalformed;
    std::copy(next->body.begin(), next->body.end(), whole_.begin() + static_cast<std::ptrdiff_t>(reached));
    reached += next->body.size();
  }
  whole = {whole_.data(), total};
  return Answer::kWhole;
}

void IpFragments::finish() {
  while (!pieces_.empty()) {
    forget_datagram_of(pieces_[0]);
    ++unfinished_;
  }
}

}  // namespace roomcal::lidar
