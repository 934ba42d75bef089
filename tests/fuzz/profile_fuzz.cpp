// A device's profile. What decodes can work, and is written again to bytes that decode to the same.

#include <algorithm>
#include <memory>

#include "runtime/profile/format.h"
#include "runtime/profile/profile.h"
#include "tests/fuzz/sealed.h"
#include "tools/provision/profile_file.h"

namespace {

using namespace roomcal;

void walk(std::span<const std::byte> bytes) {
  const auto profile = std::make_unique<profile::Profile>();
  Reason what;
  const Status decoded = profile::decode_profile(bytes, *profile, what);
  if (decoded.ok() != what.empty()) __builtin_trap();
  if (!decoded.ok()) return;
  if (!profile::check_profile(*profile, what).ok()) __builtin_trap();
  const auto device = std::make_unique<calib::Device>();
  if (!profile::to_device(*profile, *device).ok()) __builtin_trap();
  const tools::AlignedBytes once = tools::build_profile(*profile);  // throws, and so is found, if it does not come back
  if (!profile::decode_profile(once.span(), *profile, what).ok()) __builtin_trap();
  if (!std::ranges::equal(tools::build_profile(*profile).span(), once.span())) __builtin_trap();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  fuzz::walk_sealed<SealedHeader>(data, size, profile::kProfileKind.magic, profile::kProfileKind.version, walk);
  return 0;
}
