// Strokes as SVG.

#include <fmt/format.h>

#include <cmath>
#include <map>
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

/// Rules of the classes that occur, and the layers that they are about.
struct SvgLayers {
  std::map<std::string, std::string> rules{};  ///< By selector.
  std::string text{};
};

/// `suffix`: makes ids unique in a file of several frames.
void add_layers(const LineDrawing& drawing, const std::string& suffix, SvgLayers& out) {
  int number_of_layer = 0;
  for (size_t i = 0; i < drawing.strokes.size();) {
    const LineClass line_class = drawing.strokes[i].line_class;
    const bool visible = drawing.strokes[i].invisibility == 0;
    const char* const seen = visible ? "visible" : "hidden";
    const std::string& name = name_of(line_class);
    const StrokeStyle& style = style_of(drawing, drawing.strokes[i]);
    std::string& rule = out.rules[fmt::format(".{}.{} path", name, seen)];
    rule = fmt::format(".{}.{} path{{{}}}", name, seen, css_of(style));
    if (style.taper) rule += fmt::format(".{}.{} path.taper{{fill:{};stroke:none}}", name, seen, style.color);
    ++number_of_layer;
    out.text += fmt::format("<g id=\"{0}-{1}{3}\" class=\"{0} {1}\" inkscape:groupmode=\"layer\" inkscape:label=\"{2} {0} {1}\">\n", name,
                            seen, number_of_layer, suffix);
    for (; i < drawing.strokes.size(); ++i) {
      const Stroke& stroke = drawing.strokes[i];
      if (stroke.line_class != line_class || (stroke.invisibility == 0) != visible) break;
      const bool narrows = tapers(stroke, style);
      out.text += fmt::format("<path id=\"chain-{0}{1}\"{2} data-id=\"{0}\" data-qi=\"{3}\" data-object=\"{4}\" d=\"{5}\"/>\n", stroke.id,
                              suffix, narrows ? " class=\"taper\"" : "", stroke.invisibility, stroke.object,
                              narrows ? outline_of(tapered_outline(stroke, style.width_px)) : path_of(stroke));
    }
    out.text += "</g>\n";
  }
}

std::string style_text(const SvgLayers& layers, const std::string& more) {
  std::string text = "<style>path{fill:none;stroke-linejoin:round;stroke-linecap:round}";
  for (const auto& [selector, rule] : layers.rules) text += rule;
  return text + more + "</style>\n";
}

}  // namespace

std::string svg_text(const LineDrawing& drawing, const std::string& title) {
  SvgLayers layers;
  add_layers(drawing, "", layers);
  return header(drawing, title) + style_text(layers, "") + layers.text + "</svg>\n";
}

std::string animated_svg_text(const std::vector<LineDrawing>& drawings, const std::string& title, double frames_per_second) {
  const auto count = static_cast<double>(drawings.size());
  SvgLayers layers;
  for (size_t k = 0; k < drawings.size(); ++k) {
    // Each frame is shown for its share of the film, which starts as much later as the frame stands in it.
    layers.text += fmt::format("<g id=\"frame-{0}\" class=\"frame{1}\" style=\"animation-delay:{2:.6f}s\">\n", k, k == 0 ? " first" : "",
                               static_cast<double>(k) / frames_per_second);
    add_layers(drawings[k], fmt::format("-f{}", k), layers);
    layers.text += "</g>\n";
  }
  const std::string film = drawings.size() < 2
                               ? ""
                               : fmt::format(
                                     ".frame{{visibility:hidden;animation:frame {:.6f}s step-end infinite}}.first{{visibility:visible}}"
                                     "@keyframes frame{{0%{{visibility:visible}}{:.6f}%{{visibility:hidden}}}}",
                                     count / frames_per_second, 100.0 / count);
  return header(drawings.front(), title) + style_text(layers, film) + layers.text + "</svg>\n";
}

}  // namespace limn
