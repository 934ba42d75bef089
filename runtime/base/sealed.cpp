#include "runtime/base/sealed.h"

#include <cstring>

#include "runtime/base/crc32c.h"

namespace roomcal {

namespace {

uint32_t header_sum(const SealedHeader& header) {
  return crc32c(std::as_bytes(std::span(&header, 1)).first(offsetof(SealedHeader, header_crc32c)));
}

Result<SealedHeader> read_header(std::span<const std::byte> bytes, const SealedKind& kind) {
  SealedHeader header{};
  if (bytes.size() < sizeof header) return Status(StatusCode::kCorrupt, kind.too_short);
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.magic != kind.magic) return Status(StatusCode::kCorrupt, kind.absent);
  if (header_sum(header) != header.header_crc32c) return Status(StatusCode::kCorrupt, kind.header_damaged);
  if (header.version != kind.version) return Status(StatusCode::kUnsupported, kind.other_version);
  if (header.payload_bytes > kind.max_bytes - sizeof header) return Status(StatusCode::kCorrupt, kind.header_damaged);
  return header;
}

}  // namespace

SealedHeader seal(std::span<const std::byte> payload, const SealedKind& kind) {
  SealedHeader header{kind.magic, kind.version, static_cast<uint32_t>(payload.size()), crc32c(payload), 0};
  header.header_crc32c = header_sum(header);
  return header;
}

Result<std::size_t> sealed_size(std::span<const std::byte> bytes, const SealedKind& kind) {
  const Result<SealedHeader> header = read_header(bytes, kind);
  ROOMCAL_TRY(header.status());
  return sizeof(SealedHeader) + header.value().payload_bytes;
}

Result<std::span<const std::byte>> open_sealed(std::span<const std::byte> bytes, const SealedKind& kind) {
  if (reinterpret_cast<uintptr_t>(bytes.data()) % 8 != 0)
    return Status(StatusCode::kInvalidArgument, "the stored bytes are not aligned to 8");
  const Result<SealedHeader> header = read_header(bytes, kind);
  ROOMCAL_TRY(header.status());
  const std::size_t size = header.value().payload_bytes;
  if (bytes.size() - sizeof(SealedHeader) < size) return Status(StatusCode::kCorrupt, kind.cut_short);
  const std::span<const std::byte> payload = bytes.subspan(sizeof(SealedHeader), size);
  if (crc32c(payload) != header.value().payload_crc32c) return Status(StatusCode::kCorrupt, kind.damaged);
  return payload;
}

}  // namespace roomcal
