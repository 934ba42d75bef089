#pragma once

#include <cstdint>

#include <flatbuffers/flatbuffers.h>

#include "runtime/base/fixed_text.h"
#include "runtime/camera/intrinsics.h"
#include "runtime/math/se3.h"

/// Between the structs of our FlatBuffers schemas and our own types. Every schema has its own Transform and Intrinsics,
/// of the same fields; these templates take any of them.
namespace roomcal::camera {

/// @return false if the text is longer than its place; nullptr is the empty text.
template <std::size_t kCapacity>
bool take_text(const flatbuffers::String* text, FixedText<kCapacity>& out) {
  out.clear();
  if (text == nullptr) return true;
  if (text->size() > kCapacity) return false;
  out.append({text->c_str(), text->size()});
  return true;
}

template <typename FlatTransform>
SE3 to_se3(const FlatTransform& stored) {
  SE3 T;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) T.R(r, c) = stored.rotation()->Get(static_cast<flatbuffers::uoffset_t>(3 * r + c));
    T.t[r] = stored.t_m()->Get(static_cast<flatbuffers::uoffset_t>(r));
  }
  return T;
}

template <typename FlatTransform>
FlatTransform to_flat_transform(const SE3& T) {
  std::array<double, 9> R{};
  std::array<double, 3> t{};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) R[static_cast<std::size_t>(3 * r + c)] = T.R(r, c);
    t[static_cast<std::size_t>(r)] = T.t[r];
  }
  return {R, t};
}

/// Sizes beyond any image become 0, which every check refuses.
inline int to_size_px(uint32_t stored) { return stored <= 1U << 20 ? static_cast<int>(stored) : 0; }

template <typename FlatIntrinsics>
Intrinsics to_intrinsics(const FlatIntrinsics& stored) {
  Intrinsics k{static_cast<Model>(stored.model()),
               to_size_px(stored.width_px()),
               to_size_px(stored.height_px()),
               stored.fx_px(),
               stored.fy_px(),
               stored.cx_px(),
               stored.cy_px(),
               {}};
  for (std::size_t i = 0; i < k.distortion.size(); ++i)
    k.distortion[i] = stored.distortion()->Get(static_cast<flatbuffers::uoffset_t>(i));
  return k;
}

template <typename FlatIntrinsics>
FlatIntrinsics to_flat_intrinsics(const Intrinsics& k) {
  return {k.fx_px,
          k.fy_px,
          k.cx_px,
          k.cy_px,
          k.distortion,
          static_cast<uint32_t>(k.width_px),
          static_cast<uint32_t>(k.height_px),
          static_cast<uint8_t>(k.model)};
}

}  // namespace roomcal::camera
