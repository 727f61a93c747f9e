#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "raymarch/local/local_sources.h"
#include "sdf/parallel.h"
#include "subdiv/polygon.h"

namespace limn {
namespace {

/// Between unit normals at one place: a crease is sharper, a patch's error is not.
constexpr double kSameNormal = 2e-3;

/// A limit surface in render space.
struct PlacedLimit {
  LimitMap map;
  Affine render_from_cage{};
  double handedness = 1.0;  ///< -1 where the placement is a reflection.
  std::vector<LimitPiece> patches{};

  bool evaluate(const LocalTriangle& triangle, const glm::dvec2& uv, glm::dvec3& position, glm::dvec3& normal) const {
    const LimitPiece& patch = patches[static_cast<size_t>(triangle.patch)];
    LimitPoint at;
    if (!map.surface.evaluate(patch.face, patch.sub_face, uv.x, uv.y, at)) return false;
    const glm::dvec3 across = handedness * glm::cross(render_from_cage.vector(at.du), render_from_cage.vector(at.dv));
    const double length = glm::length(across);
    if (!(length > 0.0) || !std::isfinite(length)) return false;
    position = render_from_cage.point(at.position);
    normal = across / length;
    return true;
  }
};

/// Where the surface has no point or no normal, that of the chord.
void middle_of_side(const PlacedLimit& placed, const LocalTriangles& mesh, const EdgeSide& side, glm::dvec3& position, glm::dvec3& normal) {
  const LocalTriangle& triangle = *side.triangle;
  const auto a = static_cast<size_t>(side.corner), b = (a + 1) % 3;
  if (placed.evaluate(triangle, 0.5 * (triangle.uv[a] + triangle.uv[b]), position, normal)) return;
  position = 0.5 * (mesh.positions[triangle.vertices[a]] + mesh.positions[triangle.vertices[b]]);
  const glm::dvec3 sum = triangle.normals[a] + triangle.normals[b];
  normal = glm::length(sum) > 0.0 ? glm::normalize(sum) : triangle.normals[a];
}

void cage_middles(const PlacedLimit& placed, const LocalTriangles& mesh, std::span<const LocalEdge> edges, std::span<EdgeMiddle> middles) {
  parallel_for(size_t{0}, edges.size(), [&](size_t i) {
    const LocalEdge& edge = edges[i];
    EdgeMiddle& middle = middles[i];
    const size_t first = edge.sides[0].triangle ? 0 : 1, other = 1 - first;
    middle_of_side(placed, mesh, edge.sides[first], middle.position, middle.normals[first]);
    middle.normals[other] = middle.normals[first];
    if (!edge.sides[other].triangle || edge.sides[other].triangle->patch == edge.sides[first].triangle->patch) return;
    glm::dvec3 same_place;
    glm::dvec3 normal;
    middle_of_side(placed, mesh, edge.sides[other], same_place, normal);
    if (glm::distance(normal, middle.normals[first]) <= kSameNormal) return;
    middle.normals[other] = normal;
    middle.crease = true;
  });
}

/// A refined face as triangles, along its shorter diagonal.
std::vector<std::array<size_t, 3>> fan_of(const std::vector<glm::dvec3>& corners) {
  if (corners.size() == 3) return {{0, 1, 2}};
  if (glm::distance(corners[0], corners[2]) <= glm::distance(corners[1], corners[3])) return {{0, 1, 2}, {0, 2, 3}};
  return {{1, 2, 3}, {1, 3, 0}};
}

bool has_larger_face(const Mesh& cage) {
  return std::any_of(cage.face_sizes.begin(), cage.face_sizes.end(), [](std::int32_t size) { return size != 4; });
}

/// The triangles of the refined cage, as they stand in render space.
bool make_triangles(const Mesh& refined, PlacedLimit& placed, LocalTriangles& result) {
  std::map<std::pair<int, int>, std::int32_t> patch_of;
  const std::vector<std::int32_t> first = first_corners(refined);
  const glm::dmat3 normal_matrix = glm::transpose(glm::inverse(placed.render_from_cage.linear));
  std::vector<glm::dvec3> corners;
  for (size_t f = 0; f < refined.face_count(); ++f) {
    LimitPiece piece;
    if (!placed.map.piece_of(static_cast<std::int32_t>(f), piece) || placed.map.surface.is_hole(piece.face)) return false;
    const auto [patch, inserted] = patch_of.try_emplace({piece.face, piece.sub_face}, static_cast<std::int32_t>(placed.patches.size()));
    if (inserted) placed.patches.push_back(piece);
    const std::span<const std::int32_t> vertices = face_corners(refined, first[f], f);
    gather_corners(refined, vertices, corners);
    for (std::array<size_t, 3> fan : fan_of(corners)) {
      if (placed.handedness < 0.0) std::swap(fan[1], fan[2]);
      LocalTriangle triangle;
      triangle.patch = patch->second;
      triangle.face = static_cast<std::int32_t>(f);
      for (size_t k = 0; k < 3; ++k) {
        triangle.vertices[k] = static_cast<std::uint32_t>(vertices[fan[k]]);
        triangle.uv[k] = piece.corners[fan[k]];
        triangle.normals[k] = glm::normalize(normal_matrix * glm::dvec3(refined.corner_normals[static_cast<size_t>(first[f]) + fan[k]]));
      }
      result.triangles.push_back(triangle);
    }
  }
  for (const glm::dvec3& position : refined.positions) result.positions.push_back(placed.render_from_cage.point(position));
  result.colors = refined.vertex_colors;
  return is_oriented(result);
}

}  // namespace

bool is_oriented(const LocalTriangles& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const LocalTriangle& triangle : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) edges.emplace_back(triangle.vertices[k], triangle.vertices[(k + 1) % 3]);
  std::sort(edges.begin(), edges.end());
  return std::adjacent_find(edges.begin(), edges.end()) == edges.end();
}

LocalStart start_from_cage(const Mesh& cage, Scheme scheme, const Affine& render_from_cage, std::int64_t max_bytes,
                           const std::string& file) {
  LocalStart start;
  // Faces that are no quads have parameters once they are refined.
  const int level = scheme == Scheme::loop || !has_larger_face(cage) ? 0 : 1;
  start.mesh = refine(cage, {.scheme = scheme, .level = level, .normals = NormalKind::limit, .max_bytes = max_bytes}, file);
  auto placed = std::make_shared<PlacedLimit>(
      PlacedLimit{LimitMap(cage, scheme, level, file), render_from_cage, glm::determinant(render_from_cage.linear) < 0.0 ? -1.0 : 1.0, {}});
  if (!placed->map.maps(start.mesh.face_count()) || !make_triangles(start.mesh, *placed, start.triangles)) {
    start.triangles.triangles.clear();
    return start;
  }
  start.patches = placed->patches;
  start.source.has_parameters = true;
  start.source.middles = [placed](const LocalTriangles& mesh, std::span<const LocalEdge> edges, std::span<EdgeMiddle> middles) {
    cage_middles(*placed, mesh, edges, middles);
  };
  return start;
}

}  // namespace limn
