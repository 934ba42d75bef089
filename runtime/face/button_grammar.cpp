#include "runtime/face/button_grammar.h"

namespace roomcal::face {

const char* to_string(Gesture gesture) {
  switch (gesture) {
    case Gesture::kNone:
      return "none";
    case Gesture::kAbort:
      return "abort";
    case Gesture::kVerify:
      return "verify";
    case Gesture::kCalibrate:
      return "calibrate";
    case Gesture::kOffer:
      return "offer to restore the factory record";
    case Gesture::kRestore:
      return "restore the factory record";
  }
  return "unknown";
}

Gesture ButtonGrammar::on_edge(const ports::ButtonEdge& edge, bool running) {
  if (edge.down == down_) return Gesture::kNone;
  down_ = edge.down;
  if (down_) {
    since_ns_ = edge.stamp_ns;
    ignored_ = running;
    return running ? Gesture::kAbort : Gesture::kNone;
  }
  stuck_ = false;
  return ignored_ ? Gesture::kNone : on_release(edge.stamp_ns - since_ns_);
}

Gesture ButtonGrammar::on_release(int64_t held_ns) {
  const bool was_offered = offered_;
  offered_ = false;
  if (held_ns < times_.short_ns) return was_offered ? Gesture::kRestore : Gesture::kVerify;
  if (was_offered || held_ns < times_.calibrate_ns) return Gesture::kNone;
  if (held_ns < times_.offer_ns) return Gesture::kCalibrate;
  offered_ = true;  // the edge came before a tick could tell
  offered_ns_ = since_ns_ + held_ns;
  return Gesture::kOffer;
}

Gesture ButtonGrammar::tick(int64_t now_ns) {
  if (offered_ && !down_ && now_ns - offered_ns_ > times_.offer_lasts_ns) offered_ = false;
  if (!down_) return Gesture::kNone;
  if (now_ns - since_ns_ >= times_.stuck_ns) {
    stuck_ = ignored_ = true;
    offered_ = false;
    return Gesture::kNone;
  }
  if (ignored_ || now_ns - since_ns_ < times_.offer_ns) return Gesture::kNone;
  ignored_ = true;
  const bool again = offered_;
  offered_ = !again;  // held for long once more: no, thank you
  offered_ns_ = now_ns;
  return again ? Gesture::kNone : Gesture::kOffer;
}

Hold ButtonGrammar::hold(int64_t now_ns) const {
  if (!down_ || stuck_) return Hold::kUp;
  const int64_t held_ns = now_ns - since_ns_;
  if (held_ns >= times_.offer_ns) return Hold::kOffer;
  if (ignored_) return Hold::kUp;
  if (held_ns >= times_.calibrate_ns) return Hold::kCalibrate;
  return held_ns >= times_.short_ns ? Hold::kNothing : Hold::kShort;
}

}  // namespace roomcal::face
