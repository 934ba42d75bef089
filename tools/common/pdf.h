#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <cairo.h>

#include "runtime/math/types.h"

namespace roomcal::tools {

/// A vector PDF in the making, in millimetres from the top left corner, y down. Nothing is written before save(), and
/// the same drawing gives the same bytes.
class Pdf {
 public:
  /// @param page_mm  width and height of the first page.
  Pdf(const Vec2& page_mm, const std::string& title);
  ~Pdf();
  Pdf(const Pdf&) = delete;
  Pdf& operator=(const Pdf&) = delete;

  /// For drawing; lines are black and 0.25 mm wide on a new page.
  cairo_t* context() const { return context_; }
  /// Ends the page and begins another.
  void next_page(const Vec2& page_mm);
  enum class Align { kLeft, kMiddle, kRight };
  /// @param at_mm  on the base line. @param height_mm  of the type.
  void text(const std::string& words, const Vec2& at_mm, double height_mm, Align align = Align::kLeft);
  void line(const Vec2& from_mm, const Vec2& to_mm);
  /// Grey of everything that follows: 0 black, 1 white.
  void grey(double level);

  /// Ends the last page and writes the file in one step. @throws ToolError naming the path and the reason.
  void save(const std::filesystem::path& path);

 private:
  void start_page();

  std::string bytes_;
  cairo_surface_t* surface_;
  cairo_t* context_;
};

}  // namespace roomcal::tools
