#include "subdiv/opensubdiv_cage.h"

#include <fmt/format.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <algorithm>
#include <numeric>

#include "sdf/error.h"
#include "subdiv/mesh_audit.h"

namespace limn {
namespace {

namespace Sdc = OpenSubdiv::Sdc;
using Loop = std::vector<std::int32_t>;

/// A face's outline cut where it passes a vertex again; pieces with fewer than 3 corners vanish.
std::vector<Loop> simple_loops(std::span<const std::int32_t> corners) {
  std::vector<Loop> loops;
  Loop path;
  for (const std::int32_t v : corners) {
    const auto seen = std::find(path.begin(), path.end(), v);
    if (seen != path.end()) {
      if (path.end() - seen >= 3) loops.emplace_back(seen, path.end());
      path.erase(seen, path.end());
    }
    path.push_back(v);
  }
  if (path.size() >= 3) loops.push_back(std::move(path));
  return loops;
}

/// The same loop starting at its smallest vertex, so that copies compare equal.
Loop rotated(const Loop& loop) {
  Loop result(loop);
  std::rotate(result.begin(), std::min_element(result.begin(), result.end()), result.end());
  return result;
}

bool repeats_vertex(std::span<const std::int32_t> corners) {
  for (size_t i = 0; i < corners.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if (corners[i] == corners[j]) return true;
  return false;
}

/// A quad of three different corners, one of them twice running: OpenSubdiv refines it as the quad that it is, with an edge of no length.
bool collapsed_quad(std::span<const std::int32_t> corners) {
  if (corners.size() != 4) return false;
  int running = 0;
  for (size_t i = 0; i < 4; ++i) running += corners[i] == corners[(i + 1) % 4];
  return running == 1 && corners[0] != corners[2] && corners[1] != corners[3];
}

/// Faces as loops with the face each came from; the first of several copies stays.
void distinct_loops(const Mesh& cage, std::vector<Loop>& loops, std::vector<std::int32_t>& face_of) {
  std::int32_t first = 0;
  for (size_t f = 0; f < cage.face_count(); ++f) {
    const auto corners = face_corners(cage, first, f);
    first += cage.face_sizes[f];
    // Quadratic in the corners, but outlines are short; the long ones take the sorted way.
    Loop sorted;
    bool repeats = false;
    if (corners.size() > 64) {
      sorted.assign(corners.begin(), corners.end());
      std::sort(sorted.begin(), sorted.end());
      repeats = std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
    } else {
      repeats = repeats_vertex(corners);
    }
    if (!repeats || collapsed_quad(corners)) {
      loops.emplace_back(corners.begin(), corners.end());
      face_of.push_back(static_cast<std::int32_t>(f));
      continue;
    }
    for (Loop& loop : simple_loops(corners)) {
      loops.push_back(std::move(loop));
      face_of.push_back(static_cast<std::int32_t>(f));
    }
  }
  std::vector<Loop> keys(loops.size());
  std::transform(loops.begin(), loops.end(), keys.begin(), rotated);
  std::vector<size_t> order(loops.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&keys](size_t a, size_t b) { return keys[a] != keys[b] ? keys[a] < keys[b] : a < b; });
  std::vector<char> copy(loops.size(), 0);
  for (size_t i = 1; i < order.size(); ++i) copy[order[i]] = keys[order[i]] == keys[order[i - 1]];
  size_t kept = 0;
  for (size_t i = 0; i < loops.size(); ++i) {
    if (copy[i]) continue;
    if (kept != i) loops[kept] = std::move(loops[i]), face_of[kept] = face_of[i];
    ++kept;
  }
  loops.resize(kept), face_of.resize(kept);
}

void keep_used_vertices(const Mesh& cage, const std::vector<Loop>& loops, Mesh& clean) {
  std::vector<std::int32_t> number(cage.vertex_count(), -1);
  for (const Loop& loop : loops)
    for (const std::int32_t v : loop) number[static_cast<size_t>(v)] = 0;
  std::int32_t count = 0;
  for (size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = count++;
    clean.positions.push_back(cage.positions[v]);
    if (!cage.vertex_colors.empty()) clean.vertex_colors.push_back(cage.vertex_colors[v]);
  }
  for (const Loop& loop : loops) {
    clean.face_sizes.push_back(static_cast<std::int32_t>(loop.size()));
    for (const std::int32_t v : loop) clean.corner_vertices.push_back(number[static_cast<size_t>(v)]);
  }
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  if (!cage.creases.empty()) {
    for (const Edge& edge : build_edges(clean)) edges.push_back(std::minmax(edge.vertex_a, edge.vertex_b));
    std::sort(edges.begin(), edges.end());
  }
  for (const Crease& crease : cage.creases) {
    const std::int32_t a = number[static_cast<size_t>(crease.vertex_a)], b = number[static_cast<size_t>(crease.vertex_b)];
    if (a < 0 || b < 0 || !std::binary_search(edges.begin(), edges.end(), std::pair<std::int32_t, std::int32_t>(std::minmax(a, b))))
      continue;
    clean.creases.push_back({a, b, std::min(crease.sharpness, kInfiniteSharpness)});
  }
  for (const CornerTag& corner : cage.corners)
    if (const std::int32_t v = number[static_cast<size_t>(corner.vertex)]; v >= 0)
      clean.corners.push_back({v, std::min(corner.sharpness, kInfiniteSharpness)});
}

void check_triangles(const Mesh& cage, const std::string& file) {
  for (size_t f = 0; f < cage.face_count(); ++f)
    if (cage.face_sizes[f] != 3)
      throw InputError({file, fmt::format("face {}", f + 1), fmt::format("{} corners", cage.face_sizes[f]),
                        "the scheme 'loop' subdivides triangles only", "a mesh of triangles, or the scheme catmark or bilinear"});
}

Sdc::Options scheme_options(const Mesh& mesh) {
  Sdc::Options options;
  options.SetCreasingMethod(mesh.crease_method == CreaseMethod::chaikin ? Sdc::Options::CREASE_CHAIKIN : Sdc::Options::CREASE_UNIFORM);
  options.SetTriangleSubdivision(mesh.triangle_rule == TriangleRule::smooth ? Sdc::Options::TRI_SUB_SMOOTH : Sdc::Options::TRI_SUB_CATMARK);
  switch (mesh.boundary) {
    case BoundaryRule::none:
      options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_NONE);
      break;
    case BoundaryRule::edge_only:
      options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
      break;
    case BoundaryRule::edge_and_corner:
      options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
      break;
  }
  return options;
}

Sdc::SchemeType scheme_type(Scheme scheme) {
  switch (scheme) {
    case Scheme::loop:
      return Sdc::SCHEME_LOOP;
    case Scheme::bilinear:
      return Sdc::SCHEME_BILINEAR;
    case Scheme::catmark:
      break;
  }
  return Sdc::SCHEME_CATMARK;
}

void check_valence(const Mesh& mesh, const std::string& file) {
  constexpr std::int32_t kLimit = 32767;  // OpenSubdiv counts edges and faces at a vertex with 16 bits
  std::vector<std::int32_t> faces_at(mesh.vertex_count(), 0);
  for (const std::int32_t v : mesh.corner_vertices) ++faces_at[static_cast<size_t>(v)];
  const auto most = std::max_element(faces_at.begin(), faces_at.end());
  if (most != faces_at.end() && *most > kLimit)
    throw InputError({file, fmt::format("vertex {}", most - faces_at.begin() + 1), fmt::format("{} faces", *most),
                      "too many faces meet in one vertex to subdivide", fmt::format("at most {}", kLimit)});
}

}  // namespace

