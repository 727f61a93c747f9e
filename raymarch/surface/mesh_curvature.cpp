#include "raymarch/surface/mesh_curvature.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace limn {
namespace {

using Domain = std::array<glm::dvec2, 4>;

/// A hit's triangle and the weights of its corners.
struct Place {
  size_t triangle = 0;
  glm::dvec3 weights{0.0};
};

glm::dvec3 weights_in(const TriangleMesh& mesh, size_t triangle, const glm::dvec3& point) {
  const glm::uvec3& corners = mesh.triangles[triangle];
  const glm::dvec3 a = mesh.positions[corners.x], ab = mesh.positions[corners.y] - a, ac = mesh.positions[corners.z] - a;
  const glm::dvec3 normal = glm::cross(ab, ac), ap = point - a;
  const double squared = glm::dot(normal, normal);
  const double v = glm::dot(glm::cross(ap, ac), normal) / squared, w = glm::dot(glm::cross(ab, ap), normal) / squared;
  return {1.0 - v - w, v, w};
}

/// The triangle of the polygon `face` that holds the point: the one whose least weight is greatest.
bool find_place(const TriangleMesh& mesh, const SurfacePoint& point, Place& place) {
  size_t first = static_cast<size_t>(point.face), last = first + 1;
  if (!mesh.triangle_faces.empty()) {
    const auto range = std::equal_range(mesh.triangle_faces.begin(), mesh.triangle_faces.end(), point.face);
    first = static_cast<size_t>(range.first - mesh.triangle_faces.begin());
    last = static_cast<size_t>(range.second - mesh.triangle_faces.begin());
  }
  double best = -std::numeric_limits<double>::infinity();
  for (size_t t = first; t < std::min(last, mesh.triangles.size()); ++t) {
    const glm::dvec3 weights = weights_in(mesh, t, point.position);
    const double least = std::min({weights.x, weights.y, weights.z});
    if (least > best) best = least, place = {t, weights};
  }
  if (!std::isfinite(best)) return false;
  place.weights = glm::clamp(place.weights, glm::dvec3(0.0), glm::dvec3(1.0));
  place.weights /= place.weights.x + place.weights.y + place.weights.z;
  return true;
}

/// The parameters at the corners of child `child` of a face, in OpenSubdiv's order of children and corners.
Domain quad_child(const Domain& parent, int child) {
  const auto i = static_cast<size_t>(child), next = (i + 1) % 4, across = (i + 2) % 4, before = (i + 3) % 4;
  Domain result;
  result[i] = parent[i];
  result[next] = 0.5 * (parent[i] + parent[next]);
  result[across] = 0.25 * (parent[0] + parent[1] + parent[2] + parent[3]);
  result[before] = 0.5 * (parent[i] + parent[before]);
  return result;
}
Domain triangle_child(const Domain& parent, int child) {
  const glm::dvec2 ab = 0.5 * (parent[0] + parent[1]), bc = 0.5 * (parent[1] + parent[2]), ca = 0.5 * (parent[2] + parent[0]);
  if (child == 0) return {parent[0], ab, ca};
  if (child == 1) return {ab, parent[1], bc};
  if (child == 2) return {ca, bc, parent[2]};
  return {bc, ca, ab};
}

/// A limit surface and the way from a refined face to its parameters. Refinement numbers the children of each face in a row, face by face.
struct LimitMap {
  LimitSurface surface;
  const CageSource& cage;
  std::vector<std::int64_t> first_child{};  ///< Of each face of the cage, with one past the end.

  explicit LimitMap(const CageSource& source) : surface(source.cage, source.scheme, source.file), cage(source) {
    const std::int64_t later = std::int64_t{1} << (2 * std::max(source.level - 1, 0));
    first_child.push_back(0);
    for (size_t f = 0; f < source.cage.face_count(); ++f) {
      const std::int32_t size = source.cage.face_sizes[f];
      if (std::binary_search(source.cage.holes.begin(), source.cage.holes.end(), static_cast<std::int32_t>(f))) {
        first_child.push_back(first_child.back());
        continue;
      }
      const std::int64_t children = source.level == 0 ? 1 : source.scheme == Scheme::loop ? 4 * later : size * later;
      first_child.push_back(first_child.back() + children);
    }
  }

  struct Piece {
    int face = 0, sub_face = 0;
    Domain corners{};
  };
  bool piece_of(std::int32_t refined_face, Piece& piece) const {
    const auto at = std::upper_bound(first_child.begin(), first_child.end(), std::int64_t{refined_face});
    piece.face = static_cast<int>(at - first_child.begin()) - 1;
    const std::int32_t size = cage.cage.face_sizes[static_cast<size_t>(piece.face)];
    const std::int64_t rest = refined_face - first_child[static_cast<size_t>(piece.face)];
    const bool triangles = cage.scheme == Scheme::loop;
    piece.corners = triangles ? Domain{{{0, 0}, {1, 0}, {0, 1}, {0, 0}}} : Domain{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    int digits = cage.level;
    if (!triangles && size != 4) {
      if (digits == 0) return false;
      --digits;
      piece.sub_face = static_cast<int>(rest >> (2 * digits));
    }
    while (digits > 0) {
      const int child = static_cast<int>((rest >> (2 * --digits)) & 3);
      piece.corners = triangles ? triangle_child(piece.corners, child) : quad_child(piece.corners, child);
    }
    return true;
  }
};

}  // namespace

struct MeshCurvature::Made {
  std::optional<LimitMap> limit{};
  std::vector<std::int32_t> first_corner{};  ///< Of the polygons.
  CornerTensors tensors{};
  mutable std::optional<tbb::enumerable_thread_specific<FieldEvaluator>> evaluators{};

