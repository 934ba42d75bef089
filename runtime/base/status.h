#pragma once

#include <cassert>
#include <cstdint>
#include <utility>

namespace roomcal {

/// Why a call did not deliver. One small set for the whole runtime; the detail text names the thing and the remedy.
enum class StatusCode : uint8_t {
  kOk,
  kInvalidArgument,  ///< the caller handed in something that can never work (sizes, NaN)
  kOutOfRange,       ///< outside the valid field of a model or a table
  kNotFound,         ///< looked for it, it is not there
  kTooFew,           ///< not enough observations to answer
  kDegenerate,       ///< the geometry does not determine an answer
  kAmbiguous,        ///< more than one answer fits equally well
  kNotConverged,     ///< an iteration stopped before it met its bound
  kCapacity,         ///< a fixed container or table is full
  kOutOfMemory,      ///< an arena refused
  kCorrupt,          ///< stored bytes fail their checks
  kUnsupported,      ///< well formed, but of a version or kind that we do not read
  kUnavailable,      ///< the source has nothing now; trying again may help
  kCancelled,        ///< somebody stopped it; nothing of it counts
};

/// Printable name of a code, for example "out of range". Never null.
const char* to_string(StatusCode code);

/// A code and a static text. Copying is free; nothing is allocated.
class [[nodiscard]] Status {
 public:
  constexpr Status() = default;
  /// @param detail  a string literal (kept by pointer): the thing and the remedy.
  constexpr Status(StatusCode code, const char* detail) : code_(code), detail_(detail) {}

  constexpr bool ok() const { return code_ == StatusCode::kOk; }
  constexpr StatusCode code() const { return code_; }
  constexpr const char* detail() const { return detail_; }

 private:
  StatusCode code_ = StatusCode::kOk;
  const char* detail_ = "";
};

constexpr Status ok_status() { return {}; }

/// A value or the status that explains its absence. `value()` may be called only when `ok()`.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}                      // NOLINT: implicit by design
  Result(Status status) : status_(status) { assert(!status.ok()); }  // NOLINT: implicit by design

  bool ok() const { return status_.ok(); }
  Status status() const { return status_; }
  const T& value() const& {
    assert(ok());
    return value_;
  }
  T& value() & {
    assert(ok());
    return value_;
  }
  T&& value() && {
    assert(ok());
    return std::move(value_);
  }

 private:
  Status status_;
  T value_{};
};

}  // namespace roomcal

/// Returns the status of `expression` from the enclosing function unless it is ok.
#define ROOMCAL_TRY(expression)                                                           \
  do {                                                                                    \
    if (::roomcal::Status try_status = (expression); !try_status.ok()) return try_status; \
  } while (false)
