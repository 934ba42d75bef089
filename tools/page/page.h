#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace roomcal::tools {

/// One self-contained HTML page: shared style and scripts (theme, 3-D scene, tables), the page's own scripts on top of
/// them, and the data. Nothing in it is loaded from anywhere; any text in the data is shown as text.
/// @param style  of this kind of page, after the shared one; may be empty.
/// @param scripts  of this kind of page, in order; they find the data in the element `data`.
std::string make_page(const std::string& title, std::string_view style, std::initializer_list<std::string_view> scripts,
                      const nlohmann::ordered_json& data);

}  // namespace roomcal::tools
