#include "tools/common/pdf.h"

#include <cairo-pdf.h>

#include "tools/common/error.h"
#include "tools/common/files.h"

namespace roomcal::tools {

namespace {

constexpr double kPointsPerMm = 72 / 25.4;

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

Pdf::Pdf(const Vec2& page_mm, const std::string& title)
    : surface_(
          cairo_pdf_surface_create_for_stream(append, &bytes_, page_mm.x() * kPointsPerMm, page_mm.y() * kPointsPerMm)),
      context_(cairo_create(surface_)) {
  cairo_pdf_surface_set_metadata(surface_, CAIRO_PDF_METADATA_TITLE, title.c_str());
  cairo_pdf_surface_set_metadata(surface_, CAIRO_PDF_METADATA_CREATE_DATE, "");  // the bytes then repeat
  start_page();
}

Pdf::~Pdf() {
  cairo_destroy(context_);
  cairo_surface_destroy(surface_);
}

void Pdf::start_page() {
  cairo_identity_matrix(context_);
  cairo_scale(context_, kPointsPerMm, kPointsPerMm);
  cairo_set_tolerance(context_, 1e-3);  // circles are splines; the default strays by 0.035 mm
  cairo_set_line_width(context_, 0.25);
  grey(0);
}

void Pdf::next_page(const Vec2& page_mm) {
  cairo_show_page(context_);
  cairo_pdf_surface_set_size(surface_, page_mm.x() * kPointsPerMm, page_mm.y() * kPointsPerMm);
  start_page();
}

void Pdf::text(const std::string& words, const Vec2& at_mm, double height_mm, Align align) {
  cairo_select_font_face(context_, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context_, height_mm);
  cairo_text_extents_t extents;
  cairo_text_extents(context_, words.c_str(), &extents);
  const double back_mm = align == Align::kLeft ? 0 : extents.x_advance * (align == Align::kMiddle ? 0.5 : 1);
  cairo_move_to(context_, at_mm.x() - back_mm, at_mm.y());
  cairo_show_text(context_, words.c_str());
  cairo_new_path(context_);
}

void Pdf::line(const Vec2& from_mm, const Vec2& to_mm) {
  cairo_move_to(context_, from_mm.x(), from_mm.y());
  cairo_line_to(context_, to_mm.x(), to_mm.y());
  cairo_stroke(context_);
}

void Pdf::grey(double level) { cairo_set_source_rgb(context_, level, level, level); }

void Pdf::save(const std::filesystem::path& path) {
  cairo_show_page(context_);
  cairo_surface_finish(surface_);
  for (const cairo_status_t status : {cairo_status(context_), cairo_surface_status(surface_)}) {
    if (status != CAIRO_STATUS_SUCCESS) {
      throw ToolError(path.string() + ": cannot be drawn: " + cairo_status_to_string(status));
    }
  }
  write_atomic(path, bytes_);
}

}  // namespace roomcal::tools
