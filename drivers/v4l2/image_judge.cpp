#include "drivers/v4l2/image_judge.h"

#include <utility>

namespace roomcal::drivers {

using ports::ImageFacts;
using ports::ImageFault;

namespace {

constexpr int64_t kUnknownPeriodNs = 100'000'000;  // of a camera that does not tell: slower ones are not for us
constexpr int64_t kStartJitterNs = 1'000'000;      // of stamps that a driver works out from the bus's clock

}  // namespace

void ImageJudge::begin(std::size_t luma_bytes, const Timing& timing, int64_t now_ns) {
  stamps_.restart();
  numbers_.restart();
  luma_bytes_ = luma_bytes;
  timing_ = timing;
  if (timing_.period_ns <= 0) timing_.period_ns = kUnknownPeriodNs;
  empty_ns_ = now_ns;
  late_ = false;
}

Judgement ImageJudge::judge(const FilledBuffer& image, int64_t now_ns) {
  Judgement judgement;
  const bool late = now_ns - empty_ns_ > StampLimits::kOldNs;  // nobody asked: what is here may be as old
  const SequenceCount::Step number = numbers_.next(image.sequence);
  // What was not asked for is not lost, up to the first image that is.
  const bool unasked = std::exchange(late_, late) || late;
  lost_ = unasked ? 0 : lost_ + number.lost_before;
  gap_ = gap_ || unasked || number.first_after_gap;

  if (image.damaged || image.bytes.size() < luma_bytes_) {
    judgement.fault = image.damaged ? ImageFault::kMarkedDamaged : ImageFault::kShort;
    return judgement;
  }
  const ImageFault doubt = stamps_.judge(image.stamp, {now_ns, ClockId::kMonotonic});
  const bool believed = doubt == ImageFault::kCount;
  judgement.backlog = late && (doubt == ImageFault::kStampOld || !believed);
  if (!judgement.backlog) judgement.fault = doubt;
  const bool the_same_again = doubt == ImageFault::kStampFrozen && number.repeated;
  judgement.keep = !judgement.backlog && doubt != ImageFault::kStampOld && !the_same_again;

  ImageFacts& facts = judgement.facts;
  facts.sequence = number.sequence;
  facts.lost_before = lost_;
  facts.first_after_gap = gap_;
  facts.arrived_ns = now_ns;
  date(image, believed, facts);
  return judgement;
}

// Between the start of an exposure and the last byte lie the exposure and the readout. Neither takes longer than the
// time between images, so the start lies within an interval: its middle is told, and how far its ends are.
void ImageJudge::date(const FilledBuffer& image, bool believed, ImageFacts& facts) const {
  if (believed && image.at_start_of_exposure) {
    facts.exposed = image.stamp;
    facts.uncertainty_ns = kStartJitterNs;
    return;
  }
  const bool exposure_known = timing_.exposure_ns > 0;
  const int64_t longest_ns = timing_.period_ns + (exposure_known ? timing_.exposure_ns : timing_.period_ns);
  const int64_t shortest_ns = exposure_known ? timing_.exposure_ns : 0;
  const int64_t complete_after_ns = believed ? image.stamp.ns : empty_ns_;
  const int64_t complete_before_ns = believed ? image.stamp.ns : facts.arrived_ns;
  const int64_t first_ns = complete_after_ns - longest_ns, last_ns = complete_before_ns - shortest_ns;
  facts.exposed = {first_ns + (last_ns - first_ns) / 2, ClockId::kMonotonic};
  facts.uncertainty_ns = (last_ns - first_ns + 1) / 2;
}

}  // namespace roomcal::drivers
