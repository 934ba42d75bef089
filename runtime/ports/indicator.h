#pragma once

namespace roomcal::ports {

/// One lamp. Its grammar is the runtime's (runtime/face/light.h): it is toggled by the loop that is supervised, never
/// by a timer of the kernel, which would blink on when everything else has died.
class Indicator {
 public:
  virtual ~Indicator() = default;
  virtual void set(bool lit) = 0;
};

}  // namespace roomcal::ports
