#include "raymarch/lines/mesh_layers.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "raymarch/lines/line_memory.h"
#include "raymarch/surface/object_mesh.h"
#include "raymarch/truth/proxy.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kLift_px = 0.1;
constexpr double kStepAside_px = 0.3;
constexpr double kInPlane = 1e-5;                   // the sine of the angle between a line and a plane
constexpr double kAcross = 0.1, kSameSheet = 0.85;  // cosines
constexpr double kUnclear = 2.0, kMostUnclear_px = 20.0;
constexpr double kFlatly = 0.3;  // a cosine
constexpr double kBeside = 1.5;  // of a triangle's longest edge

/// The same triangles for all views that need cages refined as often.
std::shared_ptr<const MeshTree> tree_of(const LineTask& task, const std::vector<size_t>& objects, double edge_px, bool smooth) {
  Scene part{task.scene.name, task.scene.camera, {}};
  std::vector<int> numbers;
  for (const size_t i : objects) {
    part.objects.push_back(task.scene.objects[i]);
    part.objects.back().world_from_object.translation -= task.origin;
    numbers.push_back(static_cast<int>(i) + 1);
  }
  const int level = proxy_level(part, task.camera, edge_px);
  std::shared_ptr<const MeshTree>& kept = task.kept.trees[{objects.front(), level}];
  if (kept) return kept;
  std::vector<std::shared_ptr<const Polygons>> polygons;
  glm::dvec3 offset(0.0);
  if (std::all_of(part.objects.begin(), part.objects.end(), [](const SceneObject& object) { return is_cage(object); })) {
    if (const Box box = bounds(part); !box.empty()) offset = box.center();
    polygons.resize(part.objects.size());
    parallel_each(part.objects.size(), [&](size_t i) {
      polygons[i] = refined_polygons(part.objects[i], level, task.settings.max_bytes, offset);
      static_cast<void>(polygons[i]->corner_triangles());
    });
  } else {
    const SceneModel model = proxy_model(part, level, task.settings.max_bytes);
    offset = model.render_origin;
    for (const auto& surface : model.surfaces) polygons.push_back(surface.polygons);
  }
  kept = std::make_shared<const MeshTree>(polygons, offset, numbers, task.extent, !smooth);
  if (smooth) kept->prepare_for_smooth();
  return kept;
}

}  // namespace

void make_exact(SurfaceCurve& curve) {
  curve.straight = true;
  curve.apart_px = curve.tangency_px = 0.0;
  curve.nearer_px = kExactNearer_px;
  for (CurveSample& sample : curve.samples) sample.lift_share = kExactLiftShare;
}

MeshLayers::MeshLayers(const LineTask& task, const std::vector<size_t>& objects, double edge_px, bool smooth)
    : camera_(task.camera),
      extent_(task.extent),
      smooth_(smooth),
      edge_of_materials_(task.class_of_meeting(0, 1)),
      tree_(tree_of(task, objects, edge_px, smooth)) {
  for (const SceneObject& object : task.scene.objects) materials_.push_back(object.material);
}

LineClass MeshLayers::class_of(const PartMeeting& meeting) const {
  const auto material = [&](int object, int of_face) { return materials_[static_cast<size_t>(object) - 1] + of_face; };
  const bool same = material(meeting.object, meeting.material) == material(meeting.other_object, meeting.other_material);
  return same ? LineClass::intersection : edge_of_materials_;
}

/// The part that the curve runs on: what most of a few short rays through it hit.
std::uint32_t MeshLayers::part_of(const SurfaceCurve& curve) const {
  std::map<std::uint32_t, int> votes;
  const size_t n = curve.samples.size(), step = std::max<size_t>(1, n / 9);
  for (size_t i = step / 2; i < n; i += step) {
    const CurveSample& sample = curve.samples[i];
    if (!(sample.depth > 0.0)) continue;
    const double reach = 2.0 * kLift_px / pixels_per_unit_at(camera_, sample.depth);
    // Beside a boundary as well: rays through it pass the mesh by.
    const glm::dvec3 along = curve.samples[(i + 1) % n].p - sample.p, across = glm::cross(along, sample.high);
    const double length = glm::length(across), beside = curve.smooth || !(length > 0.0) ? 0.0 : reach / length;
    for (const auto& [way, shift] : {std::pair(sample.high, 0.0), {sample.low, 0.0}, {sample.high, beside}, {sample.high, -beside}}) {
      const std::vector<LayerHit> hits = tree_->hits_along(sample.p + reach * way + shift * across, -way, 2.0 * reach);
      const auto nearest = std::min_element(
          hits.begin(), hits.end(), [&](const LayerHit& a, const LayerHit& b) { return std::fabs(a.t - reach) < std::fabs(b.t - reach); });
      if (nearest != hits.end()) ++votes[tree_->triangles()[nearest->triangle].part];
    }
  }
  const auto most = std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == votes.end() ? tree_->parts() : most->first;
}

