#include "samples/study/chart_canvas.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>
#include <regex>
#include <sstream>

#include "raymarch/files/png_file.h"
#include "samples/output/cairo_module.h"
#include "samples/page/html.h"
#include "sdf/error.h"
#include "sdf/output_together.h"
#include "sdf/version.h"

namespace limn {
namespace {

constexpr std::array<ChartColor, 7> kStyleColors = {{{0.000, 0.447, 0.698},
                                                     {0.835, 0.369, 0.000},
                                                     {0.000, 0.620, 0.451},
                                                     {0.800, 0.475, 0.655},
                                                     {0.902, 0.624, 0.000},
                                                     {0.337, 0.706, 0.914},
                                                     {0.0, 0.0, 0.0}}};

struct Surface {
  cairo_surface_t* surface;
  cairo_t* context;
  explicit Surface(cairo_surface_t* made) : surface(made), context(cairo().create(made)) {}
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;
  ~Surface() {
    cairo().destroy(context);
    cairo().surface_destroy(surface);
  }
  void check() const {
    const cairo_status_t status =
        cairo().status(context) != CAIRO_STATUS_SUCCESS ? cairo().status(context) : cairo().surface_status(surface);
    if (status != CAIRO_STATUS_SUCCESS) throw MachineError(fmt::format("a chart could not be drawn: {}", cairo().status_to_string(status)));
  }
};

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

void paint(const Surface& target, double width, double height, const std::function<void(ChartCanvas&)>& draw) {
  cairo().set_source_rgb(target.context, 1.0, 1.0, 1.0);
  cairo().rectangle(target.context, 0.0, 0.0, width, height);
  cairo().fill(target.context);
  ChartCanvas canvas(target.context, width, height);
  draw(canvas);
}

std::string svg_of(double width, double height, const std::string& title, const std::string& words,
                   const std::function<void(ChartCanvas&)>& draw) {
  std::string bytes;
  {
    const Surface target(cairo().svg_surface_create_for_stream(append, &bytes, width, height));
    cairo().svg_surface_set_document_unit(target.surface, CAIRO_SVG_UNIT_PX);
    paint(target, width, height, draw);
    cairo().surface_finish(target.surface);
    target.check();
  }
  // Cairo counts the surfaces of the whole process and names the outermost group by that, which nothing refers to.
  bytes = std::regex_replace(bytes, std::regex("<g id=\"surface[0-9]+\">"), "<g>");
  const size_t head = bytes.find("<svg"), end = bytes.find('>', head);
  LIMN_CHECK(head != std::string::npos && end != std::string::npos);
  bytes.insert(end + 1, "\n<title>" + escaped(title) + "</title>\n<desc>" + escaped(words) + "</desc>");
  bytes.insert(end, " role=\"img\"");
  return bytes;
}

std::string png_of(double width, double height, const std::function<void(ChartCanvas&)>& draw) {
  constexpr double kScale = 2.0;
  const int width_px = static_cast<int>(kScale * width), height_px = static_cast<int>(kScale * height);
  const Surface target(cairo().image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px));
  cairo().scale(target.context, kScale, kScale);
  paint(target, width, height, draw);
  target.check();
  cairo().surface_flush(target.surface);
  // Cairo's own PNG writer takes ten times as long. A pixel is a number of 32 bits: red, green and blue in the lower three bytes.
  const unsigned char* const data = cairo().image_surface_get_data(target.surface);
  const auto stride = static_cast<size_t>(cairo().image_surface_get_stride(target.surface));
  std::vector<std::uint8_t> pixels;
  pixels.reserve(3 * static_cast<size_t>(width_px) * static_cast<size_t>(height_px));
  for (size_t y = 0; y < static_cast<size_t>(height_px); ++y) {
    for (size_t x = 0; x < static_cast<size_t>(width_px); ++x) {
      std::uint32_t pixel = 0;
      std::memcpy(&pixel, data + y * stride + sizeof pixel * x, sizeof pixel);
      for (const int shift : {16, 8, 0}) pixels.push_back(static_cast<std::uint8_t>(pixel >> shift & 0xff));
    }
  }
  const std::vector<std::byte> png = png_file({width_px, height_px, 3, pixels, std::string("limn ") + kVersion});
  return {reinterpret_cast<const char*>(png.data()), png.size()};
}

void choose_font(cairo_t* context, const ChartText& style) {
  cairo().select_font_face(context, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo().set_font_size(context, style.size_px);
}

std::vector<ChartPoint> corners(const ChartPoint& at, size_t shape, double r) {
  switch (shape) {
    case 1:
      return {{at.x - 0.89 * r, at.y - 0.89 * r},
              {at.x + 0.89 * r, at.y - 0.89 * r},
              {at.x + 0.89 * r, at.y + 0.89 * r},
              {at.x - 0.89 * r, at.y + 0.89 * r}};
    case 2:
      return {{at.x, at.y - 1.25 * r}, {at.x + 1.12 * r, at.y + 0.75 * r}, {at.x - 1.12 * r, at.y + 0.75 * r}};
    case 3:
      return {{at.x, at.y - 1.3 * r}, {at.x + 1.3 * r, at.y}, {at.x, at.y + 1.3 * r}, {at.x - 1.3 * r, at.y}};
    case 4:
      return {{at.x, at.y + 1.25 * r}, {at.x + 1.12 * r, at.y - 0.75 * r}, {at.x - 1.12 * r, at.y - 0.75 * r}};
    default: {
      const double a = 0.42 * r, b = 1.2 * r;
      return {{at.x - a, at.y - b}, {at.x + a, at.y - b}, {at.x + a, at.y - a}, {at.x + b, at.y - a},
              {at.x + b, at.y + a}, {at.x + a, at.y + a}, {at.x + a, at.y + b}, {at.x - a, at.y + b},
              {at.x - a, at.y + a}, {at.x - b, at.y + a}, {at.x - b, at.y - a}, {at.x - a, at.y - a}};
    }
  }
}

}  // namespace

ChartColor style_color(size_t style) { return kStyleColors[style % kStyleColors.size()]; }

void ChartCanvas::set(const ChartColor& color) { cairo().set_source_rgba(context_, color.red, color.green, color.blue, color.alpha); }

void ChartCanvas::trace(const std::vector<ChartPoint>& points) {
  cairo().new_path(context_);
  for (const ChartPoint& point : points) cairo().line_to(context_, point.x, point.y);
}

void ChartCanvas::line(const std::vector<ChartPoint>& points, const ChartColor& color, double thickness, bool dashed) {
  if (points.size() < 2) return;
  const double dash[] = {5.0, 4.0};
  set(color);
  trace(points);
  cairo().set_line_width(context_, thickness);
  cairo().set_line_join(context_, CAIRO_LINE_JOIN_ROUND);
  cairo().set_dash(context_, dash, dashed ? 2 : 0, 0.0);
  cairo().stroke(context_);
}

void ChartCanvas::area(const std::vector<ChartPoint>& points, const ChartColor& color) {
  set(color);
  trace(points);
  cairo().close_path(context_);
  cairo().fill(context_);
}

void ChartCanvas::box(const ChartBox& place, const ChartColor& color) {
  area({{place.x, place.y},
        {place.x + place.width, place.y},
        {place.x + place.width, place.y + place.height},
        {place.x, place.y + place.height}},
       color);
}

void ChartCanvas::frame(const ChartBox& place, const ChartColor& color) {
  line({{place.x, place.y},
        {place.x + place.width, place.y},
        {place.x + place.width, place.y + place.height},
        {place.x, place.y + place.height},
        {place.x, place.y}},
       color, 1.0);
}

void ChartCanvas::marker(const ChartPoint& at, size_t style, double radius, bool filled) {
  const size_t shape = style % kMarkers;
  if (shape == 0) {
    cairo().new_path(context_);
    cairo().arc(context_, at.x, at.y, radius, 0.0, 2.0 * std::numbers::pi);
  } else {
    trace(corners(at, shape, radius));
  }
  cairo().close_path(context_);
  cairo().set_dash(context_, nullptr, 0, 0.0);
  cairo().set_line_width(context_, filled ? 1.0 : 1.6);
  if (filled) {
    set(style_color(style));
    cairo().fill_preserve(context_);
    cairo().set_source_rgb(context_, 1.0, 1.0, 1.0);
  } else {
    set(style_color(style));
  }
  cairo().stroke(context_);
}

double ChartCanvas::text_width(const std::string& words, const ChartText& style) const {
  choose_font(context_, style);
  cairo_text_extents_t extents;
  cairo().text_extents(context_, words.c_str(), &extents);
  return extents.x_advance;
}

void ChartCanvas::text(const ChartPoint& at, const std::string& words, const ChartText& style) {
  const double width = text_width(words, style);
  const double shift = style.align == ChartAlign::left ? 0.0 : style.align == ChartAlign::center ? -0.5 * width : -width;
  cairo().save(context_);
  cairo().translate(context_, at.x, at.y);
  cairo().rotate(context_, -style.turn_deg * std::numbers::pi / 180.0);
  cairo().move_to(context_, shift, 0.0);
  set(style.color);
  cairo().show_text(context_, words.c_str());
  cairo().restore(context_);
}

std::vector<std::string> ChartCanvas::lines(const std::string& words, double width, const ChartText& style) const {
  std::vector<std::string> out;
  std::istringstream stream(words);
  for (std::string word; stream >> word;) {
    if (!out.empty() && text_width(out.back() + " " + word, style) <= width) {
      out.back() += " " + word;
    } else {
      out.push_back(word);
    }
  }
  return out;
}

void ChartCanvas::begin_clip(const ChartBox& place) {
  cairo().save(context_);
  cairo().rectangle(context_, place.x, place.y, place.width, place.height);
  cairo().clip(context_);
}
void ChartCanvas::end_clip() { cairo().restore(context_); }

std::vector<std::filesystem::path> write_chart(const std::filesystem::path& stem, double width, double height, const std::string& title,
                                               const std::string& words, const std::function<void(ChartCanvas&)>& draw) {
  const std::filesystem::path svg = stem.string() + ".svg", png = stem.string() + ".png";
  // Both are drawn before either is written, and take their places together.
  write_together(std::array{bytes_output(svg, svg_of(width, height, title, words, draw)), bytes_output(png, png_of(width, height, draw))});
  return {svg, png};
}

}  // namespace limn
