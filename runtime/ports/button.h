#pragma once

#include <cstdint>

namespace roomcal::ports {

/// The button went down or up.
struct ButtonEdge {
  bool down = false;
  int64_t stamp_ns = 0;  ///< monotonic, when it happened
};

/// One button. Debounced below (gpio-keys, the line's debounce period).
class Button {
 public:
  virtual ~Button() = default;
  /// The next edge that is waiting; does not wait itself.
  /// A button that is held at the start gives no edge until it was released. Where edges were lost, the present state
  /// comes as one.
  /// @return false if there is none.
  virtual bool next(ButtonEdge& edge) = 0;
};

}  // namespace roomcal::ports
