#include "tools/simulate/json_geometry.h"

#include <Eigen/Geometry>

namespace roomcal::tools {

nlohmann::json json_of(const SE3& T) {
  nlohmann::json rows = nlohmann::json::array();
  for (int i = 0; i < 4; ++i) rows.push_back(json_of(Vec4(T.matrix().row(i).transpose())));
  const Eigen::Quaterniond q(T.R);
  return {{"T", rows}, {"q_wxyz", {q.w(), q.x(), q.y(), q.z()}}, {"t_m", json_of(T.t)}};
}

}  // namespace roomcal::tools
