// From a scene to its view graph: curves of every kind of surface, hidden by each other.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/lines/flat_crossings.h"
#include "raymarch/lines/graph_building.h"
#include "raymarch/lines/line_memory.h"
#include "raymarch/lines/missed_contours.h"
#include "raymarch/lines/smoothed_scene.h"
#include "raymarch/scene/threads.h"
#include "raymarch/truth/proxy.h"
#include "sdf/error.h"

namespace limn {
namespace {

constexpr double kViewTurn = 1e-7;
constexpr int kMostSearches = 4;  // for curves, where rays tell of contours that were missed

void check(const LineSettings& settings) {
  const auto fail = [](const std::string& field, double value, const std::string& problem, const std::string& expected) {
    throw InputError({{}, field, fmt::format("{}", value), problem, expected});
  };
  if (!(settings.threshold > 0.0 && settings.threshold < 1.0))
    fail("threshold", settings.threshold, "not a threshold", "above 0 and below 1");
  if (!(settings.tolerance_px > 0.0 && std::isfinite(settings.tolerance_px)))
    fail("tolerance", settings.tolerance_px, "not a tolerance", "above 0 px");
  if (!(settings.crease_angle_deg > 0.0 && settings.crease_angle_deg < 180.0))
    fail("crease_angle", settings.crease_angle_deg, "not an angle between faces", "above 0 and below 180 degrees");
  if (!(settings.suggestive_angle_deg >= 0.0 && settings.suggestive_angle_deg < 90.0))
    fail("suggestive_angle", settings.suggestive_angle_deg, "not an angle between normal and view", "from 0 to below 90 degrees");
  if (!(settings.suggestive_slope >= 0.0 && std::isfinite(settings.suggestive_slope)))
    fail("suggestive_slope", settings.suggestive_slope, "not a derivative of curvature", "a number from 0 up");
  if (!(settings.fairing_edges >= 0.0 && settings.fairing_edges <= 1000.0))
    fail("fair", settings.fairing_edges, "not a number of edges", "a number from 0 to 1000");
  if (settings.fairing_edges > 0.0 && !settings.smooth_meshes &&
      std::none_of(settings.classes.begin(), settings.classes.end(), is_of_curvature))
    fail("fair", settings.fairing_edges, "changes none of these lines", "smooth = true, or lines of curvature, such as suggestive");
  if (!(settings.ridge_strength > 0.0 && std::isfinite(settings.ridge_strength)))
    fail("ridge_strength", settings.ridge_strength, "not a strength", "a number above 0");
}

/// By some hundred-thousandths of a pixel, so that faces seen exactly edge-on face one way and not all ways at once, and lines that lie on
/// each other in the image, as the near and the far edges of what is seen face-on, keep an order that rounding leaves alone.
Camera turned(Camera camera) {
  glm::dmat3& axes = camera.world_from_camera;
  const glm::dvec2 turn = kViewTurn * glm::dvec2(0.8, 0.6);
  if (camera.projection == Projection::perspective) {
    camera.eye += glm::length(camera.eye) * (turn.x * axes[0] + turn.y * axes[1]);
    return camera;
  }
  // What is seen moves with the direction of the rays.
  axes[2] = glm::normalize(axes[2] + turn.x * axes[0] + turn.y * axes[1]);
  axes[0] = glm::normalize(axes[0] - glm::dot(axes[0], axes[2]) * axes[2]);
  axes[1] = glm::cross(axes[2], axes[0]);
  return camera;
}

/// How far turned() moves what is drawn, px: in perspective most what is nearest to the eye.
double turned_px(const Camera& camera, const ViewGraph& graph) {
  double most = 0.0;
  for (const LineEdge& edge : graph.edges) {
    for (const LinePoint& point : edge.points) {
      const bool perspective = camera.projection == Projection::perspective;
      const double way = perspective ? glm::length(camera.eye) : std::abs(point.depth);
      if (point.depth > 0.0 || !perspective) most = std::max(most, kViewTurn * way * pixels_per_unit_at(camera, point.depth));
    }
  }
  return most;
}

/// What is drawn in the place of the scene's meshes.
const Scene& kept_smooth(const Scene& scene, const LineSettings& settings, KeptLines& kept) {
  std::shared_ptr<const SmoothedScene>& smoothed = kept.smoothed;
  if (!smoothed) smoothed = std::make_shared<const SmoothedScene>(smoothed_scene(scene, settings));
  return smoothed->scene;
}

void note_fairing(const LineTask& task, ViewGraph& graph) {
  const double moved = task.kept.smoothed ? task.kept.smoothed->moved : 0.0;
  if (!(moved > 0.0)) return;
  const double depth = std::max(project(task.camera, glm::dvec3(0.0)).z, 1e-9 * task.extent);
  graph.notes.push_back(fmt::format("fairing moved vertices by up to {:.3g}, {:.2g} px in the middle of the scene", moved,
                                    moved * pixels_per_unit_at(task.camera, depth)));
}

LineTask task_of(const Scene& scene, const Camera& camera, const LineSettings& settings, KeptLines& kept) {
  LineTask task{scene, {}, glm::dvec3(0.0), 1.0, {}, kept};
  const Box box = bounds(scene);
  if (box.finite()) task.origin = box.center();
  task.camera = turned(moved(camera, task.origin));
  task.extent = box.finite() && box.radius() > 0.0 ? box.radius() : std::max(1e-6, glm::length(task.camera.eye));
  task.settings = settings;
  if (settings.classes.empty()) {
    for (const LineClassDescriptor& one : line_classes()) {
      if (one.by_default) task.settings.classes.push_back(one.line_class);
    }
  }
  return task;
}

/// Objects by the way their lines are traced.
struct Kinds {
  std::vector<size_t> fields, cages, meshes, level_sets;
};

Kinds kinds_of(const Scene& scene) {
  Kinds kinds;
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    if (std::holds_alternative<Field>(object.source)) {
      kinds.fields.push_back(i);
    } else if (std::holds_alternative<LevelSetSource>(object.source)) {
      kinds.level_sets.push_back(i);
    } else {
      (is_cage(object) ? kinds.cages : kinds.meshes).push_back(i);
    }
  }
  return kinds;
}

std::vector<LineContribution> contributions_of(const LineTask& task, const ExecutionSettings& execution, std::string& from) {
  const Kinds kinds = kinds_of(task.scene);
  std::vector<LineContribution> all;
  const auto add = [&](const std::vector<size_t>& objects, auto&& trace, const char* one, const char* several) {
    if (objects.empty()) return;
    all.push_back(trace(task, objects, execution));
    from += (from.empty() ? "" : " and ") + std::string(objects.size() == 1 ? one : several);
  };
  add(kinds.fields, field_lines, "the field", "the fields");
  add(kinds.cages, cage_lines, "the limit surface", "the limit surfaces");
  add(kinds.meshes, mesh_lines, "the mesh", "the meshes");
  add(kinds.level_sets, level_set_lines, "the level set", "the level sets");
  const bool features = task.wants(LineClass::suggestive) || task.wants(LineClass::ridge) || task.wants(LineClass::valley);
  if (features) all.push_back(feature_lines(task, execution));
  return all;
}

/// What lies in front of a sample, of all objects.
LayersSeen layers_before(const std::vector<LineContribution>& contributions, const CurveSample& sample) {
  LayersSeen all{0, std::numeric_limits<double>::infinity()};
  for (const LineContribution& one : contributions) {
    if (!one.layers_before) continue;
    const LayersSeen layers = one.layers_before(sample);
    all.count += layers.count;
    // NaN where one does not know.
    if (!(layers.nearest >= all.nearest)) all.nearest = layers.nearest;
  }
  return all;
}

/// Curves of all objects, cut where something hides them.
struct FoundLines {
  std::vector<LineContribution> contributions{};  ///< Without their curves.
  std::vector<SurfaceCurve> curves{};
  CutCurves cut{};
  std::string from{};
};

FoundLines find_lines(const LineTask& task, const ExecutionSettings& execution) {
  FoundLines found;
  found.contributions = contributions_of(task, execution, found.from);
  for (LineContribution& one : found.contributions)
    found.curves.insert(found.curves.end(), std::make_move_iterator(one.curves.begin()), std::make_move_iterator(one.curves.end()));
  snap_joints(found.curves, task.camera);
  refine_flat_crossings(found.curves, task.camera);
  const auto layers = [&](const CurveSample& sample) { return layers_before(found.contributions, sample); };
  found.cut = cut_by_invisibility(found.curves, task.camera, task.extent, layers, execution);
  return found;
}

ViewGraph graph_of(FoundLines found, const LineTask& task, const ExecutionSettings& execution) {
  ViewGraph graph;
  graph.from = found.from;
  note_fairing(task, graph);
  double unrefined_px = 0.0;
  for (LineContribution& one : found.contributions) {
    graph.notes.insert(graph.notes.end(), one.notes.begin(), one.notes.end());
    graph.exact = graph.exact && one.exact;
    unrefined_px = std::max(unrefined_px, one.unrefined_px);
  }
  if (execution.progress) execution.progress(0.9);
  add_edges(found.curves, found.cut, task, graph);
  add_chains(graph);
  graph.conflicts = std::move(found.cut.conflicts);
  graph.rays = found.cut.rays;
  // As a rule a hundredth of the tolerance, or less, which the tolerance has room for.
  const double turn_px = turned_px(task.camera, graph);
  graph.bound_px = task.settings.tolerance_px + unrefined_px + (turn_px > 0.1 * task.settings.tolerance_px ? turn_px : 0.0);
  if (execution.progress) execution.progress(1.0);
  return graph;
}

}  // namespace

