#pragma once

#include <memory>

#include <glib-object.h>

namespace roomcal::drivers {

struct GObjectUnref {
  void operator()(void* object) const { g_object_unref(object); }
};
/// The one owner of a reference to an object of GLib's.
template <typename T>
using GObjectPtr = std::unique_ptr<T, GObjectUnref>;

struct GFree {
  void operator()(void* memory) const { g_free(memory); }
};
template <typename T>
using GMemory = std::unique_ptr<T, GFree>;

/// Where a call of GLib's style says what went wrong: pass out(), then ask failed().
class GErrorSlot {
 public:
  GErrorSlot() = default;
  ~GErrorSlot() { g_clear_error(&error_); }
  GErrorSlot(const GErrorSlot&) = delete;
  GErrorSlot& operator=(const GErrorSlot&) = delete;

  GError** out() {
    g_clear_error(&error_);
    return &error_;
  }
  bool failed() const { return error_ != nullptr; }
  const char* message() const { return failed() ? error_->message : ""; }
  int code() const { return failed() ? error_->code : 0; }

 private:
  GError* error_ = nullptr;
};

}  // namespace roomcal::drivers
