// limn-read-svg FILE: reads an SVG that nobody vouches for with pugixml, resolves its styles and transforms, and answers with what it
// paints as polylines (sdf/guard.h).

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <pugixml.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "samples/judge/helpers/svg_path.h"
#include "samples/judge/helpers/svg_style.h"
#include "samples/judge/svg_file.h"
#include "sdf/guard.h"
#include "sdf/guard_helper.h"

namespace {

using limn::SvgFile;
using limn::SvgLine;
using limn::SvgPolyline;
using limn::SvgStyle;
using limn::SvgTransform;

constexpr int kDeepest = 200;             ///< Elements in elements.
constexpr int kMostElements = 5'000'000;  ///< <use> repeats others: a few lines can ask for billions.
constexpr size_t kMostPoints = 40'000'000;

[[noreturn]] void refuse(const std::string& reason) { throw std::runtime_error(reason); }

struct Reading {
  const pugi::xml_node root{};
  std::vector<limn::CssRule> rules{};
  glm::dvec2 size{0.0};
  SvgFile svg{};
  int elements = 0;
  size_t points = 0;
};

/// What stands between an element and the viewBox.
struct Inherited {
  SvgStyle style{};
  SvgTransform transform{1.0};
  int depth = 0;
};

void collect_rules(const pugi::xml_node& root, std::vector<limn::CssRule>& rules) {
  // A search that finds nothing visits all.
  root.find_node([&](const pugi::xml_node& node) {
    if (node.type() != pugi::node_element || limn::local_name(node.name()) != "style") return false;
    std::string sheet;
    for (const pugi::xml_node& text : node.children()) sheet += text.value();
    limn::add_css(sheet, rules);
    return false;
  });
  limn::sort_css(rules);
}

void leave_out(Reading& reading, const std::string& what) {
  std::vector<std::string>& all = reading.svg.left_out;
  if (std::find(all.begin(), all.end(), what) == all.end()) all.push_back(what);
}

bool is_painted(const std::string& paint) { return paint != "none" && paint != "transparent"; }

void add_line(Reading& reading, SvgLine line, const SvgPolyline& polyline) {
  if (polyline.points.size() < 2) return;
  line.closed = polyline.closed;
  line.points = polyline.points;
  reading.points += line.points.size();
  if (reading.points > kMostPoints) refuse("it has more than 40 million points; a smaller drawing");
  reading.svg.lines.push_back(std::move(line));
}

void add_shape(Reading& reading, const pugi::xml_node& element, const Inherited& above) {
  const SvgStyle& style = above.style;
  const bool stroked = is_painted(style.stroke) && style.stroke_width > 0.0 && style.stroke_opacity > 0.0;
  const bool filled = is_painted(style.fill) && style.fill_opacity > 0.0;
  if (!style.visible || style.opacity <= 0.0 || (!stroked && !filled)) return;
  const SvgTransform& m = above.transform;
  const double scale = std::sqrt(std::fabs(m[0].x * m[1].y - m[0].y * m[1].x));
  SvgLine line;
  line.id = element.attribute("id").value();
  line.color = stroked ? style.stroke : style.fill;
  line.width_px = stroked ? style.stroke_width * scale : 0.0;
  line.opacity = style.opacity * (stroked ? style.stroke_opacity : style.fill_opacity);
  for (const SvgPolyline& polyline : limn::svg_shape(element, m, reading.size)) {
    if (!stroked || style.dash.empty() || !(scale > 0.0)) {
      add_line(reading, line, polyline);
      continue;
    }
    std::vector<double> dash = style.dash;
    for (double& one : dash) one *= scale;
    for (const SvgPolyline& piece : limn::dashed(polyline, dash, style.dash_offset * scale)) add_line(reading, line, piece);
  }
}

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void walk(Reading& reading, const pugi::xml_node& element, Inherited above);

void walk_children(Reading& reading, const pugi::xml_node& element, const Inherited& above) {
  for (const pugi::xml_node& child : element.children())
    if (child.type() == pugi::node_element) walk(reading, child, above);
}

/// Looked for by walking: an SVG has few <use>.
pugi::xml_node with_id(const pugi::xml_node& root, const std::string& id) {
  return root.find_node([&](const pugi::xml_node& node) { return id == node.attribute("id").value(); });
}

void walk_use(Reading& reading, const pugi::xml_node& element, Inherited above) {
  std::string target = element.attribute("href").value();
  if (target.empty()) target = element.attribute("xlink:href").value();
  if (target.size() < 2 || target.front() != '#') return;
  const pugi::xml_node used = with_id(reading.root, target.substr(1));
  if (!used) return;
  const auto number = [&](const char* key, double whole) {
    const double value = limn::svg_length(element.attribute(key).value(), whole);
    return std::isfinite(value) ? value : 0.0;
  };
  above.transform = above.transform * SvgTransform({1, 0, 0}, {0, 1, 0}, {number("x", reading.size.x), number("y", reading.size.y), 1});
  if (limn::local_name(used.name()) == "symbol")
    walk_children(reading, used, above);
  else
    walk(reading, used, above);
}

void walk(Reading& reading, const pugi::xml_node& element, Inherited above) {
  if (++reading.elements > kMostElements) refuse("it draws more than 5 million elements; a smaller drawing");
  if (++above.depth > kDeepest) refuse("its elements are nested more than 200 deep; a flatter drawing");
  const std::string_view name = limn::local_name(element.name());
  if (is_one_of(name, {"defs", "clipPath", "mask", "pattern", "marker", "symbol", "style", "title", "desc", "metadata", "script", "filter",
                       "linearGradient", "radialGradient"}))
    return;
  above.style = limn::style_of(element, above.style, reading.rules);
  if (!above.style.displayed) return;
  for (const char* const attribute : {"clip-path", "mask"})
    if (element.attribute(attribute) && std::string_view(element.attribute(attribute).value()) != "none") leave_out(reading, attribute);
  above.transform = above.transform * limn::svg_transform(element.attribute("transform").value());
  if (is_one_of(name, {"text", "image", "foreignObject"}))
    leave_out(reading, std::string(name));
  else if (is_one_of(name, {"g", "svg", "a", "switch"}))
    walk_children(reading, element, above);
  else if (name == "use")
    walk_use(reading, element, above);
  else
    add_shape(reading, element, above);
}

/// Where the viewBox starts, and its size.
glm::dvec2 read_view_box(const pugi::xml_node& root, SvgFile& svg) {
  const std::vector<double> box = limn::svg_numbers(root.attribute("viewBox").value());
  glm::dvec2 corner(0.0);
  if (box.size() == 4) {
    corner = {box[0], box[1]};
    svg.width_px = box[2];
    svg.height_px = box[3];
  } else {
    svg.width_px = limn::svg_length(root.attribute("width").value(), 100.0);
    svg.height_px = limn::svg_length(root.attribute("height").value(), 100.0);
  }
  constexpr double kLargest = 1e6;
  if (!(svg.width_px > 0.0 && svg.height_px > 0.0 && svg.width_px <= kLargest && svg.height_px <= kLargest))
    refuse("it says no size; an SVG with a viewBox, or width and height");
  return corner;
}

void read(const std::string& file, limn::ByteWriter& answer) {
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_file(file.c_str(), pugi::parse_default | pugi::parse_ws_pcdata_single);
  if (!result) refuse("no XML: " + std::string(result.description()) + " at byte " + std::to_string(result.offset) + "; an SVG file");
  const pugi::xml_node root = document.document_element();
  if (limn::local_name(root.name()) != "svg")
    refuse("its root is <" + std::string(root.name()).substr(0, 64) + ">; an SVG file, whose root is <svg>");
  Reading reading{root};
  const glm::dvec2 corner = read_view_box(root, reading.svg);
  reading.size = {reading.svg.width_px, reading.svg.height_px};
  collect_rules(root, reading.rules);
  Inherited above;
  above.style = limn::style_of(root, above.style, reading.rules);
  above.transform = SvgTransform({1, 0, 0}, {0, 1, 0}, {-corner.x, -corner.y, 1});
  walk_children(reading, root, above);
  limn::put_svg(answer, reading.svg);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("usage: limn-read-svg FILE (started by limn, answers on file descriptor 3)\n", stderr);
    return 2;
  }
  return limn::run_helper([&](limn::ByteWriter& answer) { read(arguments[1], answer); });
}
