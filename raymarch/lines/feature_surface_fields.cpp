// Fields and level sets as feature surfaces: each branch of sharp CSG is a smooth sheet of its own, on which points lie to rounding.

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "raymarch/lines/feature_mesh.h"
#include "raymarch/lines/feature_surface.h"
#include "raymarch/lines/placed_level_set.h"
#include "raymarch/truth/branches.h"
#include "raymarch/truth/field_bodies.h"
#include "sdf/parallel.h"
#include "sdf/shape.h"
#include "subdiv/mesh.h"
#include "subdiv/tessellate.h"

namespace limn {
namespace {

constexpr int kCageLevel = 2;
constexpr double kStep = 3e-4;     // of the radius of curvature, for differences of Hessians
constexpr double kReach = 3.0;     // of a triangle's longest edge: how far its corners may lie from a sheet that goes through it
constexpr double kSettled = 1e-9;  // of the extent
constexpr int kNewton = 20;
constexpr double kFinestEdge = 0.6;  // of a voxel: triangles of level sets are no smaller

/// The sheets of one body.
class Sheets {
 public:
  Sheets(SharpField sharp, double extent, double step) : sharp_(std::move(sharp)), extent_(extent), step_(step) {}

  size_t count() const { return sharp_.branches.size(); }

  /// Which sheet is the surface at a point of it.
  std::uint32_t sheet_at(const glm::dvec3& p) const {
    if (count() == 1) return 0;
    std::vector<double> values;
    all_values(p, values);
    size_t node = sharp_.nodes.size() - 1;
    while (sharp_.nodes[node].branch < 0) {
      const auto left = static_cast<size_t>(sharp_.nodes[node].left), right = static_cast<size_t>(sharp_.nodes[node].right);
      node = (values[left] > values[right]) == sharp_.nodes[node].maximum ? left : right;
    }
    return static_cast<std::uint32_t>(sharp_.nodes[node].branch);
  }

  double margin(const FeaturePoint& point) const {
    std::vector<double> values;
    all_values(point.p, values);
    return surface_margin(sharp_, values, static_cast<int>(point.sheet));
  }

  /// The sheet's point that Newton's iteration along the gradient leads to.
  FeaturePoint onto(std::uint32_t sheet, glm::dvec3 p) const {
    FieldEvaluator& field = evaluator(sheet);
    FeaturePoint point;
    point.sheet = sheet;
    for (int i = 0; i < kNewton; ++i) {
      double value = 0.0;
      glm::dvec3 gradient;
      field.gradients(std::span(&p, 1), std::span(&value, 1), std::span(&gradient, 1));
      const double squared = glm::dot(gradient, gradient);
      if (!(squared > 0.0) || !std::isfinite(value)) return point;
      const glm::dvec3 move = (value / squared) * gradient;
      p -= move;
      if (!(glm::length(move) < extent_)) return point;
      // The next step would be as short as the square of this one.
      if (glm::length(move) < kSettled * extent_) break;
    }
    const FieldJet jet = field.jet(p);
    const double length = glm::length(jet.gradient);
    if (!(length > 0.0)) return point;
    point.p = p;
    point.normal = jet.gradient / length;
    point.shape = tangential(jet.hessian / length, point.normal);
    point.valid =
        std::isfinite(point.shape[0][0] + point.shape[1][1] + point.shape[2][2]) && std::fabs(jet.value) <= 1e-9 * extent_ * length;
    return point;
  }

  /// On an implicit surface: derive f(c(s)) = 0 three times along a geodesic c (Ohtake, Belyaev and Seidel 2004, with limn's sign). The
  /// third derivative of f comes from differences of exact Hessians.
  double change(const FeaturePoint& point, const glm::dvec3& tangent) const {
    FieldEvaluator& field = evaluator(point.sheet);
    const double bend = std::max(std::sqrt(squared(point.shape)), 1.0 / extent_), h = step_ > 0.0 ? step_ : kStep / bend;
    const FieldJet here = field.jet(point.p), after = field.jet(point.p + h * tangent), before = field.jet(point.p - h * tangent);
    const double third = (glm::dot(tangent, after.hessian * tangent) - glm::dot(tangent, before.hessian * tangent)) / (2.0 * h);
    const glm::dvec3 bent = here.hessian * tangent;
    const double length = glm::length(here.gradient), k = glm::dot(tangent, bent) / length;
    return (third - 3.0 * k * glm::dot(bent, point.normal)) / length;
  }

