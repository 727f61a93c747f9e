#include "samples/judge/drawing_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/files/picture_file.h"
#include "samples/judge/ink_picture.h"
#include "samples/judge/svg_file.h"
#include "samples/output/output.h"
#include "samples/spec/parse_color.h"
#include "sdf/error.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

bool is_svg(const fs::path& file) { return ending_of(file) == ".svg"; }

void check_kind(const fs::path& file) {
  if (!is_svg(file) && !is_picture_file(file))
    throw InputError({file.string(), "", ending_of(file), "not the extension of a drawing", ".svg, or a picture: .png .exr .tif .jpg"});
}

glm::ivec2 whole_size(const SvgFile& svg, const fs::path& file) {
  const glm::dvec2 size(svg.width_px, svg.height_px), whole(std::round(size.x), std::round(size.y));
  constexpr double kRounding_px = 1e-3, kLargest_px = 16384.0;
  const std::string text = fmt::format("{:g} x {:g}", size.x, size.y);
  if (std::max(std::fabs(size.x - whole.x), std::fabs(size.y - whole.y)) > kRounding_px)
    throw InputError({file.string(), "viewBox", text, "not whole pixels", "a viewBox as large as the picture, a unit for each pixel"});
  if (std::min(whole.x, whole.y) < 1.0 || std::max(whole.x, whole.y) > kLargest_px)
    throw InputError({file.string(), "viewBox", text, "out of range", "1 to 16384 in either direction"});
  return {static_cast<int>(whole.x), static_cast<int>(whole.y)};
}

void check_size(const fs::path& file, const char* field, const glm::ivec2& found, const glm::ivec2& size_px) {
  if (found == size_px) return;
  throw InputError({file.string(), field, fmt::format("{}x{}", found.x, found.y), "differs from the size of the picture",
                    fmt::format("a size of {}x{}, or a drawing of {}x{}", found.x, found.y, size_px.x, size_px.y)});
}

/// Colours that limn does not know count as ink: they are some colour.
bool has_color(const std::string& text, const glm::dvec3& wanted) {
  constexpr double kAlike = 0.1;
  try {
    return glm::distance(parse_color("color", text), wanted) <= kAlike;
  } catch (const InputError&) {
    return true;
  }
}

DrawnLines lines_of_svg(const fs::path& file, const InkChoice& ink, const glm::ivec2& size_px) {
  const SvgFile svg = read_svg_file(file);
  check_size(file, "viewBox", whole_size(svg, file), size_px);
  // A shape that is only filled is an area: a background, or an outline that another program made of ink.
  const bool stroked = std::any_of(svg.lines.begin(), svg.lines.end(), [](const SvgLine& line) { return line.width_px > 0.0; });
  DrawnLines drawing;
  drawing.width_px = size_px.x;
  drawing.height_px = size_px.y;
  drawing.from = stroked || svg.lines.empty() ? "strokes" : "outlines of areas";
  for (const SvgLine& line : svg.lines) {
    if (stroked && line.width_px <= 0.0) continue;
    if (ink.color && !has_color(line.color, *ink.color)) continue;
    drawing.lines.push_back({line.points, line.closed || !stroked, line.width_px});
  }
  if (drawing.lines.empty() && ink.color)
    throw InputError({file.string(), "ink", "", "it has no stroke of this colour", "the colour of its lines"});
  if (drawing.lines.empty()) drawing.notes.emplace_back("the SVG draws no line");
  for (const std::string& what : svg.left_out) drawing.notes.push_back(what + " in the SVG is left out");
  return drawing;
}

}  // namespace

glm::ivec2 size_of_drawing(const fs::path& file) {
  check_kind(file);
  if (is_svg(file)) return whole_size(read_svg_file(file), file);
  const PictureFile picture = read_picture_file(file);
  return {picture.parts.front().width_px, picture.parts.front().height_px};
}

DrawnLines read_drawing(const fs::path& file, const InkChoice& ink, const glm::ivec2& size_px) {
  check_kind(file);
  if (is_svg(file)) {
    if (ink.alpha || !ink.mask.empty())
      throw InputError({"", ink.alpha ? "alpha" : "mask", "", "an SVG has no pixels", "a colour of ink, or a picture"});
    return lines_of_svg(file, ink, size_px);
  }
  const Image<float> coverage = read_ink(file, ink);
  check_size(file, "size", {coverage.width, coverage.height}, size_px);
  DrawnLines drawing = lines_of_ink(coverage);
  if (drawing.lines.empty())
    throw InputError(
        {file.string(), "", "", "it has no ink", "the colour of the ink, its alpha, or a mask: they say what of the picture is ink"});
  return drawing;
}

}  // namespace limn
