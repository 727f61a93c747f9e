#include <fmt/format.h>
#include <opensubdiv/far/topologyLevel.h>

#include "sdf/error.h"
#include "subdiv/opensubdiv_cage.h"

namespace limn {
namespace {

struct Counts {
  std::int64_t vertices = 0, edges = 0, faces = 0, corners = 0;
};

/// The faces that have a surface, with their edges and vertices.
Counts count_base(const Far::TopologyLevel& base) {
  Counts counts;
  std::vector<char> vertex(static_cast<size_t>(base.GetNumVertices()), 0), edge(static_cast<size_t>(base.GetNumEdges()), 0);
  for (int f = 0; f < base.GetNumFaces(); ++f) {
    if (base.IsFaceHole(f)) continue;
    ++counts.faces;
    const Far::ConstIndexArray vertices = base.GetFaceVertices(f), edges = base.GetFaceEdges(f);
    counts.corners += vertices.size();
    for (const int v : vertices) vertex[static_cast<size_t>(v)] = 1;
    for (const int e : edges) edge[static_cast<size_t>(e)] = 1;
  }
  for (const char used : vertex) counts.vertices += used;
  for (const char used : edge) counts.edges += used;
  return counts;
}

Counts refined_once(const Counts& c, Scheme scheme) {
  if (scheme == Scheme::loop) return {c.vertices + c.edges, 2 * c.edges + 3 * c.faces, 4 * c.faces, 12 * c.faces};
  return {c.vertices + c.edges + c.faces, 2 * c.edges + c.corners, c.corners, 4 * c.corners};
}

/// OpenSubdiv's topology of one level with all its relations, and our points on it: measured at 230 to 290 bytes a face for quads.
constexpr std::int64_t kTopologyBytesPerCorner = 72;

std::int64_t result_bytes(const Counts& c, bool has_colors) {
  const std::int64_t per_vertex = std::int64_t{sizeof(glm::dvec3)} + (has_colors ? std::int64_t{sizeof(glm::vec3)} : 0);
  // Sizes, materials and groups of the faces; corner indices and normals.
  return c.vertices * per_vertex + c.faces * 12 + c.corners * 16;
}

}  // namespace

RefinedSize predict_from_base(const Far::TopologyRefiner& base, Scheme scheme, int level, bool has_colors) {
  Counts counts = count_base(base.GetLevel(0));
  std::int64_t topology = counts.corners * kTopologyBytesPerCorner;
  for (int l = 0; l < level; ++l) {
    counts = refined_once(counts, scheme);
    topology += counts.corners * kTopologyBytesPerCorner;
  }
  const std::int64_t points = counts.vertices * std::int64_t{sizeof(WeightedPoint)} * 4;
  return {counts.vertices, counts.faces, result_bytes(counts, has_colors) + topology + points};
}

RefinedSize predict_refined_size(const Mesh& cage, Scheme scheme, int level) { return predict_refined_sizes(cage, scheme, level).back(); }

std::vector<RefinedSize> predict_refined_sizes(const Mesh& cage, Scheme scheme, int most_level) {
  if (most_level < 0 || most_level > 8)
    throw InputError({"", "level", fmt::format("{}", most_level), "the subdivision level is out of range", "0 to 8"});
  const CleanCage clean = clean_cage(cage, scheme, {});
  const auto base = make_refiner(clean.mesh, scheme, {});
  std::vector<RefinedSize> sizes;
  for (int level = 0; level <= most_level; ++level) sizes.push_back(predict_from_base(*base, scheme, level, !cage.vertex_colors.empty()));
  return sizes;
}

std::vector<char> used_vertices(const Far::TopologyLevel& level, bool holes_too) {
  std::vector<char> used(static_cast<size_t>(level.GetNumVertices()), 0);
  for (int f = 0; f < level.GetNumFaces(); ++f) {
    if (!holes_too && level.IsFaceHole(f)) continue;
    for (const int v : level.GetFaceVertices(f)) used[static_cast<size_t>(v)] = 1;
  }
  return used;
}

}  // namespace limn
