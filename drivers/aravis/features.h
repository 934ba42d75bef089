#pragma once

#include <string_view>

#include <arv.h>

#include "runtime/base/fixed_text.h"
#include "runtime/base/fixed_vector.h"

namespace roomcal::drivers {

/// A camera's features by name, as text; everything that is changed is remembered and can be undone.
///
/// Undoing goes backwards, so selectors need no care: what was set under a selector is set back under it.
class Features {
 public:
  static constexpr std::size_t kMaxChanges = 64;

  /// @param device  outlives this, or let_go() is called before it dies.
  void attach(ArvDevice* device) { device_ = device; }
  void let_go() { device_ = nullptr; }

  bool has(const char* name) const;
  /// Whether an enumeration has that entry now.
  bool has_entry(const char* name, const char* entry) const;
  /// Empty if there is none or it cannot be read.
  FixedText<63> get(const char* name) const;
  double get_number(const char* name, double otherwise) const;

  /// Does nothing if that is its value already. @return false if there is none or the camera refuses, see error().
  bool set(const char* name, std::string_view value);
  /// Without regard to what it was, and not undone.
  bool set_for_good(const char* name, std::string_view value);
  bool set_number(const char* name, double value);
  /// Clamped to what the camera can. @param[out] value  what was set.
  bool set_clamped(const char* name, double& value);
  bool execute(const char* name);

  /// Undoes all changes, last first; stops at the first that a camera does not answer to. @return how many it undid.
  std::size_t restore();
  std::size_t changes() const { return changes_.size(); }
  /// The last refusal, in Aravis' words.
  std::string_view error() const { return error_.view(); }

 private:
  struct Change {
    FixedText<47> name;
    FixedText<63> value;
  };

  ArvGcFeatureNode* node(const char* name) const;

  ArvDevice* device_ = nullptr;
  FixedVector<Change, kMaxChanges> changes_;
  FixedText<160> error_;
};

}  // namespace roomcal::drivers
