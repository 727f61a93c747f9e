#include "samples/experiment/cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/level_set/level_set_marcher.h"
#include "raymarch/surface/model_parts.h"
#include "raymarch/surface/object_mesh.h"
#include "samples/input/scene_facts.h"
#include "samples/output/output.h"
#include "sdf/error.h"
#include "sdf/field_program.h"
#include "sdf/level_set.h"
#include "sdf/local_grid.h"
#include "sdf/tape.h"
#include "subdiv/mesh_audit.h"
#include "subdiv/tessellate.h"

namespace limn {
namespace {

// Milliseconds and bytes of the parts, fitted to the built-in scenes, cages, scans and .vm files on two cores of an Intel Xeon of 2023 with
// AVX-512: most are right to a factor of two there. Memory is what building takes, not what is left of it.
constexpr double kModelMs = 1.0, kFaceMs = 3e-4, kFieldFaceMs = 6e-4, kFieldFaceFormulaMs = 3.6e-4, kFaceBytes = 600.0;
constexpr double kCageFaceMs = 0.025, kCagePartMs = 8.0;  // of a field's cage: samplings, and creases between parts
constexpr double kResampleMs = 1e-3;                      // a voxel of either grid
constexpr double kVoxelMs = 3.8e-5, kMeshVoxelMs = 1.1e-4, kMeshVoxelFaceMs = 1.1e-3, kGridBytes = 1.7e6;
// More where the winding number tells what is inside: all over, and along the rims of holes by voxels of the longest side.
constexpr double kHoleVoxelMs = 6e-5, kHoleSideMs = 0.35;
// Peaks of ellipsoid and gyroid, 256 to 1024 voxels, bands of 2.45 to 8: blocks of 8^3 go by the surface, the grid that stays by the band.
constexpr double kVoxelBytes = 9.6, kSurfaceCellBytes = 107.0, kVoxelPartBytes = 0.07;
constexpr double kPictureMs = 0.5, kMeshRayMs = 2.5e-6, kDrawnFaceMs = 4e-5, kGridRayMs = 6e-6, kFieldRayMs = 5e-6;
// At 640x360; a limit surface, or a mesh as it was loaded, has as much to look through as a field's cage of so many faces.
constexpr double kTruthFaceMs = 0.035, kLimitFaces = 1100.0, kLoadedFaces = 2500.0, kBorderMs = 0.75;
/// What a further part adds to a field's cost, as a share of the first: most are skipped by bounds.
constexpr double kPartShare = 0.012;
/// Expected milliseconds that a kind of work must have done before its own speed counts more than what was thought of it.
constexpr double kTrustMs = 200.0;

double area_of(const Mesh& mesh) {
  double area = 0.0;
  size_t first = 0;
  for (const std::int32_t size : mesh.face_sizes) {
    const auto at = [&](size_t corner) { return mesh.positions[static_cast<size_t>(mesh.corner_vertices[first + corner])]; };
    for (size_t i = 2; i < static_cast<size_t>(size); ++i) area += 0.5 * glm::length(glm::cross(at(i - 1) - at(0), at(i) - at(0)));
    first += static_cast<size_t>(size);
  }
  return area;
}

bool has_holes(const Mesh& mesh) {
  const Edges edges = build_edges(mesh);
  return std::any_of(edges.begin(), edges.end(), [](const Edge& edge) { return edge.face_count == 1; });
}

/// By Cauchy and Crofton's formula: on average an edge of a lattice is crossed as often as its share of the area, 2/3 of it an axis.
double area_of(const Field& field) {
  constexpr int kCells = 32;
  const Box box = dilate(field.traits().bounds, 1e-3 * field.traits().bounds.longest_side());
  const double cell = box.longest_side() / kCells;
  const glm::ivec3 count = glm::ivec3(glm::ceil(box.size() / cell)) + 1;
  FieldEvaluator evaluator(field);
  std::vector<glm::dvec3> sheet;
  std::vector<double> values, before;
  double crossings = 0.0;
  for (int x = 0; x < count.x; ++x) {
    sheet.clear();
    for (int y = 0; y < count.y; ++y)
      for (int z = 0; z < count.z; ++z) sheet.push_back(box.lower + cell * glm::dvec3(x, y, z));
    values.resize(sheet.size());
    evaluator.values(sheet, values);
    const auto differ = [&](double a, double b) { return (a < 0.0) != (b < 0.0) ? 1.0 : 0.0; };
    for (size_t i = 0; i < values.size(); ++i) {
      if (x > 0) crossings += differ(values[i], before[i]);
      if ((i + 1) % static_cast<size_t>(count.z) != 0) crossings += differ(values[i], values[i + 1]);
      if (i + static_cast<size_t>(count.z) < values.size()) crossings += differ(values[i], values[i + static_cast<size_t>(count.z)]);
    }
    std::swap(values, before);
  }
  return crossings * cell * cell / 1.5;
}

/// How long a step of a formula takes, of an addition as 1.
double weight_of(TapeOperation operation) {
  switch (operation) {
    case TapeOperation::norm2:
    case TapeOperation::norm3:
      return 2.0;
    case TapeOperation::smooth_minimum:
    case TapeOperation::smooth_maximum:
      return 4.0;
    case TapeOperation::sine:
    case TapeOperation::cosine:
      return 5.0;
    case TapeOperation::power_norm:
    case TapeOperation::shape:
      return 14.0;
    default:
      return 1.0;
  }
}

void count_formula(const Field& field, SceneSize::Object& size) {
  constexpr double kOfEllipsoid = 9.0;
  const FieldTape tape(field);
  size.parts = std::max(1.0, static_cast<double>(tape.leaves.size()));
  double sum = 0.0;
  for (const TapeStep& step : tape.steps) sum += weight_of(step.operation);
  size.formula = sum / size.parts / kOfEllipsoid;
}

/// `start`: of the object, about `render_origin`; may be null.
SceneSize::Object size_of(const SceneObject& object, const SurfaceSettings& settings, bool with_cages, const glm::dvec3& render_origin,
                          KeptStart* start) {
  SceneSize::Object size;
  const Box box = bounds(object);
  if (box.finite()) size.longest_side = box.longest_side();
  if (const auto* field = std::get_if<Field>(&object.source)) {
    size.is_field = true;
    count_formula(*field, size);
    if (!box.finite() || box.empty()) return size;
    size.refines = true;
    if (!with_cages) {
      size.area = area_of(*field);
      return size;
    }
    try {
      double spared_ms = 0.0;
      const std::shared_ptr<const FieldCage> cage = kept_cage(translate(*field, -render_origin), render_origin, start, spared_ms);
      size.faces = static_cast<double>(mesh_of(*cage).face_count());
      size.area = area_of(mesh_of(*cage));
    } catch (const InputError& error) {
      size.refines = false;
      size.area = area_of(*field);
      size.cannot_mesh = fmt::format("{} cannot be tessellated: {}", object.name, error.fault().problem);
    }
  } else if (const auto* source = std::get_if<MeshSource>(&object.source)) {
    const double scale = std::cbrt(std::abs(glm::determinant(object.world_from_object.linear)));
    const std::optional<Scheme> scheme = cage_scheme(object, settings);
    size.refines = scheme.has_value();
    size.faces = scheme ? static_cast<double>(predict_refined_size(source->mesh, *scheme, 1).faces) / 4.0
                        : static_cast<double>(source->mesh->face_count());
    size.area = scale * scale * area_of(source->mesh);
    size.has_holes = settings.kind != "mesh" && settings.kind != "analytic" && has_holes(source->mesh);
  } else {
    const auto& volume = std::get<LevelSetSource>(object.source);
    const LevelSetInfo& info = volume.level_set.info();
    size.own_voxels = static_cast<double>(info.active_voxels);
    if (const LocalVolume* const local = local_volume(volume.level_set))
      for (const LevelSet& larger : local->larger) size.own_voxels += static_cast<double>(larger.info().active_voxels);
    size.area = size.own_voxels * info.voxel_size * info.voxel_size / (2.0 * std::max(info.half_width_voxels, 1.0));
    size.faces = 2.0 * size.own_voxels / (2.0 * std::max(info.half_width_voxels, 1.0));
  }
  return size;
}

double faces_of(const SceneSize::Object& object, int level) { return object.refines ? object.faces * std::pow(4.0, level) : object.faces; }

double voxel_of(const SceneSize::Object& object, const SurfaceSettings& settings) {
  return settings.voxel_size > 0.0 ? settings.voxel_size : object.longest_side / settings.voxels;
}

double voxels_of(const SceneSize::Object& object, const SurfaceSettings& settings, double half_width) {
  if (object.longest_side <= 0.0) return 0.0;
  const double voxel = voxel_of(object, settings);
  // Of a grid this coarse most of the box is band.
  const double side = object.longest_side / voxel + 2.0 * half_width;
  return std::min(2.0 * half_width * object.area / (voxel * voxel), side * side * side);
}

/// What the field costs, of an ellipsoid as 1.
double formula_cost(const SceneSize::Object& object) { return object.formula * (1.0 + kPartShare * (object.parts - 1.0)); }

void add_mesh(const SceneSize::Object& object, const SurfaceSettings& settings, double pixels, bool traced, ExpectedCost& cost) {
  const double faces = faces_of(object, settings.level);
  if (object.is_field) cost.build_ms += kCageFaceMs * object.faces + kCagePartMs * (object.parts - 1.0);
  cost.build_ms += kModelMs + faces * (object.is_field ? kFieldFaceMs + kFieldFaceFormulaMs * formula_cost(object) : kFaceMs);
  cost.bytes += static_cast<std::int64_t>(faces * kFaceBytes);
  if (traced) cost.trace_ms += pixels * kMeshRayMs + faces * kDrawnFaceMs;
}

void add_grid(const SceneSize::Object& object, const SurfaceSettings& settings, double pixels, double voxel_ms, ExpectedCost& cost) {
  const GradientDescriptor& gradient = find_gradient(settings.gradient);
  const double half_width = std::max(settings.half_width_voxels, std::max(gradient.half_width_voxels, 1.8));
  const bool loaded = object.own_voxels > 0.0 && !settings.resample_volumes;
  const double voxels = loaded ? object.own_voxels : voxels_of(object, settings, half_width);
  if (!loaded) cost.build_ms += kModelMs + voxels * voxel_ms;
  if (!loaded && object.own_voxels > 0.0) cost.build_ms += kResampleMs * (voxels + object.own_voxels);
  const double voxel_bytes =
      kVoxelBytes + kSurfaceCellBytes / (2.0 * half_width) + (object.is_field ? kVoxelPartBytes * object.parts : 0.0);
  cost.bytes += static_cast<std::int64_t>(kGridBytes + voxels * voxel_bytes);
  cost.trace_ms += pixels * kGridRayMs * (gradient.order >= 3 ? 1.5 : 1.0);
}

}  // namespace

SceneSize size_of(const Scene& scene, const SurfaceSettings& settings, bool with_cages, ObjectMeshCache* cache) {
  const glm::dvec3 render_origin = render_origin_of(scene);
  if (cache) make_places(scene, *cache);
  SceneSize size;
  for (size_t i = 0; i < scene.objects.size(); ++i)
    size.objects.push_back(size_of(scene.objects[i], settings, with_cages, render_origin, cache ? cache->starts[i].get() : nullptr));
  return size;
}

double border_faces(const SceneSize& size) {
  double of_fields = 0.0, of_others = 0.0;
  for (const SceneSize::Object& object : size.objects) {
    if (object.is_field)
      of_fields += object.faces;
    else
      of_others = std::max(of_others, object.refines ? kLimitFaces : kLoadedFaces);
  }
  return of_fields + of_others;
}

double faces_at_level(const SceneSize& size, int level) {
  double faces = 0.0;
  for (const SceneSize::Object& object : size.objects) faces += object.refines ? faces_of(object, level) : 0.0;
  return faces;
}

ExpectedCost expected_cost(const SceneSize& size, const SurfaceSettings& settings, double pixels) {
  ExpectedCost cost;
  cost.trace_ms = kPictureMs;
  // Rays that pass an object by cost little: the picture is shared by the objects.
  const double share = pixels / std::max<double>(1.0, std::sqrt(static_cast<double>(size.objects.size())));
  for (const SceneSize::Object& object : size.objects) {
    std::string kind = settings.kind;
    if (kind.empty()) kind = object.own_voxels > 0.0 ? "level_set" : object.faces > 0.0 ? "mesh" : "analytic";
    if (kind == "analytic") cost.trace_ms += share * kFieldRayMs * formula_cost(object);
    if (kind == "mesh") add_mesh(object, settings, share, true, cost);
    if (kind == "level_set") add_grid(object, settings, share, kVoxelMs * formula_cost(object), cost);
    if (kind == "mesh_level_set") {
      SceneSize::Object remeshed = object;
      remeshed.own_voxels = 0.0;
      add_mesh(object, settings, share, false, cost);
      cost.build_ms += kMeshVoxelFaceMs * faces_of(object, settings.level);
      if (object.has_holes && object.longest_side > 0.0) cost.build_ms += kHoleSideMs * object.longest_side / voxel_of(object, settings);
      add_grid(remeshed, settings, share, kMeshVoxelMs + (object.has_holes ? kHoleVoxelMs : 0.0), cost);
    }
  }
  return cost;
}

namespace {
/// Curves grow by a picture's side.
double side_of(double pixels) { return std::sqrt(pixels / 230'400.0); }
}  // namespace

double cell_ms(double pixels, double faces) { return 6.0 + pixels * 2e-5 + kBorderMs * std::sqrt(faces) * side_of(pixels); }
double truth_ms(double pixels, double faces) { return 8.0 + pixels * 5e-5 + kTruthFaceMs * faces * side_of(pixels); }

void CostLedger::learn(const std::string& kind, double expected_ms, double took_ms) {
  Entry& entry = entries_[kind];
  entry.expected_ms += expected_ms;
  entry.took_ms += took_ms;
}

void CostLedger::done(const std::string& kind, double expected_ms, double took_ms) {
  learn(kind, expected_ms, took_ms);
  drop(kind, expected_ms);
  entries_[kind].spent_ms += took_ms;
}

void CostLedger::drop(const std::string& kind, double expected_ms) {
  Entry& entry = entries_[kind];
  entry.left_ms = std::max(0.0, entry.left_ms - expected_ms);
}

double CostLedger::remaining_ms() const {
  double expected = kTrustMs, took = kTrustMs;
  for (const auto& [kind, entry] : entries_) {
    expected += entry.expected_ms;
    took += entry.took_ms;
  }
  const double overall = took / expected;
  double remaining = 0.0;
  for (const auto& [kind, entry] : entries_)
    remaining += entry.left_ms * (entry.took_ms + overall * kTrustMs) / (entry.expected_ms + kTrustMs);
  return remaining;
}

double CostLedger::spent_ms() const {
  double spent = 0.0;
  for (const auto& [kind, entry] : entries_) spent += entry.spent_ms;
  return spent;
}

std::string CostLedger::text() const {
  std::string text;
  for (const auto& [kind, entry] : entries_) {
    if (entry.spent_ms == 0.0) continue;
    text += fmt::format("{}{} {} (expected {})", text.empty() ? "" : "; ", kind, time_text(entry.took_ms), time_text(entry.expected_ms));
  }
  return text;
}

}  // namespace limn