glm::dvec3 MeshLayers::lifted(const CurveSample& sample) const {
  return sample.p + (sample.lift_share * kLift_px / pixels_per_unit_at(camera_, std::max(sample.depth, 1e-9))) * sample.lift;
}

double MeshLayers::reach_to_eye(const glm::dvec3& p) const {
  return camera_.projection == Projection::perspective ? glm::distance(p, camera_.eye)
                                                       : std::max(0.0, project(camera_, p).z) + 4.0 * extent_;
}

LayersSeen MeshLayers::before(const CurveSample& sample) const {
  const glm::dvec3 start = lifted(sample), direction = view_vector(camera_, start);
  const double reach = reach_to_eye(start), nothing = std::numeric_limits<double>::infinity();
  if (!smooth_) {
    const std::vector<ExactHit> hits =
        tree_->exact_hits().through({.from = start, .to = start + reach * direction, .edge = sample.edge, .faces = sample.faces});
    return {static_cast<int>(hits.size()), hits.empty() ? nothing : hits.front().share * reach};
  }
  const std::vector<LayerHit> hits = tree_->hits_along(start, direction, reach);
  return {static_cast<int>(hits.size()), hits.empty() ? nothing : hits.front().t};
}

/// Whether rays a little before and after the place differ by the sheet that is met there: where a surface bends tightly its own triangles
/// lie across its lines here and there.
bool MeshLayers::goes_through(const CurveSample& sample, const glm::dvec3& way, double at, const glm::dvec3& normal) const {
  const double px = 1.0 / pixels_per_unit_at(camera_, std::max(sample.depth, 1e-9)), step = kStepAside_px * px;
  const double slope = std::fabs(glm::dot(normal, way)) / std::max(1e-3, std::fabs(glm::dot(normal, view_vector(camera_, sample.p))));
  const auto sheet_near = [&](double place) {
    CurveSample beside = sample;
    beside.p = sample.p + place * way;
    const LayersSeen seen = before(beside);
    return seen.count > 0 && seen.nearest < 2.0 * (step * slope + kLift_px * px);
  };
  return sheet_near(at - step) != sheet_near(at + step);
}

/// The triangle that stands for the surface at a sample: of those that a short ray through it meets, the one of its normal.
std::optional<std::uint32_t> MeshLayers::triangle_under(const CurveSample& sample) const {
  if (!(sample.depth > 0.0)) return {};
  const double reach = 2.0 * kLift_px / pixels_per_unit_at(camera_, sample.depth);
  std::optional<std::uint32_t> best;
  double most = kSameSheet;
  for (const LayerHit& hit : tree_->hits_along(sample.p + reach * sample.high, -sample.high, 2.0 * reach)) {
    const double agreement = glm::dot(glm::normalize(tree_->normal_of(tree_->triangles()[hit.triangle])), sample.high);
    if (agreement > most) best = hit.triangle, most = agreement;
  }
  return best;
}

/// Whether the triangle met on a step belongs to the sheet that the step runs on: whether it is joined there to the triangle that stands
/// for that place, or for an end of the step. `otherwise` where none does.
bool MeshLayers::on_own_sheet(const CurveSample& a, const CurveSample& b, double share, std::uint32_t triangle, bool otherwise) const {
  const auto& corners = tree_->triangles()[triangle].corners;
  double longest = 0.0;
  for (size_t k = 0; k < 3; ++k)
    longest = std::max(longest, glm::distance(tree_->positions()[corners[k]], tree_->positions()[corners[(k + 1) % 3]]));
  CurveSample place = a;
  place.p = glm::mix(a.p, b.p, share);
  place.high = glm::normalize(glm::mix(a.high, b.high, share));
  for (const CurveSample* from : {&std::as_const(place), &a, &b}) {
    const double reach = kBeside * longest + glm::distance(place.p, from->p);
    if (const auto own = triangle_under(*from)) return tree_->joined_near(*own, triangle, place.p, reach);
  }
  return otherwise;
}

