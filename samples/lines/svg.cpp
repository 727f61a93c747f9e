// Strokes as SVG.

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "samples/lines/taper.h"
#include "samples/lines/write_drawing.h"

namespace limn {
namespace {

/// A coordinate to a ten-thousandth of a pixel, without zeros at its end.
std::string number(double x) {
  std::string text = fmt::format("{:.4f}", x);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}
std::string place(const glm::dvec2& p) { return number(p.x) + " " + number(p.y); }

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

/// An arc of more than half a circle is cut in two: SVG draws none whose ends coincide.
void add_arc(const ArcTo& arc, const glm::dvec2& from, std::string& path) {
  const auto piece = [&](const glm::dvec2& to, double sweep) {
    path += fmt::format("A{0} {0} 0 {1} {2} {3}", number(arc.radius), std::fabs(sweep) > std::numbers::pi ? 1 : 0, sweep > 0.0 ? 1 : 0,
                        place(to));
  };
  if (std::fabs(arc.sweep) < 1.5 * std::numbers::pi) {
    piece(arc.to, arc.sweep);
    return;
  }
  const glm::dvec2 r = from - arc.center;
  const double c = std::cos(0.5 * arc.sweep), s = std::sin(0.5 * arc.sweep);
  piece(arc.center + glm::dvec2(c * r.x - s * r.y, s * r.x + c * r.y), 0.5 * arc.sweep);
  piece(arc.to, 0.5 * arc.sweep);
}

std::string path_of(const Stroke& stroke) {
  std::string path = "M" + place(stroke.start);
  glm::dvec2 at = stroke.start;
  for (const PathStep& step : stroke.steps) {
    if (const auto* line = std::get_if<LineTo>(&step)) {
      path += "L" + place(line->to);
      at = line->to;
    } else if (const auto* cubic = std::get_if<CubicTo>(&step)) {
      path += "C" + place(cubic->control1) + " " + place(cubic->control2) + " " + place(cubic->to);
      at = cubic->to;
    } else {
      const auto& arc = std::get<ArcTo>(step);
      add_arc(arc, at, path);
      at = arc.to;
    }
  }
  if (stroke.closed) path += "Z";
  return path;
}

std::string outline_of(const std::vector<glm::dvec2>& corners) {
  std::string path = "M";
  for (const glm::dvec2& corner : corners) path += (path.size() > 1 ? "L" : "") + place(corner);
  return path + "Z";
}

std::string css_of(const StrokeStyle& style) {
  std::string text = fmt::format("stroke:{};stroke-width:{}", style.color, number(style.width_px));
  for (size_t i = 0; i < style.dash_px.size(); ++i) text += (i == 0 ? ";stroke-dasharray:" : ",") + number(style.dash_px[i]);
  return text;
}

std::string header(const LineDrawing& drawing, const std::string& title) {
  std::string size;
  if (const auto& page = drawing.settings.page_mm) {
    // The drawing keeps its shape and stands in the middle of the page (preserveAspectRatio's default).
    size = fmt::format("width=\"{}mm\" height=\"{}mm\"", number(page->x), number(page->y));
  } else {
    size = fmt::format("width=\"{}\" height=\"{}\"", drawing.width_px, drawing.height_px);
  }
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  text += fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" {} viewBox=\"0 0 {} "
      "{}\">\n",
      size, drawing.width_px, drawing.height_px);
  text += "<title>" + escaped(title) + "</title>\n";
  return text;
}

}  // namespace

std::string svg_text(const LineDrawing& drawing, const std::string& title) {
  std::string text = header(drawing, title);
  text += "<style>path{fill:none;stroke-linejoin:round;stroke-linecap:round}";
  std::string layers;
  int number_of_layer = 0;
  for (size_t i = 0; i < drawing.strokes.size();) {
    const LineClass line_class = drawing.strokes[i].line_class;
    const bool visible = drawing.strokes[i].invisibility == 0;
    const char* const seen = visible ? "visible" : "hidden";
    const std::string& name = name_of(line_class);
    const StrokeStyle& style = style_of(drawing, drawing.strokes[i]);
    text += fmt::format(".{}.{} path{{{}}}", name, seen, css_of(style));
    if (style.taper) text += fmt::format(".{}.{} path.taper{{fill:{};stroke:none}}", name, seen, style.color);
    ++number_of_layer;
    layers += fmt::format("<g id=\"{0}-{1}\" class=\"{0} {1}\" inkscape:groupmode=\"layer\" inkscape:label=\"{2} {0} {1}\">\n", name, seen,
                          number_of_layer);
    for (; i < drawing.strokes.size(); ++i) {
      const Stroke& stroke = drawing.strokes[i];
      if (stroke.line_class != line_class || (stroke.invisibility == 0) != visible) break;
      const bool narrows = tapers(stroke, style);
      layers += fmt::format("<path id=\"chain-{}\"{} data-qi=\"{}\" data-object=\"{}\" d=\"{}\"/>\n", stroke.chain,
                            narrows ? " class=\"taper\"" : "", stroke.invisibility, stroke.object,
                            narrows ? outline_of(tapered_outline(stroke, style.width_px)) : path_of(stroke));
    }
    layers += "</g>\n";
  }
  return text + "</style>\n" + layers + "</svg>\n";
}

}  // namespace limn
