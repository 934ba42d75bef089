#include "tools/export/record_file.h"

#include <memory>

#include "runtime/store/record_codec.h"
#include "tools/common/error.h"
#include "tools/common/files.h"

namespace roomcal::tools {

namespace {

struct alignas(16) Block {
  std::byte bytes[store::kMaxRecordBytes];
};

}  // namespace

store::Record read_record(const std::filesystem::path& path) {
  const AlignedBytes bytes = read_bytes(path);
  store::Record record;
  require(store::decode_record(bytes.span(), record), path.string());
  return record;
}

void write_record(const std::filesystem::path& path, const store::Record& record) {
  const auto out = std::make_unique<Block>(), scratch = std::make_unique<Block>();
  const Result<std::size_t> size = store::encode_record(record, out->bytes, scratch->bytes);
  require(size.status(), path.string());
  write_atomic(path, std::span<const std::byte>(out->bytes, size.value()));
}

}  // namespace roomcal::tools
