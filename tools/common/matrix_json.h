#pragma once

#include <utility>

#include <nlohmann/json.hpp>

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

}  // namespace roomcal::tools
