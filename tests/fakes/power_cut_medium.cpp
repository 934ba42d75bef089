#include "tests/fakes/power_cut_medium.h"

#include <algorithm>

namespace roomcal::fakes {

namespace {

constexpr Status kNoPower{StatusCode::kUnavailable, "the medium has no power"};
constexpr Status kScripted{StatusCode::kUnavailable, "scripted failure"};

}  // namespace

PowerCutMedium::PowerCutMedium(std::size_t size, std::size_t page)
    : page_(page), durable_(size, std::byte{0xFF}), cached_(durable_) {}

void PowerCutMedium::copy(std::span<const std::byte> from, Image& to, std::size_t offset) {
  std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(offset));
}

void PowerCutMedium::set_script(const MediumScript& script) {
  script_ = script;
  reads_ = writes_ = syncs_ = 0;
  trace_.clear();
}

void PowerCutMedium::power_on() {
  cut_ = false;
  pending_.clear();
  cached_ = durable_;
  set_script({});
}

void PowerCutMedium::set_durable(const Image& image) {
  durable_ = image;
  power_on();
}

std::byte& PowerCutMedium::durable_byte(std::size_t at) { return durable_.at(at); }

Status PowerCutMedium::read(std::size_t offset, std::span<std::byte> out) {
  if (offset > size_bytes() || out.size() > size_bytes() - offset)
    return {StatusCode::kOutOfRange, "read beyond the end"};
  if (dead()) return kNoPower;
  if (hits(reads_++, script_.fail_read)) return kScripted;
  std::copy_n(cached_.begin() + static_cast<std::ptrdiff_t>(offset), out.size(), out.begin());
  return ok_status();
}

Status PowerCutMedium::write_page(std::size_t offset, std::span<const std::byte> page) {
  if (offset % page_ != 0 || page.size() != page_ || offset > size_bytes() - page_)
    return {StatusCode::kOutOfRange, "not a page of the medium"};
  if (dead()) return kNoPower;
  const std::size_t number = writes_++;
  const bool cut = trace_.size() == script_.cut_op;
  trace_.push_back({MediumOp::Kind::kWrite, offset, Image(page.begin(), page.end())});
  if (cut || hits(number, script_.fail_write)) {
    copy(page.first(cut ? script_.cut_byte : page_ / 2), durable_, offset);
    cut_ = cut;
    cached_ = durable_;
    for (const MediumOp& op : pending_) copy(op.page, cached_, op.offset);
    return cut ? kNoPower : kScripted;
  }
  copy(page, cached_, offset);
  if (hits(number, script_.lose_write)) return ok_status();
  pending_.push_back(trace_.back());
  if (hits(number, script_.flip_write)) pending_.back().page[page_ / 3] ^= std::byte{0x10};
  return ok_status();
}

Status PowerCutMedium::sync() {
  if (dead()) return kNoPower;
  const bool cut = trace_.size() == script_.cut_op;
  trace_.push_back({MediumOp::Kind::kSync, 0, {}});
  if (cut) {
    cut_ = true;
    return kNoPower;
  }
  if (hits(syncs_++, script_.fail_sync)) {
    pending_.clear();
    return kScripted;
  }
  for (const MediumOp& op : pending_) copy(op.page, durable_, op.offset);
  pending_.clear();
  return ok_status();
}

Status PowerCutMedium::drop_caches() {
  if (dead()) return kNoPower;
  cached_ = durable_;
  for (const MediumOp& op : pending_) copy(op.page, cached_, op.offset);
  return ok_status();
}

}  // namespace roomcal::fakes
