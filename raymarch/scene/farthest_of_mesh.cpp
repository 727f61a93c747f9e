#include <algorithm>
#include <limits>
#include <memory>
#include <mutex>

#include "raymarch/scene/farthest_points.h"
#include "sdf/error.h"
#include "sdf/once_alone.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr size_t kBlock = size_t{1} << 15;        // vertices that one thread takes
constexpr int kFinest = 5, kUsual = 3;            // levels of cages
constexpr std::int64_t kMostFaces = 50'000;       // of a refined cage,
constexpr std::int64_t kMostFine = 8'000;         // and beyond the usual level
constexpr size_t kMostRefined = size_t{200'000};  // faces of a cage; beyond it the surface lies close to its vertices

/// The mesh whose vertices stand for a cage's limit surface.
SharedMesh on_limit(const MeshSource& source) {
  if (!source.scheme || source.mesh->face_count() > kMostRefined) return source.mesh;
  try {
    int level = kFinest;
    const std::vector<RefinedSize> sizes = predict_refined_sizes(source.mesh, *source.scheme, kFinest);
    // A cage of few faces is coarse at the usual level still.
    while (level > 0 && sizes[static_cast<size_t>(level)].faces > (level > kUsual ? kMostFine : kMostFaces)) --level;
    return refine(source.mesh, {.scheme = *source.scheme, .level = level, .normals = NormalKind::flat}, source.file);
  } catch (const InputError&) {
    return source.mesh;  // what is wrong with the cage is told where the model is built
  }
}

/// Drawn vertices, found when they are first asked for.
struct DrawnVertices {
  MeshSource source;
  Affine world_from_object;
  std::once_flag once{};
  SharedMesh mesh{};
  std::vector<char> drawn{};  ///< Empty: all of them.

  void find() {
    mesh = on_limit(source);
    drawn = drawn_vertices(mesh);
    if (std::find(drawn.begin(), drawn.end(), 0) == drawn.end()) drawn = {};
  }
};

struct Farthest {
  double along = -std::numeric_limits<double>::infinity();
  size_t vertex = 0;
};

/// The lowest vertex of several that lie as far.
void farthest_in(const DrawnVertices& vertices, std::span<const glm::dvec3> directions, size_t first, size_t last, Farthest* best) {
  const std::vector<glm::dvec3>& positions = vertices.mesh->positions;
  for (size_t v = first; v < last; ++v) {
    if (!vertices.drawn.empty() && vertices.drawn[v] == 0) continue;
    for (size_t d = 0; d < directions.size(); ++d) {
      const double along = glm::dot(positions[v], directions[d]);
      if (along > best[d].along) best[d] = {along, v};
    }
  }
}

std::vector<glm::dvec3> farthest(const DrawnVertices& vertices, std::span<const glm::dvec3> directions) {
  std::vector<glm::dvec3> in_object;
  for (const glm::dvec3& direction : directions) in_object.push_back(glm::transpose(vertices.world_from_object.linear) * direction);
  const size_t count = vertices.mesh->positions.size(), blocks = (count + kBlock - 1) / kBlock;
  std::vector<Farthest> best(blocks * directions.size());
  parallel_for(size_t{0}, blocks, [&](size_t block) {
    farthest_in(vertices, in_object, block * kBlock, std::min(count, (block + 1) * kBlock), &best[block * directions.size()]);
  });
  std::vector<glm::dvec3> points;
  for (size_t d = 0; d < directions.size(); ++d) {
    Farthest one;
    for (size_t block = 0; block < blocks; ++block) {
      const Farthest& found = best[block * directions.size() + d];
      if (found.along > one.along) one = found;
    }
    if (one.along == -std::numeric_limits<double>::infinity()) return {};
    points.push_back(vertices.world_from_object.point(vertices.mesh->positions[one.vertex]));
  }
  return points;
}

}  // namespace

FarthestPoints farthest_of_mesh(const MeshSource& mesh, const Affine& world_from_object) {
  const auto vertices = std::make_shared<DrawnVertices>();
  vertices->source = mesh;
  vertices->world_from_object = world_from_object;
  return [vertices](std::span<const glm::dvec3> directions) {
    once_alone(vertices->once, [&] { vertices->find(); });
    return farthest(*vertices, directions);
  };
}

}  // namespace limn
