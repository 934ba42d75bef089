#include <cstring>
#include <vector>

#include "runtime/export/export.h"
#include "runtime/store/record_codec.h"
#include "tests/fuzz/sealed.h"

namespace {

using namespace roomcal;

struct alignas(16) Block {
  std::byte bytes[store::kMaxRecordBytes];
};

// What decodes must encode again, decode to the same bytes, and be exportable.
void use(const store::Record& record) {
  static Block out, again, scratch;
  static std::vector<char> text(32768);
  const Result<std::size_t> size = store::encode_record(record, out.bytes, scratch.bytes);
  if (!size.ok()) __builtin_trap();
  static store::Record back;
  if (!store::decode_record({out.bytes, size.value()}, back).ok()) __builtin_trap();
  const Result<std::size_t> size_again = store::encode_record(back, again.bytes, scratch.bytes);
  if (!size_again.ok() || size_again.value() != size.value()) __builtin_trap();
  if (std::memcmp(out.bytes, again.bytes, size.value()) != 0) __builtin_trap();
  for (int format = 0; format <= static_cast<int>(exports::Format::kOpenCv); ++format) {
    TextWriter writer(text);
    const Status status =
        exports::write(record, static_cast<exports::Format>(format), record.sensors[0].name.view(), writer);
    if (!status.ok() && status.code() != StatusCode::kNotFound) __builtin_trap();
  }
}

void walk(std::span<const std::byte> bytes) {
  static store::Record record;
  if (store::decode_record(bytes, record).ok()) use(record);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  fuzz::walk_sealed<store::RecordHeader>(data, size, store::kMagic, store::kFormatVersion, walk);
  return 0;
}
