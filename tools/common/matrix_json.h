#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "tools/common/error.h"

namespace roomcal::tools {

/// A matrix as a list of its rows.
template <typename Matrix>
nlohmann::json rows_of(const Matrix& m) {
  nlohmann::json out = nlohmann::json::array();
  for (decltype(m.rows()) r = 0; r < m.rows(); ++r) {
    nlohmann::json row = nlohmann::json::array();
    for (decltype(m.cols()) c = 0; c < m.cols(); ++c) row.push_back(m(r, c));
    out.push_back(std::move(row));
  }
  return out;
}

/// The N x N matrix of a list of rows. @throws ToolError or an exception of the JSON library for what is none.
template <int N, typename Json>
Eigen::Matrix<double, N, N> matrix_of(const Json& rows) {
  Eigen::Matrix<double, N, N> m;
  if (!rows.is_array() || rows.size() != N) throw ToolError("a matrix has not " + std::to_string(N) + " rows");
  for (std::size_t r = 0; r < N; ++r)
    for (std::size_t c = 0; c < N; ++c)
      m(static_cast<int>(r), static_cast<int>(c)) = rows.at(r).at(c).template get<double>();
  return m;
}

}  // namespace roomcal::tools
