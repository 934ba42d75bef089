#include "tools/sheets/sheet_pdf.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "runtime/base/arena.h"
#include "runtime/marker/detector.h"
#include "tests/tools/folder_test.h"
#include "tests/tools/refusal.h"
#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/common/image_io.h"

namespace roomcal::tools {
namespace {

namespace fs = std::filesystem;

constexpr int kDpi = 100;
constexpr double kPxPerMm = kDpi / 25.4;

/// The PDF as another program (poppler) draws it; by Cairo, whose edges cover pixels by their area. pdftoppm fattens
/// them.
class SheetPdf : public test::FolderTest {
 protected:
  std::vector<cv::Mat> render(const SheetPage& page, int first, int count) const {
    write_sheets(page, first, count, folder_ / "s.pdf");
    const std::string command = "pdftocairo -gray -png -r " + std::to_string(kDpi) + " '" +
                                (folder_ / "s.pdf").string() + "' '" + (folder_ / "page").string() + "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << "pdftocairo is needed: tools/setup --tests";
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      if (entry.path().extension() == ".png") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    std::vector<cv::Mat> images;
    for (const fs::path& file : files) images.push_back(read_grey(file));
    return images;
  }
};

/// As a camera sees the page: no lens is sharper than 0.8 px.
std::vector<marker::Detection> detect_rings(const cv::Mat& page) {
  cv::Mat image;
  cv::GaussianBlur(page, image, {}, 0.8);
  AlignedBytes memory(marker::detector_scratch_bytes(image.cols, image.rows));
  Arena scratch(memory.span());
  std::vector<marker::Detection> found(20);
  std::size_t count = 0;
  require(marker::detect(view(image), {}, scratch, found, count), "detector");
  found.resize(count);
  return found;
}

/// Ink as a share of a pixel.
double ink_at(const cv::Mat& image, int x, int y) { return 1 - image.at<uint8_t>(y, x) / 255.0; }

/// Distance of a pixel's centre from the marker's, mm. Pixel (0, 0) covers [0, 1) of the page.
double radius_at_mm(const SheetPage& page, int x, int y) {
  return (Vec2(x + 0.5, y + 0.5) / kPxPerMm - page.centre_mm).norm();
}

/// The outer radius that the printed area within `limit_mm` says.
double radius_from_ink_mm(const cv::Mat& image, const SheetPage& page, double limit_mm) {
  double ink_px = 0;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) ink_px += radius_at_mm(page, x, y) < limit_mm ? ink_at(image, x, y) : 0;
  }
  double share = 0, sign = 1;
  for (const double ratio : page.ring_radii) {
    share += sign * ratio * ratio;
    sign = -sign;
  }
  return std::sqrt(ink_px / share / kPi) / kPxPerMm;
}

TEST_F(SheetPdf, EveryPaperAndRatios_RingsAreFoundWithTheirExactSizeAndPlace) {
  for (const char* name : {"a4", "a3", "letter"}) {
    for (const std::size_t id : {std::size_t{0}, std::size_t{12}, kBestRingsId}) {
      const SheetPage page = layout_sheet(paper_named(name), 0, cctag3_radii(id));
      const std::vector<cv::Mat> images = render(page, 7, 1);
      ASSERT_EQ(images.size(), 1U);
      EXPECT_NEAR(images[0].cols / kPxPerMm, page.paper.size_mm.x(), 0.3);
      const std::vector<marker::Detection> found = detect_rings(images[0]);
      ASSERT_EQ(found.size(), 1U) << name << " id " << id;
      EXPECT_EQ(found[0].status, marker::DetectionStatus::kOk) << name << " id " << id;
      EXPECT_EQ(found[0].rings, 3);
      EXPECT_NEAR(found[0].ellipse.major_px / 2 / kPxPerMm, page.radius_mm, 0.1) << name << " id " << id;
      EXPECT_NEAR(found[0].ellipse.minor_px / 2 / kPxPerMm, page.radius_mm, 0.1) << name << " id " << id;
      const Vec2 centre_mm = (found[0].centre_px + Vec2(0.5, 0.5)) / kPxPerMm;
      EXPECT_LT((centre_mm - page.centre_mm).norm(), 0.05) << name << " id " << id;
      EXPECT_NEAR(radius_from_ink_mm(images[0], page, page.radius_mm + 1), page.radius_mm, 0.05)
          << name << " id " << id;
    }
  }
}

TEST_F(SheetPdf, QuietZone_HoldsNoInkAndTheNumberIsOutside) {
  const SheetPage page = layout_sheet(paper_named("a4"), 0, kBestRings);
  const std::vector<cv::Mat> images = render(page, 998, 3);
  ASSERT_EQ(images.size(), 3U);
  for (const cv::Mat& image : images) {
    double quiet_ink = 0, strip_ink = 0, number_ink = 0;
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        const double r_mm = radius_at_mm(page, x, y), y_mm = (y + 0.5) / kPxPerMm;
        if (r_mm > page.radius_mm + 0.5 && r_mm < page.radius_mm * (1 + kQuietRadii)) quiet_ink += ink_at(image, x, y);
        if (y_mm > page.note_mm.y()) strip_ink += ink_at(image, x, y);
        if (y_mm < page.cut_mm - 2 && r_mm > page.radius_mm * (1 + kQuietRadii)) number_ink += ink_at(image, x, y);
      }
    }
    EXPECT_EQ(quiet_ink, 0);
    EXPECT_GT(strip_ink, 100);  // there is text, so there is a font
    EXPECT_GT(number_ink, 5);
  }
  cv::Mat difference;  // the pages differ in their numbers only: the markers are all alike
  cv::absdiff(images[0], images[2], difference);
  int different = 0;
  for (int y = 0; y < difference.rows; ++y) {
    for (int x = 0; x < difference.cols; ++x) {
      if (difference.at<uint8_t>(y, x) == 0) continue;
      ++different;
      EXPECT_GT(radius_at_mm(page, x, y), page.radius_mm * (1 + kQuietRadii));
    }
  }
  EXPECT_GT(different, 5);
}

TEST_F(SheetPdf, SizeBar_IsAHundredMillimetres) {
  const SheetPage page = layout_sheet(paper_named("a4"), 0, kBestRings);
  const cv::Mat image = render(page, 0, 1).at(0);
  const int row = static_cast<int>((page.bar_mm.y() + 1) * kPxPerMm);
  double ink_px = 0;
  for (int x = 0; x < image.cols; ++x) ink_px += ink_at(image, x, row);
  EXPECT_NEAR(ink_px / kPxPerMm, kBar_mm, 0.1);
}

TEST_F(SheetPdf, SameSheetsTwice_GiveTheSameBytes) {
  const SheetPage page = layout_sheet(paper_named("a3"), 0, kBestRings);
  write_sheets(page, 1, 2, folder_ / "a.pdf");
  write_sheets(page, 1, 2, folder_ / "b.pdf");
  EXPECT_EQ(read_text(folder_ / "a.pdf"), read_text(folder_ / "b.pdf"));
}

TEST_F(SheetPdf, OutputNotWritable_IsNamed) {
  const SheetPage page = layout_sheet(paper_named("a4"), 0, kBestRings);
  const std::string message = test::refusal([&] { write_sheets(page, 0, 1, "/proc/nowhere/s.pdf"); });
  EXPECT_TRUE(test::contains(message, "/proc/nowhere/s.pdf: cannot be opened for writing")) << message;
}

}  // namespace
}  // namespace roomcal::tools
