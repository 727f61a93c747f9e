#include "subdiv/refine.h"

#include <fmt/format.h>
#include <opensubdiv/far/primvarRefiner.h>

#include <algorithm>
#include <limits>

#include "sdf/memory_text.h"
#include "sdf/size_error.h"
#include "subdiv/opensubdiv_cage.h"

namespace limn {
namespace {

using Primvars = Far::PrimvarRefinerReal<double>;

void check_size(const RefinedSize& size, const RefineSettings& settings, const std::string& file) {
  // Corner indices are 32-bit; four corners a face.
  const bool countable = size.faces <= std::numeric_limits<std::int32_t>::max() / 4;
  if (size.bytes <= settings.max_bytes && countable) return;
  throw SizeError({file, "level", fmt::format("{}", settings.level),
                   fmt::format("the refined mesh has {} vertices and {} faces and needs {}", size.vertices, size.faces,
                               memory_text(static_cast<double>(size.bytes))),
                   fmt::format("a lower level (at most {})", memory_text(static_cast<double>(settings.max_bytes)))});
}

/// Sharp edges or vertices, as those of borders are, too.
bool has_sharpness(const Far::TopologyLevel& level) {
  for (int e = 0; e < level.GetNumEdges(); ++e)
    if (level.GetEdgeSharpness(e) > 0.0f) return true;
  for (int v = 0; v < level.GetNumVertices(); ++v)
    if (level.GetVertexSharpness(v) > 0.0f) return true;
  return false;
}

/// The points of the last level, from those of the cage.
Points interpolate(const Far::TopologyRefiner& refiner, Points points) {
  const Primvars primvars(refiner);
  for (int l = 1; l <= refiner.GetMaxLevel(); ++l) {
    Points finer(static_cast<size_t>(refiner.GetLevel(l).GetNumVertices()));
    primvars.Interpolate(l, points, finer);
    points = std::move(finer);
  }
  return points;
}

Points cage_points(const Mesh& cage) {
  Points points(cage.vertex_count());
  for (size_t v = 0; v < points.size(); ++v) points[v].p = cage.positions[v];
  return points;
}

/// Level 0 on the limit: the masks need quads, so one refinement is made and read at the children of the cage's vertices and corners.
void pull_back_to_cage(Refined& refined) {
  const Far::TopologyLevel &base = refined.refiner.GetLevel(0), &children = refined.refiner.GetLevel(1);
  Points positions(static_cast<size_t>(base.GetNumVertices())), colors;
  if (!refined.colors.empty()) colors.resize(positions.size());
  for (int v = 0; v < base.GetNumVertices(); ++v) {
    const auto child = static_cast<size_t>(base.GetVertexChildVertex(v));
    positions[static_cast<size_t>(v)] = refined.positions[child];
    if (!colors.empty()) colors[static_cast<size_t>(v)] = refined.colors[child];
  }
  std::vector<glm::vec3> normals;
  std::vector<size_t> first;
  size_t sum = 0;
  for (int f = 0; f < children.GetNumFaces(); ++f) first.push_back(sum), sum += static_cast<size_t>(children.GetFaceVertices(f).size());
  for (int f = 0; f < base.GetNumFaces() && !refined.normals.empty(); ++f) {
    const Far::ConstIndexArray vertices = base.GetFaceVertices(f), pieces = base.GetFaceChildFaces(f);
    for (int i = 0; i < vertices.size(); ++i) {
      const Far::ConstIndexArray corners = children.GetFaceVertices(pieces[i]);
      const auto at = std::find(corners.begin(), corners.end(), base.GetVertexChildVertex(vertices[i])) - corners.begin();
      normals.push_back(refined.normals[first[static_cast<size_t>(pieces[i])] + static_cast<size_t>(at)]);
    }
  }
  refined.positions = std::move(positions), refined.colors = std::move(colors), refined.normals = std::move(normals);
}

/// Moves onto the limit what is to be there, and finds the normals.
void to_limit(const RefineSettings& settings, Refined& refined) {
  LimitFrame limit = limit_frame(refined.refiner, settings.scheme, refined.positions);
  if (settings.normals == NormalKind::limit) refined.normals = limit_normals(refined.refiner, settings.scheme, refined.positions, limit);
  if (!settings.to_limit) return;
  refined.positions = std::move(limit.positions);
  if (refined.colors.empty()) return;
  Points colors(refined.colors.size());
  const Primvars primvars(refined.refiner);
  primvars.Limit(refined.colors, colors);
  refined.colors = std::move(colors);
}

}  // namespace

Mesh refine(const Mesh& cage, const RefineSettings& settings, const std::string& file) {
  if (settings.level < 0 || settings.level > 8)
    throw InputError({file, "level", fmt::format("{}", settings.level), "the subdivision level is out of range", "0 to 8"});
  const CleanCage clean = clean_cage(cage, settings.scheme, file);
  const std::unique_ptr<Far::TopologyRefiner> refiner = make_refiner(clean.mesh, settings.scheme, file);
  const bool limit = settings.to_limit || settings.normals == NormalKind::limit;
  const int levels = limit ? std::max(settings.level, 1) : settings.level;
  RefinedSize size = predict_from_base(*refiner, settings.scheme, settings.level, !cage.vertex_colors.empty());
  if (size.faces == 0)
    throw InputError({file, "boundary", "none", "every face touches an open edge, where this rule leaves no surface",
                      "the boundary rule edge_only or edge_and_corner"});
  size.bytes = std::max(size.bytes, predict_from_base(*refiner, settings.scheme, levels, !cage.vertex_colors.empty()).bytes);
  check_size(size, settings, file);

  if (levels > 0) {
    Far::TopologyRefiner::UniformOptions options(levels);
    // Without limits and sharpness nobody asks the last level for more than the vertices of its faces.
    options.fullTopologyInLastLevel = limit || has_sharpness(refiner->GetLevel(0));
    refiner->RefineUniform(options);
  }
  Refined refined{*refiner, interpolate(*refiner, cage_points(clean.mesh)), {}, {}};
  if (!clean.mesh.vertex_colors.empty()) {
    Points colors(clean.mesh.vertex_count());
    for (size_t v = 0; v < colors.size(); ++v) colors[v].p = clean.mesh.vertex_colors[v];
    refined.colors = interpolate(*refiner, std::move(colors));
  }
  if (limit) to_limit(settings, refined);
  if (levels != settings.level) {
    pull_back_to_cage(refined);
    if (!settings.to_limit) refined.positions = cage_points(clean.mesh);
  }
  return as_mesh(std::move(refined), clean.mesh, settings.level, settings.keep_holes);
}

}  // namespace limn