 private:
  static double squared(const glm::dmat3& m) { return glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]); }
  FieldEvaluator& evaluator(std::uint32_t sheet) const {
    auto& all = evaluators_.local();
    if (all.empty()) all.resize(count());
    if (!all[sheet]) all[sheet].emplace(sharp_.branches[sheet]);
    return *all[sheet];
  }
  void all_values(const glm::dvec3& p, std::vector<double>& values) const {
    std::vector<double> of_branches(count());
    for (size_t i = 0; i < count(); ++i) of_branches[i] = evaluator(static_cast<std::uint32_t>(i)).value(p);
    node_values(sharp_, of_branches, values);
  }

  SharpField sharp_;
  double extent_, step_;
  mutable tbb::enumerable_thread_specific<std::vector<std::optional<FieldEvaluator>>> evaluators_;
};

/// Corners of a triangle on each sheet that one of them lies on, so that lines go on to where sheets meet.
struct SheetTriangles {
  std::vector<std::array<std::uint32_t, 3>> triangles{};          ///< Of places.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> places{};  ///< Vertex and sheet.
  std::vector<double> reach{};                                    ///< Of each place.
};

SheetTriangles by_sheets(const FeatureMesh& mesh, const std::vector<std::uint32_t>& sheet_of) {
  SheetTriangles out;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> numbers;
  for (const auto& corners : mesh.triangles) {
    std::array<std::uint32_t, 3> sheets{sheet_of[corners[0]], sheet_of[corners[1]], sheet_of[corners[2]]};
    std::sort(sheets.begin(), sheets.end());
    double longest = 0.0;
    for (size_t i = 0; i < 3; ++i)
      longest = std::max(longest, glm::distance(mesh.positions[corners[i]], mesh.positions[corners[(i + 1) % 3]]));
    for (size_t s = 0; s < 3; ++s) {
      if (s > 0 && sheets[s] == sheets[s - 1]) continue;
      std::array<std::uint32_t, 3> triangle{};
      for (size_t i = 0; i < 3; ++i) {
        const std::pair<std::uint32_t, std::uint32_t> place(corners[i], sheets[s]);
        const auto [at, added] = numbers.try_emplace(place, static_cast<std::uint32_t>(out.places.size()));
        if (added) {
          out.places.push_back(place);
          out.reach.push_back(0.0);
        }
        triangle[i] = at->second;
        out.reach[at->second] = std::max(out.reach[at->second], kReach * longest);
      }
      out.triangles.push_back(triangle);
    }
  }
  return out;
}

/// Triangles near the surface become a feature surface of the sheets.
FeatureSurface surface_of(const LineTask& task, const std::shared_ptr<const Sheets>& sheets, FeatureMesh mesh, const CutSettings& cut,
                          double& longest_px) {
  FeatureSurface surface;
  Box box;
  for (const glm::dvec3& p : mesh.positions) box = include(box, p);
  surface.radius = box.radius();
  longest_px = cut_long_edges(task.camera, cut, mesh);
  const auto unseen = [&](const std::array<std::uint32_t, 3>& t) {
    return !may_be_seen(task.camera, {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
  };
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), unseen), mesh.triangles.end());
  std::vector<std::uint32_t> sheet_of(mesh.positions.size());
  parallel_for(size_t{0}, mesh.positions.size(), [&](size_t i) { sheet_of[i] = sheets->sheet_at(mesh.positions[i]); });
  SheetTriangles found = by_sheets(mesh, sheet_of);
  surface.nodes.resize(found.places.size());
  parallel_for(size_t{0}, found.places.size(), [&](size_t i) {
    const glm::dvec3& p = mesh.positions[found.places[i].first];
    surface.nodes[i] = sheets->onto(found.places[i].second, p);
    if (glm::distance(surface.nodes[i].p, p) > found.reach[i]) surface.nodes[i].valid = false;
  });
  surface.triangles = std::move(found.triangles);
  const auto corners = std::make_shared<const std::pair<std::vector<FeaturePoint>, std::vector<std::array<std::uint32_t, 3>>>>(
      surface.nodes, surface.triangles);
  surface.at = [sheets, corners](const FeaturePlace& place) {
    const auto& triangle = corners->second[place.triangle];
    glm::dvec3 p(0.0);
    for (size_t i = 0; i < 3; ++i) p += place.weights[static_cast<int>(i)] * corners->first[triangle[i]].p;
    return sheets->onto(corners->first[triangle[0]].sheet, p);
  };
  surface.change = [sheets](const FeaturePoint& point, const glm::dvec3& tangent) { return sheets->change(point, tangent); };
  surface.beside = [sheets](const FeaturePoint& point, const glm::dvec3& step) { return sheets->onto(point.sheet, point.p + step); };
  if (sheets->count() > 1) surface.margin = [sheets](const FeaturePoint& point) { return sheets->margin(point); };
  return surface;
}