const char* name_of(Scheme scheme) {
  switch (scheme) {
    case Scheme::loop:
      return "loop";
    case Scheme::bilinear:
      return "bilinear";
    case Scheme::catmark:
      break;
  }
  return "catmark";
}

Scheme default_scheme(const Mesh& mesh) {
  const auto is_triangle = [](std::int32_t size) { return size == 3; };
  return std::all_of(mesh.face_sizes.begin(), mesh.face_sizes.end(), is_triangle) ? Scheme::loop : Scheme::catmark;
}

CleanCage clean_cage(const Mesh& cage, Scheme scheme, const std::string& file) {
  validate(cage, file);
  if (scheme == Scheme::loop) check_triangles(cage, file);
  CleanCage clean;
  std::vector<Loop> loops;
  distinct_loops(cage, loops, clean.face_of);
  if (loops.empty()) throw InputError({file, "faces", "", "no face has 3 different corners", "at least one face that is not collapsed"});
  keep_used_vertices(cage, loops, clean.mesh);
  clean.mesh.boundary = cage.boundary;
  clean.mesh.crease_method = cage.crease_method;
  clean.mesh.triangle_rule = cage.triangle_rule;
  for (size_t f = 0; f < clean.face_of.size() && !cage.holes.empty(); ++f)
    if (std::binary_search(cage.holes.begin(), cage.holes.end(), clean.face_of[f]))
      clean.mesh.holes.push_back(static_cast<std::int32_t>(f));
  for (const std::int32_t f : clean.face_of) {
    if (!cage.face_materials.empty()) clean.mesh.face_materials.push_back(cage.face_materials[static_cast<size_t>(f)]);
    if (!cage.face_groups.empty()) clean.mesh.face_groups.push_back(cage.face_groups[static_cast<size_t>(f)]);
  }
  copy_names(cage, clean.mesh);
  check_valence(clean.mesh, file);
  return clean;
}

std::unique_ptr<Far::TopologyRefiner> make_refiner(const Mesh& clean, Scheme scheme, const std::string& file) {
  std::vector<std::int32_t> crease_pairs, corner_vertices;
  std::vector<float> crease_weights, corner_weights;
  for (const Crease& crease : clean.creases) {
    crease_pairs.insert(crease_pairs.end(), {crease.vertex_a, crease.vertex_b});
    crease_weights.push_back(crease.sharpness);
  }
  for (const CornerTag& corner : clean.corners) {
    corner_vertices.push_back(corner.vertex);
    corner_weights.push_back(corner.sharpness);
  }
  Far::TopologyDescriptor descriptor;
  descriptor.numVertices = static_cast<int>(clean.vertex_count());
  descriptor.numFaces = static_cast<int>(clean.face_count());
  descriptor.numVertsPerFace = clean.face_sizes.data();
  descriptor.vertIndicesPerFace = clean.corner_vertices.data();
  descriptor.numCreases = static_cast<int>(crease_weights.size());
  descriptor.creaseVertexIndexPairs = crease_pairs.data();
  descriptor.creaseWeights = crease_weights.data();
  descriptor.numCorners = static_cast<int>(corner_weights.size());
  descriptor.cornerVertexIndices = corner_vertices.data();
  descriptor.cornerWeights = corner_weights.data();
  descriptor.numHoles = static_cast<int>(clean.holes.size());
  descriptor.holeIndices = clean.holes.data();
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  std::unique_ptr<Far::TopologyRefiner> refiner(Factory::Create(descriptor, Factory::Options(scheme_type(scheme), scheme_options(clean))));
  if (!refiner)
    throw InputError(
        {file, "", "", "the mesh's topology cannot be subdivided", "faces that meet along edges; 'limn info' lists what is wrong"});
  return refiner;
}

}  // namespace limn