bool LineTask::wants(LineClass line_class) const {
  return std::find(settings.classes.begin(), settings.classes.end(), line_class) != settings.classes.end();
}

LineClass LineTask::class_of_meeting(int material, int other_material) const {
  const bool edge = material != other_material && wants(LineClass::material) && !wants(LineClass::intersection);
  return edge ? LineClass::material : LineClass::intersection;
}

void project_sample(const Camera& camera, CurveSample& sample) {
  const glm::dvec3 image = project(camera, sample.p);
  sample.px = glm::dvec2(image);
  sample.depth = image.z;
}

ViewGraph solve_lines(const Scene& scene, const Camera& camera, const LineSettings& settings, const ExecutionSettings& execution,
                      LineMemory* memory) {
  check(settings);
  LineMemory own;
  LineMemory& used = memory != nullptr ? *memory : own;
  if (used.kept == nullptr) used.kept = std::make_shared<KeptLines>();
  return ThreadArena(execution.threads).execute([&] {
    LineTask task = task_of(settings.smooth_meshes ? kept_smooth(scene, settings, *used.kept) : scene, camera, settings, *used.kept);
    for (int search = 1;; ++search) {
      FoundLines found = find_lines(task, execution);
      const std::vector<glm::dvec3> missed =
          search < kMostSearches ? missed_contours(found.cut.grazing, found.contributions, found.curves) : std::vector<glm::dvec3>{};
      if (missed.empty()) return graph_of(std::move(found), task, execution);
      task.missed.insert(task.missed.end(), missed.begin(), missed.end());
    }
  });
}

}  // namespace limn
