#pragma once
// The lines of an SVG file that nobody vouches for, any program's: read by limn-read-svg, in a process of its own (sdf/guard.h), which
// resolves transforms and styles and sends polylines.

#include <filesystem>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace limn {

class ByteWriter;

/// How far the polylines may lie from the curves of the file, units of the viewBox.
inline constexpr double kSvgFlatness_px = 0.002;

/// A subpath that is painted.
struct SvgLine {
  std::string id{};       ///< Of its element; may be empty.
  std::string color{};    ///< Of the stroke, or of the fill where there is none, as in the file: "#000000".
  double width_px = 0.0;  ///< Of the stroke; 0 where there is none.
  double opacity = 1.0;
  bool closed = false;               ///< The first point is not repeated at the end.
  std::vector<glm::dvec2> points{};  ///< Units of the viewBox from its corner, y down; at least two.
};

struct SvgFile {
  double width_px = 0.0, height_px = 0.0;  ///< Of the viewBox.
  std::vector<SvgLine> lines{};
  std::vector<std::string> left_out{};  ///< What the reader does not draw: "text", "clip-path".
};

/// Throws InputError naming `file`: not there, no SVG, damaged, more than the limits allow.
SvgFile read_svg_file(const std::filesystem::path& file);

/// What the helper sends. The reader trusts nothing: InputError for bytes that are no such answer.
void put_svg(ByteWriter& answer, const SvgFile& svg);
SvgFile svg_from_answer(std::span<const std::byte> bytes, const std::filesystem::path& file);

}  // namespace limn
