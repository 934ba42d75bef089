#pragma once

#include <cstdint>

#include "runtime/ports/button.h"

namespace roomcal::face {

/// What a person meant.
enum class Gesture : uint8_t {
  kNone,
  kAbort,      ///< pressed while something runs
  kVerify,     ///< short press
  kCalibrate,  ///< held for 3 s, then released
  kOffer,      ///< held for 10 s: a restore of the factory record is offered
  kRestore,    ///< short press while it is offered
};
/// "verify", ... Never null.
const char* to_string(Gesture gesture);

/// How long the button is held by now; what the lamp shows while it is.
enum class Hold : uint8_t { kUp, kShort, kNothing, kCalibrate, kOffer };

/// Times of the grammar, as printed on the label.
struct ButtonTimes {
  int64_t short_ns = 1'000'000'000;      ///< a press that ends before is a short one
  int64_t calibrate_ns = 3'000'000'000;  ///< released from here on: calibrate
  int64_t offer_ns = 10'000'000'000;     ///< held until here: the offer
  int64_t offer_lasts_ns = 10'000'000'000;
  int64_t stuck_ns = 60'000'000'000;  ///< held for longer: not a person
};

/// Edges and time to gestures. Nothing starts while the button is down: releasing is the confirmation, so that 3 s and
/// 10 s cannot be taken for each other.
///
/// | while     | edge or time                  | gesture                     | then      |
/// |-----------|-------------------------------|-----------------------------|-----------|
/// | running   | down                          | abort                       | ignored until up |
/// | idle      | up before 1 s                 | verify                      | idle      |
/// | idle      | up between 1 s and 3 s        | none: changed his mind      | idle      |
/// | idle      | up between 3 s and 10 s       | calibrate                   | idle      |
/// | idle      | down for 10 s                 | offer                       | offered, once it is up |
/// | offered   | up before 1 s                 | restore                     | idle      |
/// | offered   | any longer press, 10 s passed | none: the offer lapses      | idle      |
/// | any       | down for 60 s                 | none: stuck                 | ignored until up |
class ButtonGrammar {
 public:
  explicit ButtonGrammar(const ButtonTimes& times = {}) : times_(times) {}

  /// @param running  whether a press runs. Edges in the order of their stamps.
  Gesture on_edge(const ports::ButtonEdge& edge, bool running);
  /// Between edges; call it some times a second.
  Gesture tick(int64_t now_ns);

  Hold hold(int64_t now_ns) const;
  bool offered() const { return offered_; }
  bool stuck() const { return stuck_; }
  /// Held for at least a second, or three: somebody is at the device (console rights).
  bool held_for(int64_t at_least_ns, int64_t now_ns) const { return down_ && now_ns - since_ns_ >= at_least_ns; }

 private:
  Gesture on_release(int64_t held_ns);

  ButtonTimes times_;
  bool down_ = false;
  bool ignored_ = false;  ///< this press has had its effect
  bool stuck_ = false;
  bool offered_ = false;
  int64_t since_ns_ = 0;
  int64_t offered_ns_ = 0;
};

}  // namespace roomcal::face
