#include "runtime/export/export.h"

#include <algorithm>
#include <array>

#include "runtime/export/formats.h"

namespace roomcal::exports {

namespace {

constexpr std::array<const char*, 7> kNames{"json", "kalibr", "urdf", "tf", "camera_info", "autoware", "opencv"};

}  // namespace

const char* to_string(Format format) {
  const auto number = static_cast<std::size_t>(format);
  return number < kNames.size() ? kNames[number] : "unknown";
}

Result<Format> parse_format(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (name == kNames[i]) return static_cast<Format>(i);
  return Status(StatusCode::kNotFound, "formats are json, kalibr, urdf, tf, camera_info, autoware, opencv");
}

Status write(const store::Record& record, Format format, std::string_view camera, TextWriter& out) {
  const bool has_camera = std::any_of(record.sensors.begin(), record.sensors.end(),
                                      [](const auto& sensor) { return sensor.kind == store::SensorKind::kCamera; });
  if (!has_camera && (format == Format::kKalibr || format == Format::kOpenCv))
    return {StatusCode::kNotFound, "the record has no camera, which is all that this format holds"};
  switch (format) {
    case Format::kJson:
      write_json(record, out);
      break;
    case Format::kKalibr:
      write_kalibr(record, out);
      break;
    case Format::kUrdf:
      write_urdf(record, out);
      break;
    case Format::kRosTf:
      write_ros_tf(record, out);
      break;
    case Format::kRosInfo: {
      const store::SensorRecord* sensor = record.find(camera);
      if (sensor == nullptr || sensor->kind != store::SensorKind::kCamera)
        return {StatusCode::kNotFound, "the record has no camera of this name; name one"};
      write_ros_info(record, *sensor, out);
      break;
    }
    case Format::kAutoware:
      write_autoware(record, out);
      break;
    case Format::kOpenCv:
      write_opencv(record, out);
      break;
  }
  return out.overflowed() ? Status(StatusCode::kCapacity, "the export is larger than its buffer") : ok_status();
}

}  // namespace roomcal::exports
