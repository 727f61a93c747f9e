#include "raymarch/surface/mesh_curvature.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "raymarch/surface/limit_map.h"
#include "sdf/once_alone.h"

namespace limn {
namespace {

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

}  // namespace

struct MeshCurvature::Made {
  std::optional<LimitMap> limit{};
  std::vector<std::int32_t> first_corner{};  ///< Of the polygons.
  CornerTensors tensors{};
  mutable std::optional<tbb::enumerable_thread_specific<FieldEvaluator>> evaluators{};

  SurfaceCurvature on_limit(const TriangleMesh& mesh, const Mesh& polygons, const CageSource& cage, const SurfacePoint& point,
                            const Place& place) const {
    LimitPiece piece;
    if (!cage.pieces.empty())
      piece = cage.pieces[static_cast<size_t>(point.face)];
    else if (!limit->piece_of(point.face, piece))
      return no_curvature();
    const auto first = static_cast<size_t>(first_corner[static_cast<size_t>(point.face)]);
    const auto size = static_cast<size_t>(polygons.face_sizes[static_cast<size_t>(point.face)]);
    if (size > 4) return no_curvature();
    const bool mirrored = cage.mirrored && cage.pieces.empty();  // pieces are those of the triangles as they are traced
    glm::dvec2 uv(0.0);
    for (int i = 0; i < 3; ++i) {
      size_t corner = 0;
      const auto vertex = static_cast<std::int32_t>(mesh.triangles[place.triangle][i]);
      while (corner + 1 < size && polygons.corner_vertices[first + corner] != vertex) ++corner;
      uv += place.weights[i] * piece.corners[mirrored ? (size - corner) % size : corner];
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
  once_alone(once_, [this] {
    auto made = std::make_unique<Made>();
    if (const Field* field = std::get_if<Field>(&source_)) {
      made->evaluators.emplace(*field);
    } else if (const CageSource* cage = std::get_if<CageSource>(&source_)) {
      made->limit.emplace(cage->cage, cage->scheme, cage->level, cage->file);
      made->first_corner = first_corners(polygons_.mesh());
      // Faces that refinement leaves out (collapsed ones, holes) shift the numbers of all others.
      const size_t faces = polygons_.mesh().face_count();
      if (cage->pieces.empty() ? !made->limit->maps(faces) : cage->pieces.size() != faces) made->limit.reset();
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
