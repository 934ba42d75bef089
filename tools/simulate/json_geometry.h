#pragma once

#include <nlohmann/json.hpp>

#include "runtime/math/se3.h"

namespace roomcal::tools {

template <int N>
nlohmann::json json_of(const Eigen::Matrix<double, N, 1>& v) {
  nlohmann::json array = nlohmann::json::array();
  for (int i = 0; i < N; ++i) array.push_back(v[i]);
  return array;
}

/// {T: 4 rows of 4, q_wxyz, t_m}
nlohmann::json json_of(const SE3& T);

/// @throws nlohmann::json::exception if it is not an array of N numbers.
template <int N>
Eigen::Matrix<double, N, 1> vector_of(const nlohmann::json& array) {
  Eigen::Matrix<double, N, 1> v;
  for (int i = 0; i < N; ++i) v[i] = array.at(static_cast<std::size_t>(i)).get<double>();
  return v;
}

}  // namespace roomcal::tools
