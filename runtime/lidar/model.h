#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace roomcal::lidar {

enum class Model : uint8_t {
  kVlp16,
  kVlp32c,
  kHdl32e,
  kXt16,
  kXt32,
  kXt32m,
  kQt64,
  kQt128,
  kPandar40p,
  kPandar64,
  kOuster,  ///< OS0, OS1, OS2 of any beam count and profile: the metadata tells
  kHelios16p,
  kMid360,
  kR2000,  ///< Pepperl+Fuchs OMD, a 2-D profiler
};

enum class Family : uint8_t { kVelodyne, kHesai, kOuster, kRobosense, kLivox, kPepperlFuchs };

/// Where a beam table comes from.
enum class AngleSource : uint8_t {
  kBuiltIn,       ///< of the manual; a unit's file may refine it
  kUnitRequired,  ///< only the unit's own file will do
  kInPackets,     ///< packets carry coordinates or angles
};

/// What the decoders know of a model before a packet arrives.
struct ModelInfo {
  Model model = Model::kVlp16;
  Family family = Family::kVelodyne;
  const char* name = "";     ///< as on the command line and in device.yaml
  const char* product = "";  ///< as on the label
  uint16_t beams = 0;        ///< 0: the metadata tells
  uint16_t data_port = 0;    ///< UDP port of the point packets as delivered
  AngleSource angles = AngleSource::kBuiltIn;
  double min_range_m = 0, max_range_m = 0;  ///< ranges outside are absurd: dropped and counted
  uint8_t product_byte = 0;                 ///< Velodyne: the factory byte; 0: none
};

inline constexpr std::size_t kMaxBeams = 128;

/// Every model, in the order of the enumeration.
std::span<const ModelInfo> known_models();

const ModelInfo& info(Model model);

/// Model of a name such as "vlp16", case ignored, `-` and `_` ignored. @return nullptr if there is none.
const ModelInfo* find_model(std::string_view name);

}  // namespace roomcal::lidar
