#include "raymarch/surface/view_level.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/surface/model_parts.h"
#include "raymarch/surface/object_mesh.h"
#include "sdf/error.h"
#include "sdf/field.h"
#include "sdf/parallel.h"
#include "subdiv/local_field.h"
#include "subdiv/mesh_distance.h"
#include "subdiv/mesh_level_set.h"
#include "subdiv/tessellate.h"

namespace limn {
namespace {

constexpr int kFinest = 8;
// What is left beyond a level is guessed from the steps before. A guess this much below what is asked for holds; a nearer one is held
// against the next step.
constexpr double kSurely = 0.67;
// Triangles smaller than that are finer than any border that is measured.
constexpr double kMostTrianglesPerPixel = 4.0;

/// Where a mesh is seen: the largest scale at which any of the pictures shows a point; 0 where none does.
struct Pictures {
  std::span<const Camera> cameras;

  double pixels_per_unit(const glm::dvec3& world) const {
    double largest = 0.0;
    for (const Camera& camera : cameras) {
      const glm::dvec3 at = project(camera, world);
      if (camera.projection == Projection::perspective && !(at.z > 0.0)) continue;
      constexpr double kAside_px = 2.0;  // what lies just outside shows its edges inside
      const glm::dvec2 last = glm::dvec2(camera.width_px, camera.height_px) + kAside_px;
      if (at.x >= -kAside_px && at.y >= -kAside_px && at.x <= last.x && at.y <= last.y)
        largest = std::max(largest, pixels_per_unit_at(camera, at.z));
    }
    return largest;
  }
  double pixels() const {
    double sum = 0.0;
    for (const Camera& camera : cameras) sum += static_cast<double>(camera.width_px) * camera.height_px;
    return sum;
  }
};

/// The largest of value(i, largest so far) over 0 .. count - 1, where make_value() gives a function of one thread's own; what is no larger
/// than the largest so far need not be known.
template <class MakeValue>
double largest_of(size_t count, const MakeValue& make_value) {
  return parallel_reduce(
      count, size_t{256}, 0.0,
      [&](const IndexRange<size_t>& part, double largest) {
        auto value = make_value();
        for (size_t i = part.begin(); i != part.end(); ++i) largest = std::max(largest, value(i, largest));
        return largest;
      },
      [](double a, double b) { return std::max(a, b); });
}

std::span<const std::int32_t> corners_of(const Mesh& mesh, const std::vector<std::int32_t>& first, size_t face) {
  return std::span(mesh.corner_vertices).subspan(static_cast<size_t>(first[face]), static_cast<size_t>(mesh.face_sizes[face]));
}

/// From a point to a face, as a fan of triangles.
double distance_to_face(const Mesh& mesh, std::span<const std::int32_t> corners, const glm::dvec3& point) {
  const auto at = [&](size_t k) { return mesh.positions[static_cast<size_t>(corners[k])]; };
  double nearest = std::numeric_limits<double>::infinity();
  for (size_t k = 2; k < corners.size(); ++k)
    nearest = std::min(nearest, glm::length(point - closest_on_triangle(point, at(0), at(k - 1), at(k))));
  return nearest;
}

/// Of a refinement's faces the parents, which lie in the same order: a face becomes as many as it has corners, a triangle of Loop's four.
std::vector<size_t> parents_of(const Mesh& coarse, const Mesh& fine, Scheme scheme) {
  std::vector<size_t> parents;
  parents.reserve(fine.face_count());
  for (size_t face = 0; face < coarse.face_count(); ++face) {
    const int children = scheme == Scheme::loop ? 4 : coarse.face_sizes[face];
    parents.insert(parents.end(), static_cast<size_t>(children), face);
  }
  LIMN_CHECK(parents.size() == fine.face_count());
  return parents;
}

/// Of the finer mesh's vertices from the coarser one's faces, pixels.
double step_px(const Mesh& coarse, const Mesh& fine, Scheme scheme, const Pictures& pictures) {
  const std::vector<std::int32_t> first_coarse = first_corners(coarse), first_fine = first_corners(fine);
  const std::vector<size_t> parents = parents_of(coarse, fine, scheme);
  // Around vertices of many faces points slide along the surface, out of their parents: then the closest of all faces counts.
  const ClosestPointQuery closest(triangulate(coarse, NormalKind::flat));
  return largest_of(fine.face_count(), [&] {
    return [&](size_t face, double largest) {
      for (const std::int32_t vertex : corners_of(fine, first_fine, face)) {
        const glm::dvec3 point = fine.positions[static_cast<size_t>(vertex)];
        const double scale = pictures.pixels_per_unit(point);
        if (scale == 0.0) continue;
        const double from_parent = scale * distance_to_face(coarse, corners_of(coarse, first_coarse, parents[face]), point);
        if (from_parent > largest) largest = std::max(largest, std::min(from_parent, scale * closest.closest(point).distance));
      }
      return largest;
    };
  });
}

/// What was guessed on the way to a level, on the safe side, is known once it is there: a coarser one stands off by no more than the steps
/// up to the finer and what is left from there.
ViewLevel coarsest_within(const std::vector<double>& steps, double rest, double tolerance_px) {
  size_t level = steps.size();
  for (; level > 0 && steps[level - 1] + rest <= tolerance_px; --level) rest += steps[level - 1];
  return {static_cast<int>(level), rest, {}};
}

/// `source` in the world: subdivision commutes with affine maps.
ViewLevel level_of_cage(const MeshSource& source, Scheme scheme, const SurfaceSettings& settings, const Pictures& pictures,
                        double tolerance_px) {
  RefineSettings how{.scheme = scheme, .level = 0, .normals = NormalKind::flat, .max_bytes = settings.max_bytes};
  Mesh coarse = refine(source.mesh, how, source.file);
  std::vector<double> steps;  // from each level to the next
  double rest = std::numeric_limits<double>::infinity();
  const auto limited = [&](const char* reason) {
    return rest <= tolerance_px ? coarsest_within(steps, rest, tolerance_px) : ViewLevel{how.level - 1, rest, reason};
  };
  for (how.level = 1; how.level <= kFinest; ++how.level) {
    const RefinedSize size = predict_refined_size(source.mesh, scheme, how.level);
    if (size.bytes > settings.max_bytes) return limited("a finer one would not fit into memory");
    if (2.0 * static_cast<double>(size.faces) > kMostTrianglesPerPixel * std::max(pictures.pixels(), 1e4))
      return limited("a finer one would have more than four triangles a pixel");
    Mesh fine = refine(source.mesh, how, source.file);
    const double step = step_px(coarse, fine, scheme, pictures);
    // Fourfold at best; at the first step, when nothing is known, twofold.
    const double ratio = !steps.empty() && steps.back() > 0.0 ? std::clamp(step / steps.back(), 0.25, 0.9) : 0.5;
    rest = step * ratio / (1.0 - ratio);
    steps.push_back(step);
    if (rest <= kSurely * tolerance_px) return coarsest_within(steps, rest, tolerance_px);
    coarse = std::move(fine);
  }
  return limited("it is the finest level");
}

/// The middles of faces, and of their edges.
std::vector<glm::dvec3> middles_of(const Mesh& mesh) {
  const std::vector<std::int32_t> first = first_corners(mesh);
  std::vector<glm::dvec3> middles(mesh.face_count() + mesh.corner_vertices.size());
  parallel_for(size_t{0}, mesh.face_count(), [&](size_t face) {
    const std::span<const std::int32_t> corners = corners_of(mesh, first, face);
    const auto at = [&](size_t k) { return mesh.positions[static_cast<size_t>(corners[k % corners.size()])]; };
    glm::dvec3* const edges = &middles[mesh.face_count() + static_cast<size_t>(first[face])];
    glm::dvec3& middle = middles[face] = glm::dvec3(0.0);
    for (size_t k = 0; k < corners.size(); ++k) {
      middle += at(k) / static_cast<double>(corners.size());
      edges[k] = 0.5 * (at(k) + at(k + 1));
    }
  });
  return middles;
}

/// Of a tessellated field at the middles of its faces and edges, pixels; distances to first order.
double field_deviation_px(const Field& field, const Mesh& mesh, const Pictures& pictures) {
  const std::vector<glm::dvec3> points = middles_of(mesh);
  std::vector<double> deviations(points.size());  // at first pixels for each world unit
  parallel_for(size_t{0}, points.size(), [&](size_t i) { deviations[i] = pictures.pixels_per_unit(points[i]); });
  std::vector<std::uint32_t> seen;
  for (size_t i = 0; i < points.size(); ++i)
    if (deviations[i] > 0.0) seen.push_back(static_cast<std::uint32_t>(i));
  visit_groups(field, points, std::vector<double>(points.size()), std::move(seen),
               [&](LocalField& local, std::span<const std::uint32_t> members) {
                 const std::vector<double> off = local.distances_off(members_of(points, members));
                 for (size_t k = 0; k < members.size(); ++k) deviations[members[k]] *= off[k];
               });
  return deviations.empty() ? 0.0 : *std::max_element(deviations.begin(), deviations.end());
}

/// `pictures` are those of cameras in render space. The last mesh is that of the level, which the model takes where it is kept.
ViewLevel level_of_field(const Field& source, SurfaceSettings settings, const glm::dvec3& render_origin, const Pictures& pictures,
                         double tolerance_px) {
  SceneObject object{.name = "field", .source = source};
  const Field field = translate(source, -render_origin);
  if (!settings.kept_start) settings.kept_start = std::make_shared<KeptStart>();
  double before = std::numeric_limits<double>::infinity();
  for (int level = 0;; ++level) {
    object.level = level;
    const std::shared_ptr<const Polygons> polygons = object_mesh(object, settings, render_origin).polygons;
    const double deviation = field_deviation_px(field, polygons->mesh(), pictures);
    if (deviation <= tolerance_px) return {level, deviation, {}};
    const double next = 4.0 * static_cast<double>(polygons->mesh().face_count());
    if (level == kFinest) return {level, deviation, "it is the finest level"};
    if (predict_refined_size(mesh_of(*settings.kept_start->cage), Scheme::bilinear, level + 1).bytes > settings.max_bytes)
      return {level, deviation, "a finer one would not fit into memory"};
    if (2.0 * next > kMostTrianglesPerPixel * std::max(pictures.pixels(), 1e4))
      return {level, deviation, "a finer one would have more than four triangles a pixel"};
    // As at sharp edges that no vertex lies on.
    if (level >= 4 && deviation > 0.8 * before) return {level, deviation, "a finer one is hardly nearer"};
    before = deviation;
  }
}

}  // namespace

ViewLevel level_for_views(const SceneObject& object, const SurfaceSettings& settings, std::span<const Camera> cameras, double deviation_px,
                          const glm::dvec3& render_origin) {
  LIMN_CHECK(deviation_px > 0.0 && !cameras.empty());
  if (const Field* const field = std::get_if<Field>(&object.source)) {
    std::vector<Camera> in_render(cameras.begin(), cameras.end());
    for (Camera& camera : in_render) camera = moved(camera, render_origin);
    return level_of_field(*field, settings, render_origin, {in_render}, deviation_px);
  }
  const MeshSource* source = std::get_if<MeshSource>(&object.source);
  const std::optional<Scheme> scheme = !source ? std::nullopt : settings.scheme ? settings.scheme : source->scheme;
  if (!scheme) return {};
  Mesh in_world = source->mesh;
  for (glm::dvec3& position : in_world.positions) position = object.world_from_object.point(position);
  return level_of_cage({std::move(in_world), source->scheme, source->file}, *scheme, settings, {cameras}, deviation_px);
}

namespace {

bool has_levels(const SceneObject& object, const SurfaceSettings& settings) {
  const MeshSource* source = std::get_if<MeshSource>(&object.source);
  const bool refined = std::holds_alternative<Field>(object.source) || (source && (source->scheme || settings.scheme));
  const std::vector<std::string>& read = find_surface(settings.kind.empty() ? natural_surface(object) : settings.kind).settings;
  return refined && std::find(read.begin(), read.end(), "level") != read.end();
}

}  // namespace

std::vector<std::string> refine_for_views(const SurfaceSettings& settings, std::span<const Camera> cameras, Scene& scene,
                                          ObjectMeshCache* cache) {
  std::vector<std::string> notes;
  const glm::dvec3 render_origin = render_origin_of(scene);
  if (cache) make_places(scene, *cache);
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    SceneObject& object = scene.objects[i];
    if (!has_levels(object, settings)) continue;
    SurfaceSettings own = settings;
    if (cache) own.kept_start = cache->starts[i], own.kept_mesh = &cache->kept[i];
    const ViewLevel chosen = level_for_views(object, own, cameras, kViewDeviation_px, render_origin);
    object.level = chosen.level;
    // At level 0 nothing was compared.
    const std::string deviation = std::isfinite(chosen.deviation_px) ? fmt::format("{:.2g} px from its surface", chosen.deviation_px)
                                                                     : "at an unknown distance from its surface";
    notes.push_back(
        fmt::format("level {} for '{}': {}{}{}", chosen.level, object.name, deviation, chosen.limit.empty() ? "" : "; ", chosen.limit));
  }
  return notes;
}

}  // namespace limn
