#pragma once
// The drawing that `limn judge` looks at: strokes of an SVG, or ink in a picture.

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "samples/judge/judge_lines.h"

namespace limn {

/// What of a drawing is ink.
struct InkChoice {
  std::optional<glm::dvec3>
      color{};                   ///< Linear: strokes and pixels of this colour; unset: all strokes, and what is darker than the background.
  bool alpha = false;            ///< Of a picture: its alpha.
  std::filesystem::path mask{};  ///< In place of a picture's colours: its first channel, 1 where there is ink.
};

/// Width and height without reading the lines: of the viewBox, or of the picture. Throws InputError.
glm::ivec2 size_of_drawing(const std::filesystem::path& file);

/// Throws InputError: not there, not of a known kind, damaged, of another size than `size_px`, without ink.
DrawnLines read_drawing(const std::filesystem::path& file, const InkChoice& ink, const glm::ivec2& size_px);

}  // namespace limn
