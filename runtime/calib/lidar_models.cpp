#include "runtime/calib/lidar_models.h"

#include <array>

namespace roomcal::calib {

namespace {

struct Entry {
  std::string_view model;
  scan::SensorModel ranges;  ///< sigma, beam offset sigma, angle sigma, least and greatest range
};

// Data sheets give one accuracy figure (A) and sometimes a precision (P, 1-sigma). Where there is no P, half of A is
// taken as the scatter; beam offsets are a third of A. A model without separate lasers (one beam, rotating or not) has
// no offsets between them.
constexpr std::array<Entry, 18> kModels = {{
    {"vlp16", {0.015, 0.010, 0.0003, 0.4, 100}},      // 63-9243: A 30 mm
    {"vlp32c", {0.015, 0.010, 0.0003, 0.5, 200}},     // 63-9325: A 30 mm
    {"hdl32e", {0.010, 0.007, 0.0003, 0.5, 100}},     // 63-9113: A 20 mm
    {"xt16", {0.005, 0.004, 0.0003, 0.05, 120}},      // Hesai XT16/32 manual: A 10 mm, P 5 mm
    {"xt32", {0.005, 0.004, 0.0003, 0.05, 120}},      // the same
    {"xt32m", {0.005, 0.004, 0.0003, 0.05, 300}},     // Hesai XT32M2X manual: A 10 mm, P 5 mm
    {"qt64", {0.010, 0.010, 0.0003, 0.1, 60}},        // PandarQT manual: A 30 mm, P 20 mm at the worst reflectivity
    {"qt128", {0.010, 0.010, 0.0003, 0.05, 50}},      // QT128C2X manual: A 30 mm
    {"pandar40p", {0.010, 0.007, 0.0003, 0.3, 200}},  // Pandar40P manual: A 20 mm
    {"pandar64", {0.010, 0.007, 0.0003, 0.3, 200}},   // Pandar64 manual: A 20 mm
    {"ouster", {0.010, 0.010, 0.0003, 0.3, 240}},     // OS0, OS1, OS2 data sheets: P 7 to 50 mm, A 30 mm
    {"os0", {0.010, 0.010, 0.0003, 0.3, 100}},        // the same
    {"os1", {0.010, 0.010, 0.0003, 0.3, 200}},        // the same
    {"os2", {0.010, 0.010, 0.0003, 0.8, 240}},        // the same
    {"helios16p", {0.010, 0.007, 0.0003, 0.2, 150}},  // RS-Helios-16P manual: A 20 mm
    {"mid360", {0.020, 0.0, 0.0026, 0.1, 70}},        // Mid-360 data sheet: P 20 mm, angle 0.15 degree
    {"r2000", {0.012, 0.0, 0.0003, 0.1, 60}},         // OMD30M-R2000: repeatability 12 mm, one beam
    {"tls", {0.004, 0.0, 0.0001, 0.3, 100}},          // terrestrial scanners: 1 to 6 mm at room range, one beam
}};

}  // namespace

const scan::SensorModel* ranges_of(std::string_view model) {
  for (const Entry& entry : kModels)
    if (entry.model == model) return &entry.ranges;
  return nullptr;
}

const lidar::ModelInfo* packets_of(std::string_view model) {
  if (model == "tls") return lidar::find_model("r2000");
  if (model == "os0" || model == "os1" || model == "os2") return lidar::find_model("ouster");
  return lidar::find_model(model);
}

}  // namespace roomcal::calib