  SurfaceCurvature on_limit(const TriangleMesh& mesh, const Mesh& polygons, const CageSource& cage, const SurfacePoint& point,
                            const Place& place) const {
    LimitMap::Piece piece;
    if (!limit->piece_of(point.face, piece)) return no_curvature();
    const auto first = static_cast<size_t>(first_corner[static_cast<size_t>(point.face)]);
    const auto size = static_cast<size_t>(polygons.face_sizes[static_cast<size_t>(point.face)]);
    if (size > 4) return no_curvature();
    glm::dvec2 uv(0.0);
    for (int i = 0; i < 3; ++i) {
      size_t corner = 0;
      const auto vertex = static_cast<std::int32_t>(mesh.triangles[place.triangle][i]);
      while (corner + 1 < size && polygons.corner_vertices[first + corner] != vertex) ++corner;
      uv += place.weights[i] * piece.corners[cage.mirrored ? (size - corner) % size : corner];
    }
    LimitPoint at;
    if (!limit->surface.evaluate(piece.face, piece.sub_face, uv.x, uv.y, at)) return no_curvature();
    for (glm::dvec3* derivative : {&at.du, &at.dv, &at.duu, &at.duv, &at.dvv}) *derivative = cage.render_from_cage.vector(*derivative);
    const SurfaceCurvature result = curvature(at);
    return result.normal == glm::dvec3(0.0) || !std::isfinite(result.k1 + result.k2) ? no_curvature() : facing(result, point.normal);
  }

  SurfaceCurvature discrete(const SurfacePoint& point, const Place& place) const {
    glm::dmat3 tensor(0.0);
    for (int i = 0; i < 3; ++i)
      tensor += place.weights[i] * tensors.tensors[tensors.of_corner[3 * place.triangle + static_cast<size_t>(i)]];
    return curvature_of_tensor(tensor, point.normal);
  }
};

MeshCurvature::MeshCurvature(const TriangleMesh& triangles, const Polygons& polygons, NormalKind normals, SmoothSource source)
    : triangles_(triangles), polygons_(polygons), normals_(normals), source_(std::move(source)) {}
MeshCurvature::~MeshCurvature() = default;

bool MeshCurvature::available() const {
  return !std::holds_alternative<std::monostate>(source_) || (normals_ != NormalKind::flat && !triangles_.corner_normals.empty());
}

std::string MeshCurvature::from() const {
  if (std::holds_alternative<Field>(source_)) return "Hessian of the field that was tessellated";
  if (std::holds_alternative<CageSource>(source_)) return "derivatives of the limit surface";
  return available() ? "discrete curvature tensor of the mesh (Rusinkiewicz 2004)" : "flat facets have no curvature";
}

void MeshCurvature::evaluate(std::span<const SurfacePoint> points, std::span<SurfaceCurvature> curvatures) const {
  std::call_once(once_, [this] {
    auto made = std::make_unique<Made>();
    if (const Field* field = std::get_if<Field>(&source_)) {
      made->evaluators.emplace(*field);
    } else if (const CageSource* cage = std::get_if<CageSource>(&source_)) {
      made->limit.emplace(*cage);
      made->first_corner = first_corners(polygons_.mesh());
      // Faces that refinement leaves out (collapsed ones, holes) shift the numbers of all others.
      if (made->limit->first_child.back() != static_cast<std::int64_t>(polygons_.mesh().face_count())) made->limit.reset();
    }
    if (!made->evaluators && !made->limit && !triangles_.corner_normals.empty()) made->tensors = corner_tensors(triangles_);
    made_ = std::move(made);
  });
  if (made_->evaluators) {
    FieldEvaluator& evaluator = made_->evaluators->local();
    for (size_t i = 0; i < points.size(); ++i)
      curvatures[i] = facing(curvature_of_jet(evaluator.jet(points[i].position)), points[i].normal);
    return;
  }
  const CageSource* cage = std::get_if<CageSource>(&source_);
  for (size_t i = 0; i < points.size(); ++i) {
    Place place;
    curvatures[i] = no_curvature();
    if (points[i].face < 0 || !find_place(triangles_, points[i], place)) continue;
    if (made_->limit) {
      curvatures[i] = made_->on_limit(triangles_, polygons_.mesh(), *cage, points[i], place);
    } else if (!made_->tensors.tensors.empty()) {
      curvatures[i] = made_->discrete(points[i], place);
    }
  }
}

}  // namespace limn
