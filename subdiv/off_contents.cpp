#include "subdiv/off_contents.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sdf/color.h"
#include "sdf/error.h"
#include "subdiv/repair_faces.h"
#include "subdiv/text_cursor.h"

namespace limn {
namespace {

/// Real colours may be brighter than white, if not by as much.
constexpr double kMostReal = 16.0;

/// Whole numbers up to 255, or real ones up to 1; both as a screen shows them.
void take_colors(OffContents& contents) {
  double largest = 0.0;
  bool whole = true;
  for (const glm::dvec3& color : contents.colors) {
    largest = std::max({largest, color.x, color.y, color.z});
    whole = whole && color == glm::floor(color);
  }
  const double white = largest > kMostReal || (whole && largest > 1.0) ? 255.0 : 1.0;
  for (const glm::dvec3& color : contents.colors) {
    glm::vec3 linear;
    for (int k = 0; k < 3; ++k) {
      const double shown = color[k] / white;
      linear[k] = linear_from_srgb(static_cast<float>(std::isfinite(shown) ? std::clamp(shown, 0.0, 1.0) : 1.0));
    }
    contents.mesh.vertex_colors.push_back(linear);
  }
}

void take_normals(OffContents& contents) {
  const std::vector<glm::vec3>& normals = contents.normals;
  if (normals.empty()) return;
  Mesh& mesh = contents.mesh;
  mesh.corner_normals.reserve(mesh.corner_vertices.size());
  for (const std::int32_t v : mesh.corner_vertices) {
    const bool there = v >= 0 && static_cast<size_t>(v) < normals.size();
    const glm::vec3 n = there ? normals[static_cast<size_t>(v)] : glm::vec3(0.0f);
    const float length = glm::length(n);
    mesh.corner_normals.push_back(length > 0.0f && std::isfinite(length) ? n / length : glm::vec3(0.0f));
  }
}

}  // namespace

bool read_off_word(std::string_view word, OffLayout& layout) {
  const auto take = [&word](std::string_view prefix) {
    if (!same_word(word.substr(0, prefix.size()), prefix)) return false;
    word.remove_prefix(prefix.size());
    return true;
  };
  layout.texture = take("ST");
  layout.color = take("C");
  // 'N' is for normals, 'n' for the dimension: here the case counts.
  layout.normal = word.starts_with('N') && (word.remove_prefix(1), true);
  layout.homogeneous = take("4");
  layout.any_dimension = word.starts_with('n') && (word.remove_prefix(1), true);
  return same_word(word, "OFF");
}

void OffLimits::count(std::int64_t more) {
  elements += more;
  if (elements > most)
    throw InputError({file, "", fmt::format("{}", elements), "more vertices and corners than allowed", fmt::format("at most {}", most)});
}

void OffLimits::break_off(const char* what, std::int64_t read, std::int64_t promised) const {
  throw InputError({file, what, fmt::format("{}", read), "the file breaks off", fmt::format("{}, as its header says", promised)});
}

Mesh finished(OffContents contents, const std::string& file) {
  take_colors(contents);
  take_normals(contents);
  repair_faces(contents.mesh, {.file = file});
  return std::move(contents.mesh);
}

}  // namespace limn
