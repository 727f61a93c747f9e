#include "raymarch/scene/scene_extent.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sdf/error.h"

namespace limn {
namespace {

std::string file_of(const SceneObject& object) {
  if (const auto* mesh = std::get_if<MeshSource>(&object.source)) return mesh->file;
  if (const auto* volume = std::get_if<LevelSetSource>(&object.source)) return volume->file;
  return {};
}

double largest_coordinate(const Box& box) {
  const glm::dvec3 corner = glm::max(glm::abs(box.lower), glm::abs(box.upper));
  return std::max({corner.x, corner.y, corner.z});
}

void check(const SceneObject& object) {
  const Box box = bounds(object);
  if (box.empty()) return;
  const std::string field = object.name.empty() ? "object" : "object '" + object.name + "'";
  const double side = box.longest_side(), largest = largest_coordinate(box);
  const bool mesh = std::holds_alternative<MeshSource>(object.source);
  if (mesh && !std::isfinite(side))
    throw InputError({file_of(object), field, "", "its coordinates are too large to be placed", "coordinates below 1e12"});
  // A single point has no size; what that means is told where nothing is drawn.
  if (!box.finite() || (side == 0.0 && largest <= kMostSide)) return;
  const std::string expected = fmt::format("{:g} to {:g} along the longest side; scale the coordinates", kLeastSide, kMostSide);
  if (side > kMostSide) throw InputError({file_of(object), field, fmt::format("{:.3g}", side), "too large to be drawn", expected});
  if (side > 0.0 && side < kLeastSide)
    throw InputError({file_of(object), field, fmt::format("{:.3g}", side), "too small to be drawn", expected});
  const double step = std::nextafter(largest, std::numeric_limits<double>::infinity()) - largest;
  if (side < kLeastSteps * step)
    throw InputError({file_of(object), field, fmt::format("{:.3g} wide at {:.3g}", side, largest),
                      fmt::format("too far from the origin: coordinates are {:.2g} apart there", step), "coordinates nearer the origin"});
}

}  // namespace

void check_extent(const Scene& scene) {
  for (const SceneObject& object : scene.objects) check(object);
}

}  // namespace limn