/// Edges of the mesh itself go through every triangle that they meet, but for those around their ends. They are lifted off as little as
/// rays from them are, so that they lie in front of faces that they touch.
void MeshLayers::pierce_exactly(SurfaceCurve& curve) const {
  const size_t n = curve.samples.size();
  for (size_t i = 0; i + (curve.closed ? 0 : 1) < n; ++i) {
    CurveSample& sample = curve.samples[i];
    const CurveSample& next = curve.samples[(i + 1) % n];
    const glm::dvec3 from = lifted(sample), to = lifted(next);
    for (const ExactHit& hit : tree_->exact_hits().through({.from = from, .to = to, .vertices = sample.edge, .faces = sample.faces})) {
      const glm::dvec3 normal = tree_->normal_of(tree_->triangles()[hit.triangle]), place = glm::mix(from, to, hit.share);
      const bool leaves = (glm::dot(normal, to - from) > 0.0) == (glm::dot(normal, view_vector(camera_, place)) > 0.0);
      sample.pierced.push_back({hit.share, leaves ? -1 : 1, 0.0});
    }
  }
}

void MeshLayers::pierce(SurfaceCurve& curve) const {
  if (curve.straight) return pierce_exactly(curve);
  const std::uint32_t own = part_of(curve);
  const size_t n = curve.samples.size();
  for (size_t i = 0; i + (curve.closed ? 0 : 1) < n; ++i) {
    CurveSample& sample = curve.samples[i];
    const CurveSample& next = curve.samples[(i + 1) % n];
    const double length = glm::distance(sample.p, next.p);
    if (!(length > 0.0)) continue;
    const glm::dvec3 way = (next.p - sample.p) / length;
    for (const LayerHit& hit : tree_->hits_along(sample.p, way, length)) {
      const LayerTriangle& triangle = tree_->triangles()[hit.triangle];
      const glm::dvec3 normal = glm::normalize(tree_->normal_of(triangle));
      // Triangles of the curve's own sheet lie along it; another sheet of the same part goes across.
      const bool along_own = std::fabs(glm::dot(normal, way)) < kAcross || std::fabs(glm::dot(normal, sample.high)) > kSameSheet ||
                             std::fabs(glm::dot(normal, sample.low)) > kSameSheet;
      // Nor does a line go through a plane that it lies in.
      if (std::fabs(glm::dot(normal, way)) < kInPlane) continue;
      if (triangle.part == own) {
        const bool seems_own = along_own || !goes_through(sample, way, hit.t, normal);
        if (curve.smooth ? on_own_sheet(sample, next, hit.t / length, hit.triangle, seems_own) : seems_own) continue;
      }
      // Which side of the sheet is seen is asked of the smooth surface, as its contour is that one's.
      const double along = glm::dot(normal, way);
      double towards_eye = glm::dot(normal, view_vector(camera_, sample.p));
      if (smooth_ && std::fabs(towards_eye) < kFlatly) {
        const glm::dvec3 place = sample.p + hit.t * way;
        const glm::dvec3 here = tree_->smooth_normal(hit.triangle, place);
        if (glm::dot(here, normal) > kSameSheet) towards_eye = glm::dot(here, view_vector(camera_, place));
      }
      const double image_share = glm::distance(sample.px, next.px) / (length * pixels_per_unit_at(camera_, std::max(sample.depth, 1e-9)));
      const double unclear_px = kUnclear * kLift_px * std::fabs(glm::dot(normal, sample.lift) / along) * std::min(1.0, image_share);
      sample.pierced.push_back({hit.t / length, (along > 0.0) == (towards_eye > 0.0) ? -1 : 1, std::min(unclear_px, kMostUnclear_px)});
    }
  }
}

void add_mesh_layers(const std::shared_ptr<const MeshLayers>& layers, LineContribution& out) {
  parallel_for(size_t{0}, out.curves.size(), [&](size_t i) { layers->pierce(out.curves[i]); });
  if (layers->tree().parts() > 1) {
    for (SurfaceCurve& curve : layers->intersections()) out.curves.push_back(std::move(curve));
  }
  out.layers_before = [layers](const CurveSample& sample) { return layers->before(sample); };
}

}  // namespace limn
