#include "runtime/lidar/model.h"

#include <array>

namespace roomcal::lidar {

namespace {

// Ranges: what the manuals promise; rs_driver's limits for the Helios. Velodyne: all that 16 bits hold. Ouster: an OS2
// reaches 450 m.
constexpr std::array kModels = {
    ModelInfo{Model::kVlp16, Family::kVelodyne, "vlp16", "Velodyne VLP-16", 16, 2368, AngleSource::kBuiltIn, 0, 132,
              0x22},
    ModelInfo{Model::kVlp32c, Family::kVelodyne, "vlp32c", "Velodyne VLP-32C", 32, 2368, AngleSource::kBuiltIn, 0, 263,
              0x28},
    ModelInfo{Model::kHdl32e, Family::kVelodyne, "hdl32e", "Velodyne HDL-32E", 32, 2368, AngleSource::kBuiltIn, 0, 132,
              0x21},
    ModelInfo{Model::kXt16, Family::kHesai, "xt16", "Hesai PandarXT-16", 16, 2368, AngleSource::kUnitRequired, 0.05,
              120, 0},
    ModelInfo{Model::kXt32, Family::kHesai, "xt32", "Hesai PandarXT-32", 32, 2368, AngleSource::kUnitRequired, 0.05,
              120, 0},
    ModelInfo{Model::kXt32m, Family::kHesai, "xt32m", "Hesai XT32M", 32, 2368, AngleSource::kUnitRequired, 0.5, 300, 0},
    ModelInfo{Model::kQt64, Family::kHesai, "qt64", "Hesai PandarQT", 64, 2368, AngleSource::kUnitRequired, 0.1, 60, 0},
    ModelInfo{Model::kQt128, Family::kHesai, "qt128", "Hesai QT128", 128, 2368, AngleSource::kUnitRequired, 0.05, 50,
              0},
    ModelInfo{Model::kPandar40p, Family::kHesai, "pandar40p", "Hesai Pandar40P", 40, 2368, AngleSource::kUnitRequired,
              0.3, 200, 0},
    ModelInfo{Model::kPandar64, Family::kHesai, "pandar64", "Hesai Pandar64", 64, 2368, AngleSource::kUnitRequired, 0.3,
              200, 0},
    ModelInfo{Model::kOuster, Family::kOuster, "ouster", "Ouster OS0/OS1/OS2", 0, 7502, AngleSource::kUnitRequired, 0,
              500, 0},
    ModelInfo{Model::kHelios16p, Family::kRobosense, "helios16p", "RoboSense Helios-16P", 16, 6699,
              AngleSource::kBuiltIn, 0.1, 180, 0},
    ModelInfo{Model::kMid360, Family::kLivox, "mid360", "Livox Mid-360", 4, 56301, AngleSource::kInPackets, 0, 100, 0},
    ModelInfo{Model::kR2000, Family::kPepperlFuchs, "r2000", "Pepperl+Fuchs R2000", 1, 0, AngleSource::kInPackets, 0,
              500, 0},
};

/// What else people write for the same thing.
struct Alias {
  const char* name;
  Model model;
};
constexpr std::array kAliases = {
    Alias{"puck", Model::kVlp16},       Alias{"vlp32", Model::kVlp32c},       Alias{"hdl32", Model::kHdl32e},
    Alias{"pandarxt16", Model::kXt16},  Alias{"pandarxt32", Model::kXt32},    Alias{"pandarxt32m", Model::kXt32m},
    Alias{"pandarqt64", Model::kQt64},  Alias{"pandarqt", Model::kQt64},      Alias{"pandarqt128", Model::kQt128},
    Alias{"40p", Model::kPandar40p},    Alias{"pandar40", Model::kPandar40p}, Alias{"64", Model::kPandar64},
    Alias{"os0", Model::kOuster},       Alias{"os1", Model::kOuster},         Alias{"os2", Model::kOuster},
    Alias{"helios", Model::kHelios16p}, Alias{"livoxmid360", Model::kMid360}, Alias{"tls", Model::kR2000},
};

constexpr char plain(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Equal but for case and the characters that people put between letters and digits.
bool same_name(std::string_view a, const char* b) {
  std::size_t j = 0;
  const std::string_view other(b);
  for (const char c : a) {
    if (c == '-' || c == '_' || c == ' ') continue;
    if (j == other.size() || plain(c) != other[j]) return false;
    ++j;
  }
  return j == other.size();
}

}  // namespace

std::span<const ModelInfo> known_models() { return kModels; }

const ModelInfo& info(Model model) { return kModels[static_cast<std::size_t>(model)]; }

const ModelInfo* find_model(std::string_view name) {
  for (const ModelInfo& known : kModels)
    if (same_name(name, known.name)) return &known;
  for (const Alias& alias : kAliases)
    if (same_name(name, alias.name)) return &info(alias.model);
  return nullptr;
}

}  // namespace roomcal::lidar
