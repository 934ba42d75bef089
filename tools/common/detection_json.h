#pragma once

#include <nlohmann/json.hpp>

#include "runtime/marker/detector.h"

namespace roomcal::tools {

/// A ring marker as every JSON has it: x, y (projected circle centre, px), cov_px2 [xx, xy, yy], major_px and minor_px
/// (full axes of the outer ellipse), angle_rad, ellipse [x, y] (its centre, px), rings, status.
inline nlohmann::json to_json(const marker::Detection& d) {
  return {{"x", d.centre_px.x()},
          {"y", d.centre_px.y()},
          {"cov_px2", {d.cov_px2(0, 0), d.cov_px2(0, 1), d.cov_px2(1, 1)}},
          {"ellipse", {d.ellipse.centre_px.x(), d.ellipse.centre_px.y()}},
          {"major_px", d.ellipse.major_px},
          {"minor_px", d.ellipse.minor_px},
          {"angle_rad", d.ellipse.angle_rad},
          {"rings", d.rings},
          {"status", to_string(d.status)}};
}

}  // namespace roomcal::tools