FeatureMesh mesh_of(const Mesh& mesh) {
  const TriangleMesh triangles = triangulate(mesh, NormalKind::flat);
  FeatureMesh out;
  out.positions = triangles.positions;
  for (const glm::uvec3& t : triangles.triangles) out.triangles.push_back({t.x, t.y, t.z});
  return out;
}

void note_coarse(const std::string& name, double longest_px, std::vector<std::string>& notes) {
  if (longest_px == 0.0) return;
  notes.push_back(
      fmt::format("{}: suggestive contours, ridges and valleys are searched in triangles of up to {:.2g} px (the limit on "
                  "triangles is reached): smaller ones may be missing",
                  name, longest_px));
}

}  // namespace

glm::dmat3 tangential(const glm::dmat3& tensor, const glm::dvec3& normal) {
  const glm::dmat3 along = glm::dmat3(1.0) - glm::outerProduct(normal, normal);
  return along * tensor * along;
}

std::vector<FeatureSurface> field_features(const LineTask& task, const std::vector<size_t>& objects, std::vector<std::string>& notes) {
  std::vector<FeatureSurface> surfaces;
  const FieldBodies bodies = field_bodies(task.scene, objects, task.origin, task.extent);
  for (size_t b = 0; b < bodies.bodies.size(); ++b) {
    const Field& field = bodies.body_fields[b];
    const std::string name = name_of_body(task.scene, objects, bodies.bodies[b]);
    if (!field.traits().bounds.finite()) {
      notes.push_back(fmt::format("{}: is unbounded, and has no suggestive contours, ridges and valleys here", name));
      continue;
    }
    const double extent = field.traits().bounds.radius();
    const auto sheets = std::make_shared<const Sheets>(split_branches(field, extent, true), extent, 0.0);
    tbb::enumerable_thread_specific<std::optional<FieldEvaluator>> evaluators;
    const auto onto_surface = [&](glm::dvec3& p) {
      auto& evaluator = evaluators.local();
      if (!evaluator) evaluator.emplace(field);
      project_to_surface(*evaluator, p);
    };
    double longest_px = 0.0;
    const CutSettings cut{kFeatureEdge_px, 0.0, kMostFeatureTriangles, onto_surface};
    FeatureMesh mesh = mesh_of(tessellate(field, {kCageLevel, NormalKind::flat, task.settings.max_bytes}));
    FeatureSurface surface = surface_of(task, sheets, std::move(mesh), cut, longest_px);
    note_coarse(name, longest_px, notes);
    struct Objects {
      FieldBodies bodies;
      tbb::enumerable_thread_specific<std::vector<FieldEvaluator>> evaluators{};
    };
    const auto parts = std::make_shared<Objects>(Objects{bodies});
    surface.object = [parts, b](const FeaturePoint& point) {
      auto& local = parts->evaluators.local();
      if (local.empty()) {
        for (const Field& one : parts->bodies.fields) local.emplace_back(one);
      }
      const int place = object_at(local, parts->bodies.bodies[b], point.p, point.normal, parts->bodies.extent);
      return static_cast<int>(parts->bodies.numbers[static_cast<size_t>(place)] + 1);
    };
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

std::vector<FeatureSurface> level_set_features(const LineTask& task, const std::vector<size_t>& objects, std::vector<std::string>& notes) {
  std::vector<FeatureSurface> surfaces;
  for (const size_t object : objects) {
    const SharedLevelSet shared = place_level_set(task, object);
    const PlacedLevelSet& placed = *shared;
    const LevelSet& level_set = std::get<LevelSetSource>(task.scene.objects[object].source).level_set;
    PolygonSoup soup = mesh_from_level_set(level_set);
    if (soup.face_sizes.empty()) continue;
    Mesh mesh;
    mesh.positions = std::move(soup.positions);
    mesh.face_sizes = std::move(soup.face_sizes);
    mesh.corner_vertices = std::move(soup.corner_vertices);
    for (glm::dvec3& p : mesh.positions) p = placed.solver_from_world.point(p);
    const double extent = placed.box.radius();
    const auto sheets = std::make_shared<const Sheets>(split_branches(placed.field, extent), extent, placed.voxel);
    // Chords of the mesh lie so near the surface that only the corners of the finest triangles have to be brought onto it.
    const CutSettings cut{kFeatureEdge_px, kFinestEdge * placed.voxel, kMostFeatureTriangles, {}};
    double longest_px = 0.0;
    FeatureSurface surface = surface_of(task, sheets, mesh_of(mesh), cut, longest_px);
    note_coarse(task.scene.objects[object].name, longest_px, notes);
    surface.step = placed.voxel;
    surface.swings = true;
    surface.object = [object](const FeaturePoint&) { return static_cast<int>(object) + 1; };
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

}  // namespace limn
