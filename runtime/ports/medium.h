#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/status.h"

namespace roomcal::ports {

/// Storage that keeps its bytes without power: a file, a raw partition, an EEPROM. Written page by page; every page can
/// be rewritten in place (flash that wants erasing first goes behind a block layer).
///
/// What the store relies on, and the power-cut tests vary everything else: after sync() returned ok, the pages written
/// before are on the medium; until then any of them, in any order, whole or in part, may be lost.
class Medium {
 public:
  virtual ~Medium() = default;

  virtual std::size_t size_bytes() const = 0;
  /// Smallest unit of a write; a power of two from 1 to 65536. size_bytes() is a multiple of it.
  virtual std::size_t page_bytes() const = 0;

  /// Fills `out` with the bytes at `offset`.
  /// @return kOutOfRange beyond the end; kUnavailable for an input error (`out` is then undefined).
  virtual Status read(std::size_t offset, std::span<std::byte> out) = 0;

  /// Writes one whole page. `offset` is a multiple of page_bytes(), `page` exactly that long.
  /// @return kOutOfRange for another place or size; kUnavailable for an output error, full or read-only media: the page
  ///         then holds anything.
  virtual Status write_page(std::size_t offset, std::span<const std::byte> page) = 0;

  /// Returns ok only when all that was written is on the medium.
  /// @return kUnavailable if that is not known; the medium then fails every later sync until it is opened anew, because
  ///         an operating system may forget a write error after telling it once.
  virtual Status sync() = 0;

  /// Makes the next read come from the medium instead of a cache, as far as there is one.
  virtual Status drop_caches() = 0;
};

}  // namespace roomcal::ports
