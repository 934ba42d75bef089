#pragma once

#include <array>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "runtime/math/types.h"

namespace roomcal::tools {

/// The black square of a tag: equal cells of ink or paper.
struct TagCells {
  int across = 0;
  std::vector<bool> ink;  ///< row by row, as a reader in front of it sees them
};

/// An AprilTag (36h11) in an image.
struct TagDetection {
  int id = 0;
  std::array<Vec2, 4> corners_px{};  ///< of the black square, in the order of kTagCorners
};

/// Whether this program was built with libapriltag (Debian: libapriltag-dev).
bool has_tags();

/// What is printed of a tag: its black square. @param id  below 587. @throws ToolError without libapriltag.
std::shared_ptr<const TagCells> tag_cells(int id);

/// Corners of the square of half a side 1, x right and y up seen from the front.
constexpr std::array<std::array<double, 2>, 4> kTagCorners = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};

/// All whole tags in an image: searched at full resolution, edges refined, one thread. Not for several threads at once.
/// One that the image's border cuts is left out: the library reads it still, and puts the lost corner onto the border.
/// @throws ToolError without libapriltag.
std::vector<TagDetection> find_tags(const cv::Mat& grey);

}  // namespace roomcal::tools
