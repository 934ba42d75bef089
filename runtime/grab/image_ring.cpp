#include "runtime/grab/image_ring.h"

namespace roomcal::grab {

std::size_t ImageRing::bytes(int width_px, int height_px, std::size_t slots) {
  return slots * (static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) + alignof(std::max_align_t));
}

Status ImageRing::create(int width_px, int height_px, std::size_t slots, Arena& arena) {
  if (width_px < 1 || height_px < 1 || slots < 2 || slots > kMaxSlots)
    return {StatusCode::kInvalidArgument, "an image ring has two to four slots of a size"};
  const std::size_t pixels = static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
  const std::span<uint8_t> bytes = arena.allocate<uint8_t>(slots * pixels);
  if (bytes.empty()) return out_of_arena("images of a camera");
  for (std::size_t i = 0; i < slots; ++i)
    slots_[i].pixels = MutableImageView(bytes.data() + i * pixels, width_px, height_px);
  slot_count_ = slots;
  return ok_status();
}

bool ImageRing::take(Slot& slot, State from, State to) {
  return slot.state.compare_exchange_strong(from, to, std::memory_order_acq_rel);
}

MutableImageView ImageRing::begin_write() {
  // Twice: the reader may take the oldest one just as we do.
  for (int round = 0; round < 2; ++round) {
    std::size_t oldest = kMaxSlots;
    for (std::size_t i = 0; i < slot_count_; ++i) {
      const State state = slots_[i].state.load(std::memory_order_relaxed);
      if (state == State::kHeld) continue;
      if (oldest == kMaxSlots || slots_[i].number < slots_[oldest].number) oldest = i;
    }
    if (oldest == kMaxSlots) break;
    Slot& slot = slots_[oldest];
    if (take(slot, State::kEmpty, State::kWriting) || take(slot, State::kReady, State::kWriting)) {
      writing_ = oldest;
      return slot.pixels;
    }
  }
  return {};
}

void ImageRing::publish(const ports::ImageFacts& facts, const ImageTime& time) {
  if (writing_ == kMaxSlots) return;
  Slot& slot = slots_[writing_];
  slot.facts = facts;
  slot.uncertainty_ns = time.uncertainty_ns;
  slot.exposed_ns.store(time.exposed_ns, std::memory_order_relaxed);
  slot.number.store(next_number_++, std::memory_order_relaxed);
  slot.state.store(State::kReady, std::memory_order_release);
  writing_ = kMaxSlots;
}

void ImageRing::abandon() {
  if (writing_ == kMaxSlots) return;
  slots_[writing_].number.store(0, std::memory_order_relaxed);  // what it held is gone: the first to be overwritten
  slots_[writing_].state.store(State::kEmpty, std::memory_order_release);
  writing_ = kMaxSlots;
}

std::size_t ImageRing::newest_ready(int64_t exposed_ns) const {
  std::size_t newest = kMaxSlots;
  for (std::size_t i = 0; i < slot_count_; ++i) {
    const Slot& slot = slots_[i];
    if (slot.state.load(std::memory_order_acquire) != State::kReady) continue;
    if (slot.exposed_ns.load(std::memory_order_relaxed) < exposed_ns) continue;
    if (newest == kMaxSlots || slot.number > slots_[newest].number) newest = i;
  }
  return newest;
}

FixedVector<HeldImage, kMaxSlots> ImageRing::hold_since(int64_t exposed_ns) {
  FixedVector<HeldImage, kMaxSlots> held;
  // The writer may be quicker with a slot that was just chosen; it then has a newer image soon.
  for (std::size_t tries = 0; tries < 2 * kMaxSlots && held_ + 1 < slot_count_; ++tries) {
    const std::size_t i = newest_ready(exposed_ns);
    if (i == kMaxSlots) break;
    Slot& slot = slots_[i];
    if (!take(slot, State::kReady, State::kHeld)) continue;
    const int64_t exposed = slot.exposed_ns.load(std::memory_order_relaxed);
    if (exposed < exposed_ns) {  // overwritten by another image between the look and the grip
      slot.state.store(State::kReady, std::memory_order_release);
      continue;
    }
    static_cast<void>(held.push_back({i, slot.pixels, slot.facts, {exposed, slot.uncertainty_ns}}));
    ++held_;
  }
  return held;
}

void ImageRing::release(const HeldImage& image) {
  if (image.slot >= slot_count_ || slots_[image.slot].state.load(std::memory_order_relaxed) != State::kHeld) return;
  slots_[image.slot].state.store(State::kReady, std::memory_order_release);
  --held_;
}

}  // namespace roomcal::grab
