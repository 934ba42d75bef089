#include "tools/page/page.h"

#include <utility>

#include "tools/page/assets.h"

namespace roomcal::tools {

namespace {

void replace_all(std::string& text, std::string_view what, std::string_view with) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size())) {
    text.replace(at, what.size(), with);
  }
}

std::string escaped(std::string text) {
  for (const auto& [what, with] : {std::pair{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}})
    replace_all(text, what, with);
  return text;
}

/// JSON that cannot end its script element, whatever a name in it says.
std::string embedded(const nlohmann::ordered_json& data) {
  std::string text = data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  replace_all(text, "<", "\\u003c");
  return text;
}

}  // namespace

std::string make_page(const std::string& title, std::string_view style, std::initializer_list<std::string_view> scripts,
                      const nlohmann::ordered_json& data) {
  std::string script;
  for (const std::string_view part : {page_assets::camera_js, page_assets::labels_js, page_assets::scene_hands_js,
                                      page_assets::scene_js, page_assets::parts_js})
    script.append(part);
  for (const std::string_view part : scripts) script.append(part);
  replace_all(script, "\"use strict\";\n", "");
  // Cut, not searched and replaced: what is filled in may itself hold a word in braces.
  const std::pair<std::string_view, std::string> fills[] = {
      {"{{title}}", escaped(title)},
      {"{{style}}", std::string(page_assets::style_css).append(style)},
      {"{{theme}}", std::string(page_assets::theme_js)},
      {"{{data}}", embedded(data)},
      {"{{script}}", "\"use strict\";\n" + script}};
  std::string page;
  std::string_view rest = page_assets::page_html;
  for (const auto& [name, fill] : fills) {
    const std::size_t at = rest.find(name);
    page.append(rest.substr(0, at)).append(fill);
    rest.remove_prefix(at + name.size());
  }
  return page.append(rest);
}

}  // namespace roomcal::tools
