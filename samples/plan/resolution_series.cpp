// Which representations have a resolution to choose, and what theory says of each.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "raymarch/surface/model_parts.h"
#include "raymarch/surface/object_mesh.h"
#include "samples/experiment/cost.h"
#include "samples/plan/plan.h"
#include "sdf/error.h"
#include "subdiv/tessellate.h"

namespace limn {
namespace {

// Voxels grow by the square root of two from candidate to candidate, levels halve the edges.
const std::vector<int> kVoxelCandidates = {16, 23, 32, 45, 64, 91, 128, 181, 256, 362, 512, 724, 1024};
const std::vector<int> kLevelCandidates = {0, 1, 2, 3, 4, 5, 6};

// Angle = constant (curvature size)^order. Meshes with limit normals: the interpolated normal leaves the true one by the change of
// curvature within a face.
constexpr double kMeshConstant = 0.08;

/// What is as fine everywhere takes about as much while it is built as afterwards: beyond the budget there is nothing to build. But for
/// level sets of meshes: the mesh may be larger than they are.
std::int64_t most_bytes(const ResolutionSeries& series, const PlanSettings& settings) {
  const bool by_mesh = series.settings.kind == "mesh_level_set";
  return settings.budget_bytes && !by_mesh ? std::min(settings.max_bytes, *settings.budget_bytes) : settings.max_bytes;
}

/// A gradient of first order never makes up for its voxels.
bool is_tried(const GradientDescriptor& gradient) { return gradient.order > 1 && gradient.normal_constant > 0.0; }

bool wanted(const std::string& kind, const PlanSettings& settings) {
  return settings.kinds.empty() || std::find(settings.kinds.begin(), settings.kinds.end(), kind) != settings.kinds.end();
}

bool all_support(const Scene& scene, const char* kind) {
  return std::all_of(scene.objects.begin(), scene.objects.end(),
                     [&](const SceneObject& object) { return find_surface(kind).unsupported(object).empty(); });
}

/// Objects that are models already and cannot be made finer: volumes, and meshes that are no cages.
bool is_fixed(const SceneObject& object) {
  if (std::holds_alternative<LevelSetSource>(object.source)) return true;
  const auto* mesh = std::get_if<MeshSource>(&object.source);
  return mesh != nullptr && !mesh->scheme;
}

double mean_edge(const Mesh& mesh, const Affine& world_from_mesh) {
  double sum = 0.0;
  std::int64_t count = 0;
  size_t first = 0;
  for (const std::int32_t size : mesh.face_sizes) {
    for (size_t k = 0; k < static_cast<size_t>(size); ++k) {
      const auto vertex = [&](size_t corner) {
        return world_from_mesh.point(mesh.positions[static_cast<size_t>(mesh.corner_vertices[first + corner % static_cast<size_t>(size)])]);
      };
      sum += glm::distance(vertex(k), vertex(k + 1));
      ++count;
    }
    first += static_cast<size_t>(size);
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

/// What the first candidate is expected to take to build.
double first_ms(const ResolutionSeries& series, const SceneSize& size) { return expected_cost(size, series.at(0), 0.0).build_ms; }

/// The longest of the objects' mean edges at level 0, since that one shows first, and what finding the cages took.
void measure_cages(const Scene& scene, SceneSize& size, ResolutionSeries& series, ObjectMeshCache& cache) {
  series.base_size = 0.0;
  const glm::dvec3 render_origin = render_origin_of(scene);
  make_places(scene, cache);
  double spared_ms = 0.0;
  const auto start = std::chrono::steady_clock::now();
  for (size_t k = 0; k < scene.objects.size(); ++k) {
    const SceneObject& object = scene.objects[k];
    if (const auto* field = std::get_if<Field>(&object.source)) {
      const std::shared_ptr<const FieldCage> cage =
          kept_cage(translate(*field, -render_origin), render_origin, cache.starts[k].get(), spared_ms);
      series.base_size = std::max(series.base_size, mean_edge(mesh_of(*cage), {}));
      size.objects[k].faces = static_cast<double>(mesh_of(*cage).face_count());
      size.objects[k].refines = true;
    } else if (const auto* mesh = std::get_if<MeshSource>(&object.source)) {
      series.base_size = std::max(series.base_size, mean_edge(mesh->mesh, object.world_from_object));
    }
  }
  series.fixed_ms = spared_ms + std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  series.guess_ms = std::max(series.fixed_ms, first_ms(series, size));
}

ResolutionSeries mesh_series(const Scene& scene, SceneSize size, ObjectMeshCache& cache) {
  ResolutionSeries series;
  series.title = "mesh, limit normals";
  series.settings.kind = "mesh";
  series.settings.normals = NormalKind::limit;
  series.by_level = true;
  series.candidates = kLevelCandidates;
  series.normal_constant = kMeshConstant;
  measure_cages(scene, size, series, cache);
  return series;
}

// The grid shall be what is measured: the mesh that goes into it is finer than any voxel that matters.
constexpr int kMeshLevel = 5;

ResolutionSeries grid_series(const char* kind, const GradientDescriptor& gradient, const SceneSize& size, double longest_side) {
  ResolutionSeries series;
  series.title = fmt::format("{}, {} gradient", std::string(kind) == "level_set" ? "level set" : "mesh as level set", gradient.about.name);
  series.settings.kind = kind;
  series.settings.gradient = gradient.about.name;
  series.settings.level = kMeshLevel;
  series.candidates = kVoxelCandidates;
  series.normal_order = gradient.order;
  series.normal_constant = gradient.normal_constant;
  series.base_size = longest_side;
  series.guess_ms = first_ms(series, size);
  return series;
}

/// Along the longest side of the object that has most.
int own_voxels(const Scene& scene) {
  double most = 0.0;
  for (const SceneObject& object : scene.objects) {
    const Affine& map = std::get<LevelSetSource>(object.source).level_set.info().world_from_index;
    const glm::dmat3 axes = object.world_from_object.linear * map.linear;
    const double voxel = std::min({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
    most = std::max(most, bounds(object).longest_side() / voxel);
  }
  return static_cast<int>(std::lround(most));
}

/// How coarse may this grid be? The file is the finest; with any gradient, since bands are made as wide as that needs.
std::vector<ResolutionSeries> volume_series(const Scene& scene, const SceneSize& size, const PlanSettings& settings, double longest_side) {
  std::vector<ResolutionSeries> all_series;
  const bool only_volumes = std::all_of(scene.objects.begin(), scene.objects.end(),
                                        [](const SceneObject& object) { return std::holds_alternative<LevelSetSource>(object.source); });
  if (!only_volumes || !wanted("level_set", settings)) return all_series;
  const int own = own_voxels(scene);
  for (const GradientDescriptor& gradient : gradients()) {
    if (!is_tried(gradient)) continue;
    ResolutionSeries series = grid_series("level_set", gradient, size, longest_side);
    series.of_file = true;
    std::erase_if(series.candidates, [&](int voxels) { return 1.2 * voxels > own; });
    series.candidates.push_back(own);
    all_series.push_back(std::move(series));
  }
  return all_series;
}

}  // namespace

double ResolutionSeries::size_at(size_t candidate) const {
  // Chords stand off by the square of an edge.
  if (by_tolerance) return std::sqrt(1000.0 / candidates[candidate]);
  return by_level ? base_size / std::exp2(candidates[candidate]) : base_size / candidates[candidate];
}

SurfaceSettings ResolutionSeries::at(size_t candidate) const {
  SurfaceSettings own = settings;
  if (by_tolerance) return own;
  (by_level ? own.level : own.voxels) = candidates[candidate];
  own.resample_volumes = of_file && candidate + 1 < candidates.size();
  return own;
}

std::string ResolutionSeries::words_at(size_t candidate) const {
  if (by_tolerance) return fmt::format("{:.3g} px", 1000.0 / candidates[candidate]);
  if (of_file && candidate + 1 == candidates.size()) return fmt::format("the file's own {} voxels", candidates[candidate]);
  return by_level ? fmt::format("level {}", candidates[candidate]) : fmt::format("{} voxels", candidates[candidate]);
}

double BorderErrors::of(PlanMetric metric) const { return metric == PlanMetric::silhouette ? silhouette_px : border_px; }

std::vector<ResolutionSeries> series_of_scene(const Scene& scene, const PlanSettings& settings, std::vector<std::string>* notes,
                                              ObjectMeshCache* cache) {
  std::vector<ResolutionSeries> all_series;
  const bool fixed = std::any_of(scene.objects.begin(), scene.objects.end(), is_fixed);
  const bool volumes = std::any_of(scene.objects.begin(), scene.objects.end(),
                                   [](const SceneObject& object) { return std::holds_alternative<LevelSetSource>(object.source); });
  double longest_side = 0.0;
  for (const SceneObject& object : scene.objects) longest_side = std::max(longest_side, bounds(object).longest_side());
  if (scene.objects.empty() || !std::isfinite(longest_side)) return all_series;
  // Without the cages of fields, which only the mesh's series needs, and takes the time to find.
  const SceneSize size = size_of(scene, {}, false);
  if (volumes) {
    all_series = volume_series(scene, size, settings, longest_side);
    for (ResolutionSeries& series : all_series) series.settings.max_bytes = most_bytes(series, settings);
    return all_series;
  }
  if (!fixed && wanted("mesh", settings) && all_support(scene, "mesh")) {
    try {
      ObjectMeshCache own;
      all_series.push_back(mesh_series(scene, size, cache ? *cache : own));
    } catch (const InputError& error) {
      // A shape that cannot be tessellated may still be a level set.
      if (notes) notes->push_back(fmt::format("mesh left out: {}", error.fault().problem));
    }
  }
  for (const char* kind : {"level_set", "mesh_level_set"}) {
    // A field goes into a grid as it is; by way of a mesh it would only lose.
    const bool detour = std::string(kind) == "mesh_level_set" && all_support(scene, "level_set");
    if (!wanted(kind, settings) || !all_support(scene, kind) || (detour && settings.kinds.empty())) continue;
    for (const GradientDescriptor& gradient : gradients()) {
      if (is_tried(gradient)) all_series.push_back(grid_series(kind, gradient, size, longest_side));
    }
  }
  for (ResolutionSeries& series : all_series) series.settings.max_bytes = most_bytes(series, settings);
  return all_series;
}

}  // namespace limn
