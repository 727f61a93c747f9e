// Points of a mesh as it will be traced, and of the zero surface of a volume.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "raymarch/audit/facts.h"
#include "raymarch/surface/object_mesh.h"
#include "sdf/level_set_crossings.h"
#include "subdiv/first_hits.h"
#include "subdiv/refine.h"

namespace limn {
namespace {

/// A cage refined so far takes half a second to look at; what is asked for beyond that is looked at coarser, which is said.
constexpr std::int64_t kMostFaces = 1'000'000;
constexpr size_t kMost = 1500;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The refinement that is looked at: the one asked for, as far as it stays cheap.
int affordable_level(const SceneObject& object, const SurfaceSettings& settings) {
  const int asked = object.level.value_or(settings.level);
  const auto& source = std::get<MeshSource>(object.source);
  const std::optional<Scheme> scheme = settings.scheme ? settings.scheme : source.scheme;
  if (!scheme) return asked;
  int level = asked;
  const std::vector<RefinedSize> sizes = predict_refined_sizes(source.mesh, *scheme, asked);
  while (level > 0 && sizes[static_cast<size_t>(level)].faces > kMostFaces) --level;
  return level;
}

glm::dvec3 area_normal(const TriangleMesh& mesh, size_t triangle) {
  const glm::uvec3 t = mesh.triangles[triangle];
  return 0.5 * glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
}

/// How fast the normals turn that are traced: 0 where a triangle has one only.
double bending(const TriangleMesh& mesh, size_t triangle) {
  if (mesh.corner_normals.empty()) return 0.0;
  double most = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const glm::dvec3 a(mesh.corner_normals[3 * triangle + static_cast<size_t>(i)]),
        b(mesh.corner_normals[3 * triangle + static_cast<size_t>(j)]);
    const double length = glm::distance(mesh.positions[mesh.triangles[triangle][i]], mesh.positions[mesh.triangles[triangle][j]]);
    if (length > 0.0) most = std::max(most, glm::distance(a, b) / length);
  }
  return most;
}

}  // namespace

SurfaceSamples sample_mesh(const SceneObject& object, const SurfaceSettings& settings) {
  SurfaceSamples samples;
  const glm::dvec3 center = bounds(object).center();
  SurfaceSettings how = settings;
  how.level = affordable_level(object, settings);
  // On the heap: GCC 12 takes a copy of the variant on the stack for read before it is written.
  const auto own = std::make_unique<SceneObject>(object);
  own->level.reset();
  if (how.level < object.level.value_or(settings.level)) samples.of = fmt::format("the cage refined {} times", how.level);
  const std::shared_ptr<const TriangleMesh> made = object_mesh(*own, how, center).triangles;
  const TriangleMesh& mesh = *made;
  // As --voxels counts: a cage is larger than what it is refined to.
  Box box;
  for (const glm::uvec3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) box = include(box, mesh.positions[t[k]]);
  samples.longest_side = box.longest_side();
  if (mesh.triangles.empty() || !(samples.longest_side > 0.0)) return samples;
  ThinSamples thin = thin_samples(mesh, samples.longest_side, samples.longest_side);
  for (const size_t i : thin.triangles) {
    const glm::uvec3 t = mesh.triangles[i];
    samples.points.push_back((mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0 + center);
    samples.normals.push_back(glm::normalize(area_normal(mesh, i)));
    samples.bending.push_back(bending(mesh, i) * samples.longest_side);
  }
  samples.walls = std::move(thin.walls);
  samples.gaps = std::move(thin.gaps);
  return samples;
}

namespace {

/// Central differences of the interpolant: what every volume has, whatever its band.
std::vector<glm::dvec3> coarse_gradients(const LevelSet& level_set, const std::vector<glm::dvec3>& points, double step) {
  std::vector<glm::dvec3> at, gradients(points.size());
  for (const glm::dvec3& p : points)
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0}) {
        glm::dvec3 beside = p;
        beside[axis] += side * step;
        at.push_back(beside);
      }
  std::vector<double> values(at.size());
  level_set_values(level_set, at, values);
  for (size_t i = 0; i < points.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      const size_t k = 6 * i + 2 * static_cast<size_t>(axis);
      gradients[i][axis] = (values[k + 1] - values[k]) / (2.0 * step);
    }
  return gradients;
}

/// Values at the points moved along their normals.
std::vector<double> values_along(const LevelSet& level_set, const SurfaceSamples& samples, double distance) {
  std::vector<glm::dvec3> at;
  for (size_t i = 0; i < samples.points.size(); ++i) at.push_back(samples.points[i] + distance * samples.normals[i]);
  std::vector<double> values(at.size());
  level_set_values(level_set, at, values);
  return values;
}

std::vector<double> first_return(const LevelSet& level_set, const SurfaceSamples& samples, double voxel, double side) {
  constexpr int kSteps = 16;  // of a quarter of a voxel
  std::vector<double> found(samples.points.size(), kInfinity);
  for (int step = 1; step <= kSteps; ++step) {
    const double distance = 0.25 * step * voxel;
    const std::vector<double> values = values_along(level_set, samples, side * distance);
    for (size_t i = 0; i < found.size(); ++i)
      if (!std::isfinite(found[i]) && side * values[i] < -1e-3 * voxel) found[i] = distance;
  }
  return found;
}

}  // namespace

SurfaceSamples sample_level_set(const SceneObject& object) {
  SurfaceSamples samples;
  const LevelSet& level_set = std::get<LevelSetSource>(object.source).level_set;
  const double voxel = level_set.info().voxel_size;
  const std::vector<glm::dvec3> points = sample_crossings(level_set, kMost);
  const std::vector<glm::dvec3> gradients = coarse_gradients(level_set, points, 0.5 * voxel);
  for (size_t i = 0; i < points.size(); ++i) {
    const double slope = glm::length(gradients[i]);
    if (!(slope > 0.0)) continue;
    samples.points.push_back(points[i]);
    samples.normals.push_back(gradients[i] / slope);
  }
  const std::vector<double> within = values_along(level_set, samples, -voxel), beyond = values_along(level_set, samples, voxel);
  for (size_t i = 0; i < within.size(); ++i) samples.slopes.push_back((beyond[i] - within[i]) / (2.0 * voxel));
  const double scale = std::cbrt(std::abs(glm::determinant(object.world_from_object.linear)));
  for (const double side : {-1.0, 1.0}) {
    std::vector<double>& widths = side < 0.0 ? samples.walls : samples.gaps;
    widths = first_return(level_set, samples, voxel, side);
    for (double& width : widths) width *= scale;
  }
  for (glm::dvec3& point : samples.points) point = object.world_from_object.point(point);
  samples.longest_side = bounds(object).longest_side();
  return samples;
}

}  // namespace limn
