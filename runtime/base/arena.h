#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <type_traits>

#include "runtime/base/status.h"

namespace roomcal {

/// Bump allocator over bytes that the board owns. Nothing is ever freed one by one: a Scope rewinds.
///
/// Refusal is a value: allocate() returns an empty span and moves `refusals`. Not thread-safe: one arena, one thread.
class Arena {
 public:
  Arena() = default;
  explicit Arena(std::span<std::byte> bytes) : bytes_(bytes) {}
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;
  Arena(Arena&&) = default;
  Arena& operator=(Arena&&) = default;

  /// `count` value-initialized objects, aligned for T.
  /// @return empty if count is 0, the arena is sealed, or it has too little room left (refusals() moves then).
  /// Cost: O(count) for the initialization.
  template <typename T>
  [[nodiscard]] std::span<T> allocate(std::size_t count) {
    std::span<T> items = allocate_uninitialized<T>(count);
    for (T& item : items) ::new (static_cast<void*>(&item)) T();
    return items;
  }

  /// Same without touching the memory, for buffers that the caller fills at once.
  template <typename T>
  [[nodiscard]] std::span<T> allocate_uninitialized(std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T>, "an arena runs no destructors");
    if (count > SIZE_MAX / sizeof(T)) {
      ++refusals_;
      return {};
    }
    void* place = allocate_bytes(count * sizeof(T), alignof(T));
    return place == nullptr ? std::span<T>{} : std::span<T>{static_cast<T*>(place), count};
  }

  /// Later requests are refused: what lives until shutdown is complete.
  void seal() { sealed_ = true; }

  std::size_t capacity() const { return bytes_.size(); }
  std::size_t used() const { return used_; }
  std::size_t peak() const { return peak_; }
  std::size_t refusals() const { return refusals_; }
  void reset_peak() { peak_ = used_; }

  /// Gives everything back that was allocated since its construction. Scopes nest like blocks.
  class Scope {
   public:
    explicit Scope(Arena& arena) : arena_(arena), mark_(arena.used_) {}
    ~Scope() { arena_.used_ = mark_; }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    Arena& arena_;
    std::size_t mark_;
  };

 private:
  void* allocate_bytes(std::size_t size, std::size_t alignment);

  std::span<std::byte> bytes_;
  std::size_t used_ = 0;
  std::size_t peak_ = 0;
  std::size_t refusals_ = 0;
  bool sealed_ = false;
};

/// The three lifetimes of the runtime, carved out of one block.
struct Arenas {
  Arena permanent;  ///< until shutdown; sealed on arming
  Arena step;       ///< one shot: detections, poses, the joint problem
  Arena scratch;    ///< one call; every user opens an Arena::Scope

  /// @param block  the board's bytes; permanent and scratch take their sizes from its start and end.
  /// @return kOutOfMemory if the block is smaller than both.
  static Result<Arenas> carve(std::span<std::byte> block, std::size_t permanent_bytes, std::size_t scratch_bytes);

  std::size_t peak() const { return permanent.peak() + step.peak() + scratch.peak(); }
};

inline Status out_of_arena(const char* what) { return {StatusCode::kOutOfMemory, what}; }

}  // namespace roomcal
