#include "tests/runtime/map/small_map.h"

#include <algorithm>
#include <cstring>

#include "runtime/base/crc32c.h"

namespace roomcal::map::test {

void reseal(tools::AlignedBytes& bytes) {
  if (bytes.span().size() < sizeof(FileHeader)) return;
  FileHeader header{};
  std::memcpy(&header, bytes.span().data(), sizeof header);
  const auto payload = bytes.span().subspan(sizeof header);
  header.payload_bytes = static_cast<uint32_t>(payload.size());
  header.payload_crc32c = crc32c(payload);
  std::memcpy(bytes.span().data(), &header, sizeof header);
  header.header_crc32c = crc32c(bytes.span().first(offsetof(FileHeader, header_crc32c)));
  std::memcpy(bytes.span().data(), &header, sizeof header);
}

tools::AlignedBytes resized(const tools::AlignedBytes& bytes, std::size_t size) {
  tools::AlignedBytes result(size);
  std::copy_n(bytes.span().begin(), std::min(size, bytes.span().size()), result.span().begin());
  return result;
}

}  // namespace roomcal::map::test
