#include "samples/experiment/empty_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sdf/level_set_leaks.h"

namespace limn {
namespace {

/// Of what the bounds promise this is next to nothing: a rod of one pixel across the bounds' diagonal still covers twice as much.
constexpr double kFewOfPromised = 1e-3;
constexpr double kTooFewToJudge_px = 2000.0;
constexpr size_t kMostObjects = 3;

using Polygon = std::vector<glm::dvec2>;

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

double area_of(const Polygon& polygon) {
  double twice = 0.0;
  for (size_t i = 0; i < polygon.size(); ++i) twice += cross(polygon[i], polygon[(i + 1) % polygon.size()]);
  return 0.5 * std::abs(twice);
}

/// Andrew's monotone chain.
Polygon convex_hull(Polygon points) {
  std::sort(points.begin(), points.end(), [](const glm::dvec2& a, const glm::dvec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  if (points.size() < 3) return points;
  Polygon hull;
  for (int side = 0; side < 2; ++side) {
    const size_t first = hull.size();
    for (const glm::dvec2& point : points) {
      while (hull.size() >= first + 2 && cross(hull.back() - hull[hull.size() - 2], point - hull.back()) <= 0.0) hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

/// The part of a convex polygon where x (axis 0) or y (axis 1) is at least, or with `below` at most, `bound`.
Polygon clipped(const Polygon& polygon, int axis, double bound, bool below) {
  const auto inside = [&](const glm::dvec2& p) { return below ? p[axis] <= bound : p[axis] >= bound; };
  Polygon out;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if (inside(a)) out.push_back(a);
    if (inside(a) != inside(b)) out.push_back(glm::mix(a, b, (bound - a[axis]) / (b[axis] - a[axis])));
  }
  return out;
}

/// The least distance of two parallel lines that hold it between them.
double narrowest_width(const Polygon& hull) {
  double narrowest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < hull.size(); ++i) {
    const glm::dvec2 edge = hull[(i + 1) % hull.size()] - hull[i];
    const double length = glm::length(edge);
    if (!(length > 0.0)) continue;
    double width = 0.0;
    for (const glm::dvec2& point : hull) width = std::max(width, std::abs(cross(edge, point - hull[i])) / length);
    narrowest = std::min(narrowest, width);
  }
  return hull.size() < 3 ? 0.0 : narrowest;
}

/// A box as a camera sees it.
struct Outline {
  bool behind = false;     ///< No part of it lies before the camera.
  double behind_by = 0.0;  ///< How far its nearest corner lies behind.
  Polygon hull{};          ///< Of the part before the camera, in pixels.
  double framed_px = 0.0;  ///< Its area within the frame.
};

Outline outline_of(const Box& box, const Camera& camera) {
  std::array<glm::dvec3, 8> corners;
  std::array<double, 8> depths{};
  for (size_t i = 0; i < 8; ++i) {
    corners[i] = {i & 1 ? box.upper.x : box.lower.x, i & 2 ? box.upper.y : box.lower.y, i & 4 ? box.upper.z : box.lower.z};
    depths[i] = -glm::dot(corners[i] - camera.eye, camera.world_from_camera[2]);
  }
  const double farthest = *std::max_element(depths.begin(), depths.end());
  Outline outline;
  outline.behind = !(farthest > 0.0);
  outline.behind_by = -farthest;
  if (outline.behind) return outline;
  // What is nearer than that fills any frame.
  const double nearest = 1e-3 * farthest;
  Polygon points;
  const auto add = [&](const glm::dvec3& world) { points.emplace_back(project(camera, world)); };
  for (size_t i = 0; i < 8; ++i) {
    if (depths[i] >= nearest) add(corners[i]);
    for (const size_t axis : {1u, 2u, 4u}) {
      const size_t j = i | axis;
      if (j == i || (depths[i] >= nearest) == (depths[j] >= nearest)) continue;
      add(glm::mix(corners[i], corners[j], (nearest - depths[i]) / (depths[j] - depths[i])));
    }
  }
  outline.hull = convex_hull(std::move(points));
  Polygon framed = clipped(clipped(outline.hull, 0, 0.0, false), 0, camera.width_px, true);
  framed = clipped(clipped(framed, 1, 0.0, false), 1, camera.height_px, true);
  outline.framed_px = area_of(framed);
  return outline;
}

bool holds(const Box& box, const glm::dvec3& point) {
  return glm::all(glm::greaterThanEqual(point, box.lower)) && glm::all(glm::lessThanEqual(point, box.upper));
}

/// "to the left and above".
std::string side_of(const Polygon& hull, const Camera& camera) {
  glm::dvec2 lower(std::numeric_limits<double>::infinity()), upper(-std::numeric_limits<double>::infinity());
  for (const glm::dvec2& point : hull) {
    lower = glm::min(lower, point);
    upper = glm::max(upper, point);
  }
  const char* const across = upper.x <= 0.0 ? "to the left" : lower.x >= camera.width_px ? "to the right" : "";
  const char* const along = upper.y <= 0.0 ? "above" : lower.y >= camera.height_px ? "below" : "";
  if (*across == '\0' && *along == '\0') return "past a corner";
  return std::string(across) + (*across != '\0' && *along != '\0' ? " and " : "") + along;
}

double degrees_off_axis(const Camera& camera, const glm::dvec3& world) {
  const glm::dvec3 from_eye = world - camera.eye;
  const double cosine = -glm::dot(glm::normalize(from_eye), camera.world_from_camera[2]);
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

std::string outside_text(const Outline& outline, const Box& box, const Camera& camera) {
  const std::string side = side_of(outline.hull, camera);
  if (camera.projection == Projection::orthographic) return "lies outside the frame, " + side;
  return fmt::format("lies outside the frame, {}: the camera looks {:.0f} degrees past its middle", side,
                     degrees_off_axis(camera, box.center()));
}

double area_of(const Mesh& mesh) {
  double sum = 0.0;
  size_t first = 0;
  for (const std::int32_t size : mesh.face_sizes) {
    const auto at = [&](size_t k) { return mesh.positions[static_cast<size_t>(mesh.corner_vertices[first + k])]; };
    for (size_t k = 2; k < static_cast<size_t>(size); ++k) sum += 0.5 * glm::length(glm::cross(at(k - 1) - at(0), at(k) - at(0)));
    first += static_cast<size_t>(size);
  }
  return sum;
}

/// Of an object whose surface the model has lost, or never had.
std::string without_surface(const SceneObject& object, const Surface& surface) {
  if (const auto* source = std::get_if<MeshSource>(&object.source)) {
    // Rounding gives a needle some area.
    const double side = bounds(source->mesh).longest_side();
    if (!(area_of(source->mesh) > 1e-12 * side * side))
      return fmt::format("has no area: all {} faces of its mesh are degenerate", source->mesh->face_count());
  }
  if (std::holds_alternative<LevelSetSource>(object.source) && surface.info.voxels == 0) return "holds no surface: its grid is empty";
  if (surface.info.kind.ends_with("level_set") && surface.info.voxels == 0)
    return fmt::format("is lost in its grid: no part of it is as thick as a voxel ({:g})", surface.info.voxel_size);
  return "";
}

/// What a grid's own nodes tell of a surface that is not there.
std::string of_grid(const SceneObject& object) {
  const auto* volume = std::get_if<LevelSetSource>(&object.source);
  const double share = volume != nullptr ? leaked_share(volume->level_set.info().band) : 0.0;
  if (share == 0.0) return "; the signs of its grid may have leaked, or its band may be broken";
  return fmt::format("; {:.0f} % of the surface in its grid has no inside: it leaked out", 100.0 * share);
}

std::string reason_of(const SceneObject& object, const Surface& surface, const Box& box, const Camera& camera) {
  if (const std::string none = without_surface(object, surface); !none.empty()) return none;
  if (box.empty()) return "has no surface";
  if (!box.finite()) return "is unbounded, and no ray of the picture meets it";
  const Outline outline = outline_of(box, camera);
  if (outline.behind) return fmt::format("lies behind the camera, by {:.3g} at least", outline.behind_by);
  if (holds(box, camera.eye)) return "has the camera within its bounds, and no surface in the direction of view";
  const double narrowest = narrowest_width(outline.hull);
  if (outline.framed_px <= 0.0 && narrowest > 0.0) return outside_text(outline, box, camera);
  if (narrowest < 1.0) {
    double longest = 0.0;
    for (const glm::dvec2& a : outline.hull) {
      for (const glm::dvec2& b : outline.hull) longest = std::max(longest, glm::length(a - b));
    }
    return longest < 2.0 ? fmt::format("is smaller than a pixel ({:.2g} px)", longest)
                         : fmt::format("is seen edge-on: {:.0f} px long and {:.2g} px wide", longest, narrowest);
  }
  std::string text = fmt::format("has bounds that cover {:.0f} px of the frame, and no surface there", outline.framed_px);
  if (surface.info.kind.ends_with("level_set")) text += of_grid(object);
  return text;
}

Box world_box(const Surface& surface, const SceneModel& model) {
  Box box = surface.bounds;
  if (box.empty()) return box;
  box.lower += model.render_origin;
  box.upper += model.render_origin;
  return box;
}

/// Pixels that the bounds of all objects cover together, counted as if they did not overlap.
double promised_px(const SceneModel& model, const Camera& camera) {
  const double all = static_cast<double>(camera.width_px) * camera.height_px;
  double sum = 0.0;
  for (const Surface& surface : model.surfaces) {
    const Box box = world_box(surface, model);
    if (!box.empty() && box.finite() && !holds(box, camera.eye)) sum += outline_of(box, camera).framed_px;
  }
  return std::min(sum, all);
}

}  // namespace

std::vector<std::string> why_empty(const Scene& scene, const SceneModel& model, const Camera& camera, const HitCounts& counts) {
  std::vector<std::string> reasons;
  if (counts.hits > 0) {
    const double promised = promised_px(model, camera);
    if (promised < kTooFewToJudge_px || static_cast<double>(counts.hits) >= kFewOfPromised * promised) return {};
    std::string text = fmt::format("next to nothing is hit: {} of the {:.0f} px that the bounds cover", counts.hits, promised);
    for (size_t i = 0; i < std::min(scene.objects.size(), model.surfaces.size()); ++i) {
      if (!model.surfaces[i].info.kind.ends_with("level_set")) continue;
      text += of_grid(scene.objects[i]);
      break;
    }
    reasons.push_back(std::move(text));
    return reasons;
  }
  if (counts.out_of_steps > 0) reasons.push_back(fmt::format("nothing is hit: {} rays ran out of steps", counts.out_of_steps));
  for (size_t i = 0; i < std::min(kMostObjects, scene.objects.size()); ++i) {
    const SceneObject& object = scene.objects[i];
    reasons.push_back(fmt::format("nothing is hit: {} {}", object.name,
                                  reason_of(object, model.surfaces[i], world_box(model.surfaces[i], model), camera)));
  }
  if (scene.objects.size() > kMostObjects)
    reasons.push_back(fmt::format("nothing is hit: the same holds, or alike, of {} more objects", scene.objects.size() - kMostObjects));
  if (scene.objects.empty()) reasons.emplace_back("nothing is hit: there are no objects");
  return reasons;
}

bool says_empty(const std::string& warning) {
  return warning.starts_with("nothing is hit: ") || warning.starts_with("next to nothing is hit: ");
}

}  // namespace limn
