// Strokes as PDF, by Cairo.

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "samples/lines/taper.h"
#include "samples/lines/write_drawing.h"
#include "samples/output/cairo_module.h"
#include "sdf/error.h"

namespace limn {
namespace {

constexpr double kPointsPerMm = 72.0 / 25.4, kPointsPerPx = 0.75;

struct CloseSurface {
  void operator()(cairo_surface_t* surface) const { cairo().surface_destroy(surface); }
};
struct CloseContext {
  void operator()(cairo_t* context) const { cairo().destroy(context); }
};

void add_path(cairo_t* context, const Stroke& stroke) {
  cairo().new_path(context);
  cairo().move_to(context, stroke.start.x, stroke.start.y);
  glm::dvec2 at = stroke.start;
  for (const PathStep& step : stroke.steps) {
    if (const auto* line = std::get_if<LineTo>(&step)) {
      cairo().line_to(context, line->to.x, line->to.y);
      at = line->to;
    } else if (const auto* cubic = std::get_if<CubicTo>(&step)) {
      cairo().curve_to(context, cubic->control1.x, cubic->control1.y, cubic->control2.x, cubic->control2.y, cubic->to.x, cubic->to.y);
      at = cubic->to;
    } else {
      const auto& arc = std::get<ArcTo>(step);
      const double from = std::atan2(at.y - arc.center.y, at.x - arc.center.x);
      (arc.sweep > 0.0 ? cairo().arc : cairo().arc_negative)(context, arc.center.x, arc.center.y, arc.radius, from, from + arc.sweep);
      at = arc.to;
    }
  }
  if (stroke.closed) cairo().close_path(context);
}

void set_color(cairo_t* context, const std::string& color) {
  const auto part = [&](size_t at) { return std::stoi(color.substr(at, 2), nullptr, 16) / 255.0; };
  cairo().set_source_rgb(context, part(1), part(3), part(5));
}

void paint(cairo_t* context, const Stroke& stroke, const StrokeStyle& style) {
  set_color(context, style.color);
  if (tapers(stroke, style)) {
    cairo().new_path(context);
    for (const glm::dvec2& p : tapered_outline(stroke, style.width_px)) cairo().line_to(context, p.x, p.y);
    cairo().close_path(context);
    cairo().fill(context);
    return;
  }
  cairo().set_line_width(context, style.width_px);
  cairo().set_dash(context, style.dash_px.data(), static_cast<int>(style.dash_px.size()), 0.0);
  add_path(context, stroke);
  cairo().stroke(context);
}

}  // namespace

void write_pdf(const LineDrawing& drawing, const std::string& title, const std::filesystem::path& file) {
  const glm::dvec2 size(drawing.width_px, drawing.height_px);
  const auto& page_mm = drawing.settings.page_mm;
  const glm::dvec2 page = page_mm ? kPointsPerMm * *page_mm : kPointsPerPx * size;
  const double scale = std::min(page.x / size.x, page.y / size.y);
  const std::unique_ptr<cairo_surface_t, CloseSurface> surface(cairo().pdf_surface_create(file.c_str(), page.x, page.y));
  cairo().pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, title.c_str());
  {
    const std::unique_ptr<cairo_t, CloseContext> context(cairo().create(surface.get()));
    cairo().translate(context.get(), 0.5 * (page.x - scale * size.x), 0.5 * (page.y - scale * size.y));
    cairo().scale(context.get(), scale, scale);
    cairo().set_line_join(context.get(), CAIRO_LINE_JOIN_ROUND);
    cairo().set_line_cap(context.get(), CAIRO_LINE_CAP_ROUND);
    for (const Stroke& stroke : drawing.strokes) paint(context.get(), stroke, style_of(drawing, stroke));
  }
  cairo().surface_finish(surface.get());
  const cairo_status_t status = cairo().surface_status(surface.get());
  if (status != CAIRO_STATUS_SUCCESS)
    throw MachineError(fmt::format("{}: cannot be written: {}", file.string(), cairo().status_to_string(status)));
}

}  // namespace limn
