#include "tools/evaluate/tag_detector.h"

#include <algorithm>
#include <cstdlib>

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

namespace roomcal::tools {

namespace {

struct FamilyDeleter {
  void operator()(apriltag_family_t* family) const { tag36h11_destroy(family); }
};
using Family = std::unique_ptr<apriltag_family_t, FamilyDeleter>;

struct DetectorDeleter {
  void operator()(apriltag_detector_t* detector) const { apriltag_detector_destroy(detector); }
};

/// Made once: its table of codes takes longer than an image.
struct Finder {
  Finder() {
    apriltag_detector_add_family(detector.get(), family.get());
    detector->quad_decimate = 1;
  }
  Family family{tag36h11_create()};
  std::unique_ptr<apriltag_detector_t, DetectorDeleter> detector{apriltag_detector_create()};
};

bool is_whole(const TagDetection& tag, const cv::Mat& image) {
  constexpr double kBorder_px = 2;
  const cv::Rect2d inside(kBorder_px, kBorder_px, image.cols - 1 - 2 * kBorder_px, image.rows - 1 - 2 * kBorder_px);
  return std::all_of(tag.corners_px.begin(), tag.corners_px.end(),
                     [&](const Vec2& px) { return inside.contains(cv::Point2d(px.x(), px.y())); });
}

}  // namespace

bool has_tags() { return true; }

std::shared_ptr<const TagCells> tag_cells(int id) {
  const Family family(tag36h11_create());
  image_u8_t* image = apriltag_to_image(family.get(), static_cast<uint32_t>(id));
  const int margin = (family->total_width - family->width_at_border) / 2;
  auto cells = std::make_shared<TagCells>();
  cells->across = family->width_at_border;
  for (int row = 0; row < cells->across; ++row)
    for (int column = 0; column < cells->across; ++column)
      cells->ink.push_back(image->buf[(row + margin) * image->stride + column + margin] == 0);
  std::free(image->buf);  // as image_u8_destroy() does, which is in a library that pkg-config does not name
  std::free(image);
  return cells;
}

std::vector<TagDetection> find_tags(const cv::Mat& grey) {
  static const Finder finder;
  image_u8_t image{grey.cols, grey.rows, static_cast<int32_t>(grey.step), grey.data};
  zarray_t* found = apriltag_detector_detect(finder.detector.get(), &image);
  std::vector<TagDetection> tags;
  for (int i = 0; i < zarray_size(found); ++i) {
    apriltag_detection_t* tag = nullptr;
    zarray_get(found, i, &tag);
    TagDetection out;
    out.id = tag->id;
    // Its pixel (0, 0) begins at (0, 0); ours has its centre there.
    for (std::size_t k = 0; k < out.corners_px.size(); ++k)
      out.corners_px[k] = Vec2(tag->p[k][0], tag->p[k][1]) - Vec2::Constant(0.5);
    if (is_whole(out, grey)) tags.push_back(out);
  }
  apriltag_detections_destroy(found);
  return tags;
}

}  // namespace roomcal::tools
