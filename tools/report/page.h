#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace roomcal::tools {

/// Which page's own script goes on top of the shared ones (3-D scene, tables).
enum class PageKind { kMap };

/// One self-contained HTML page: shared style and scripts, the kind's own script, and the data. Nothing in it is loaded
/// from anywhere; any text in the data is shown as text.
std::string make_page(PageKind kind, const std::string& title, const nlohmann::ordered_json& data);

}  // namespace roomcal::tools
