#include "tools/sheets/sheet_page.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/tools/refusal.h"

namespace roomcal::tools {
namespace {

TEST(SheetPage, EveryPaper_HoldsMarkerQuietZoneAndStrip) {
  for (const char* name : {"a4", "A3", "letter"}) {
    const SheetPage page = layout_sheet(paper_named(name), 0, kBestRings);
    const double quiet_mm = page.radius_mm * (1 + kQuietRadii);
    EXPECT_LE(quiet_mm, page.centre_mm.x()) << name;
    EXPECT_LE(page.centre_mm.y() + quiet_mm, page.cut_mm) << name;
    EXPECT_GT(page.bar_mm.y() - 3, page.cut_mm) << name;
    EXPECT_LT(page.note_mm.y() + 13, page.paper.size_mm.y() - 5) << name;
    EXPECT_GT((page.corner_number_mm + Vec2(12, -4) - page.centre_mm).norm(), quiet_mm) << name;
  }
}

TEST(SheetPage, A4_HoldsTheRadiusOfTheRenderedRooms) {
  EXPECT_EQ(layout_sheet(paper_named("a4"), 0, kBestRings).radius_mm, 85);
}

TEST(SheetPage, PaperTooSmall_NamesTheLargestRadius) {
  const std::string message =
      test::refusal([] { static_cast<void>(layout_sheet(paper_named("a4"), 100, kBestRings)); });
  EXPECT_TRUE(test::contains(message, "--radius 100 mm: a4 holds 10 to 85 mm")) << message;
  EXPECT_NO_THROW(static_cast<void>(layout_sheet(paper_named("a3"), 100, kBestRings)));
}

TEST(SheetPage, NonsenseRadiusOrPaper_IsRefused) {
  for (const double radius_mm : {-1.0, 0.5, 9.9, 1e9, std::nan(""), double(INFINITY)}) {
    EXPECT_TRUE(test::contains(
        test::refusal([&] { static_cast<void>(layout_sheet(paper_named("a4"), radius_mm, kBestRings)); }), "--radius"))
        << radius_mm;
  }
  EXPECT_TRUE(test::contains(test::refusal([] { static_cast<void>(paper_named("a5")); }), "a4, a3 or letter"));
}

}  // namespace
}  // namespace roomcal::tools
