#include <algorithm>
#include <utility>

#include "sdf/parallel.h"
#include "subdiv/opensubdiv_cage.h"

namespace limn {
namespace {

/// The base face of each face of a level.
std::vector<std::int32_t> ancestors(const Far::TopologyRefiner& refiner, int level_number) {
  std::vector<std::int32_t> of(static_cast<size_t>(refiner.GetLevel(0).GetNumFaces()));
  for (size_t f = 0; f < of.size(); ++f) of[f] = static_cast<std::int32_t>(f);
  for (int l = 1; l <= level_number; ++l) {
    const Far::TopologyLevel& level = refiner.GetLevel(l);
    std::vector<std::int32_t> finer(static_cast<size_t>(level.GetNumFaces()));
    parallel_parts(finer.size(), size_t{16384}, [&](const IndexRange<size_t>& range) {
      for (size_t f = range.begin(); f < range.end(); ++f) finer[f] = of[static_cast<size_t>(level.GetFaceParentFace(static_cast<int>(f)))];
    });
    of = std::move(finer);
  }
  return of;
}

/// Sharpness that is left, for edges and vertices that have it by their own and not by lying on a border.
void copy_tags(const Far::TopologyLevel& level, const std::vector<std::int32_t>& number, Mesh& mesh) {
  constexpr int kTogether = 16384;
  std::vector<std::vector<Crease>> parts(static_cast<size_t>((level.GetNumEdges() + kTogether - 1) / kTogether));
  parallel_each(parts.size(), [&](size_t part) {
    const int first = static_cast<int>(part) * kTogether;
    for (int e = first; e < std::min(first + kTogether, level.GetNumEdges()); ++e) {
      const float sharpness = level.GetEdgeSharpness(e);
      if (!(sharpness > 0.0f) || level.IsEdgeBoundary(e)) continue;
      const Far::ConstIndexArray ends = level.GetEdgeVertices(e);
      const std::int32_t a = number[static_cast<size_t>(ends[0])], b = number[static_cast<size_t>(ends[1])];
      if (a >= 0 && b >= 0) parts[part].push_back({a, b, sharpness});
    }
  });
  for (const std::vector<Crease>& part : parts) mesh.creases.insert(mesh.creases.end(), part.begin(), part.end());
  for (int v = 0; v < level.GetNumVertices(); ++v) {
    const float sharpness = level.GetVertexSharpness(v);
    if (sharpness > 0.0f && number[static_cast<size_t>(v)] >= 0) mesh.corners.push_back({number[static_cast<size_t>(v)], sharpness});
  }
}

/// A run of the level's faces, and where what is kept of it starts.
struct FaceRun {
  int first = 0, last = 0;
  size_t level_corner = 0, mesh_face = 0, mesh_corner = 0;
};

/// Makes room in the mesh; its holes are set.
std::vector<FaceRun> lay_out_faces(const Far::TopologyLevel& level, bool keep_holes, Mesh& mesh) {
  constexpr int kTogether = 8192;
  std::vector<FaceRun> runs;
  size_t level_corner = 0, mesh_face = 0, mesh_corner = 0;
  for (int f = 0; f < level.GetNumFaces(); ++f) {
    if (f % kTogether == 0) runs.push_back({f, std::min(f + kTogether, level.GetNumFaces()), level_corner, mesh_face, mesh_corner});
    const auto corners = static_cast<size_t>(level.GetFaceVertices(f).size());
    level_corner += corners;
    const bool hole = level.IsFaceHole(f);
    if (hole && keep_holes) mesh.holes.push_back(static_cast<std::int32_t>(mesh_face));
    if (hole && !keep_holes) continue;
    ++mesh_face;
    mesh_corner += corners;
  }
  mesh.face_sizes.resize(mesh_face);
  mesh.corner_vertices.resize(mesh_corner);
  return runs;
}

/// `normals`: empty where the mesh has them already, or none.
void copy_run(const Far::TopologyLevel& level, const FaceRun& run, const std::vector<std::int32_t>& number,
              const std::vector<glm::vec3>& normals, bool keep_holes, Mesh& mesh) {
  size_t from = run.level_corner, to = run.mesh_corner, face = run.mesh_face;
  for (int f = run.first; f < run.last; ++f) {
    const Far::ConstIndexArray vertices = level.GetFaceVertices(f);
    const auto corners = static_cast<size_t>(vertices.size());
    const bool kept = keep_holes || !level.IsFaceHole(f);
    if (kept) {
      mesh.face_sizes[face++] = vertices.size();
      for (size_t i = 0; i < corners; ++i) mesh.corner_vertices[to + i] = number[static_cast<size_t>(vertices[static_cast<int>(i)])];
      if (!normals.empty()) std::copy_n(normals.data() + from, corners, mesh.corner_normals.data() + to);
      to += corners;
    }
    from += corners;
  }
}

void copy_faces(const Far::TopologyLevel& level, const std::vector<std::int32_t>& ancestor, const std::vector<std::int32_t>& number,
                std::vector<glm::vec3> normals, const Mesh& cage, bool keep_holes, Mesh& mesh) {
  const std::vector<FaceRun> runs = lay_out_faces(level, keep_holes, mesh);
  if (normals.size() == mesh.corner_vertices.size())
    mesh.corner_normals = std::exchange(normals, {});
  else if (!normals.empty())
    mesh.corner_normals.resize(mesh.corner_vertices.size());
  if (!cage.face_materials.empty()) mesh.face_materials.resize(mesh.face_sizes.size());
  if (!cage.face_groups.empty()) mesh.face_groups.resize(mesh.face_sizes.size());
  parallel_each(runs.size(), [&](size_t i) {
    copy_run(level, runs[i], number, normals, keep_holes, mesh);
    size_t face = runs[i].mesh_face;
    for (int f = runs[i].first; f < runs[i].last; ++f) {
      if (!keep_holes && level.IsFaceHole(f)) continue;
      const auto parent = static_cast<size_t>(ancestor[static_cast<size_t>(f)]);
      if (!cage.face_materials.empty()) mesh.face_materials[face] = cage.face_materials[parent];
      if (!cage.face_groups.empty()) mesh.face_groups[face] = cage.face_groups[parent];
      ++face;
    }
  });
}

/// The vertices that faces keep; returns the number of each, -1 for the others.
std::vector<std::int32_t> copy_vertices(const Far::TopologyLevel& level, const Refined& refined, bool keep_holes, Mesh& mesh) {
  const std::vector<char> used = used_vertices(level, keep_holes);
  std::vector<std::int32_t> number(used.size(), -1);
  std::int32_t count = 0;
  for (size_t v = 0; v < number.size(); ++v)
    if (used[v]) number[v] = count++;
  mesh.positions.resize(static_cast<size_t>(count));
  if (!refined.colors.empty()) mesh.vertex_colors.resize(mesh.positions.size());
  parallel_parts(number.size(), size_t{16384}, [&](const IndexRange<size_t>& range) {
    for (size_t v = range.begin(); v < range.end(); ++v) {
      if (!used[v]) continue;
      const auto to = static_cast<size_t>(number[v]);
      mesh.positions[to] = refined.positions[v].p;
      if (!refined.colors.empty()) mesh.vertex_colors[to] = glm::vec3(glm::max(refined.colors[v].p, 0.0));
    }
  });
  return number;
}

}  // namespace

Mesh as_mesh(Refined refined, const Mesh& cage, int level_number, bool keep_holes) {
  const Far::TopologyLevel& level = refined.refiner.GetLevel(level_number);
  Mesh mesh;
  const std::vector<std::int32_t> number = copy_vertices(level, refined, keep_holes, mesh);
  copy_faces(level, ancestors(refined.refiner, level_number), number, std::move(refined.normals), cage, keep_holes, mesh);
  copy_tags(level, number, mesh);
  copy_names(cage, mesh);
  mesh.boundary = cage.boundary;
  mesh.crease_method = cage.crease_method;
  // At level 0 triangles are left to subdivide, later there are quads only.
  if (level_number == 0) mesh.triangle_rule = cage.triangle_rule;
  return mesh;
}

}  // namespace limn
