#include "tools/page/page.h"

#include <gtest/gtest.h>

namespace roomcal::tools {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

bool contains(const std::string& text, const std::string& part) { return count(text, part) > 0; }

TEST(Page, EveryPlaceholder_IsFilled) {
  const std::string page = make_page("a title", ".own { top: 3px }", {"const own = 7;"}, {{"key", 5}});
  EXPECT_TRUE(contains(page, "<title>a title</title>"));
  EXPECT_TRUE(contains(page, R"({"key":5})"));
  EXPECT_TRUE(contains(page, "class Scene"));
  EXPECT_TRUE(contains(page, "const own = 7;"));
  EXPECT_TRUE(contains(page, ".own { top: 3px }"));
  EXPECT_TRUE(contains(page, "prefers-color-scheme: dark"));
  EXPECT_FALSE(contains(page, "{{"));
}

TEST(Page, NothingIsLoadedFromAnywhere) {
  const std::string page = make_page("t", {}, {}, {});
  for (const char* part : {"src=", "@import", "url(", "fetch(", "XMLHttpRequest", "https://"}) {
    EXPECT_FALSE(contains(page, part)) << part;
  }
}

TEST(Page, EvilText_StaysText) {
  const std::string evil = "</script><script>alert(1)</script><!-- {{script}} & \xff";
  const std::string page = make_page(evil, {}, {}, {{"name", evil}});
  EXPECT_EQ(count(page, "</script>"), 3U);  // the page's own
  EXPECT_FALSE(contains(page, "<script>alert"));
  EXPECT_FALSE(contains(page, "<!--"));
}

}  // namespace
}  // namespace roomcal::tools
