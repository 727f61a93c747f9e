#include "subdiv/audit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "subdiv/polygon.h"

namespace limn {
namespace {

/// Angles below this make a face's normal and its neighbours' interpolation unreliable (Schwarz's lantern).
constexpr double kSliverAngle = std::numbers::pi / 180.0;

Finding finding(std::string check, Severity bad, std::int64_t count, const std::string& good_message, const std::string& bad_message) {
  return {std::move(check), count > 0 ? bad : Severity::info, static_cast<double>(count), count > 0 ? bad_message : good_message};
}

struct EdgeCounts {
  std::int64_t open = 0, non_manifold = 0, inconsistent = 0;
};

EdgeCounts count_edges(const std::vector<Edge>& edges) {
  EdgeCounts counts;
  for (const Edge& edge : edges) {
    counts.open += edge.face_count == 1;
    counts.non_manifold += edge.face_count > 2;
    counts.inconsistent += edge.face_count == 2 && !edge.consistent;
  }
  return counts;
}

std::int64_t count_duplicates(const Mesh& mesh) {
  std::vector<std::vector<std::int32_t>> faces(mesh.face_count());
  std::int32_t first = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = face_corners(mesh, first, f);
    faces[f].assign(corners.begin(), corners.end());
    std::sort(faces[f].begin(), faces[f].end());
    first += mesh.face_sizes[f];
  }
  std::sort(faces.begin(), faces.end());
  std::int64_t duplicates = 0;
  for (size_t f = 1; f < faces.size(); ++f) duplicates += faces[f] == faces[f - 1];
  return duplicates;
}

struct FaceCounts {
  std::int64_t zero_area = 0, slivers = 0;
  double smallest_angle = std::numbers::pi;
};

FaceCounts count_faces(const Mesh& mesh) {
  FaceCounts counts;
  std::vector<glm::dvec3> corners;
  std::int32_t first = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    gather_corners(mesh, face_corners(mesh, first, f), corners);
    first += mesh.face_sizes[f];
    if (zero_area(corners)) {
      ++counts.zero_area;
      continue;
    }
    const glm::dvec3 normal = vector_area(corners);
    double smallest = std::numbers::pi;
    for (size_t i = 0; i < corners.size(); ++i) smallest = std::min(smallest, corner_angle(corners, i, normal));
    counts.slivers += smallest < kSliverAngle;
    counts.smallest_angle = std::min(counts.smallest_angle, smallest);
  }
  return counts;
}

struct PartCounts {
  std::int32_t parts = 0;
  std::int64_t closed = 0, inverted = 0;
};

/// A closed part whose faces look inwards encloses a negative volume. Parts inside others (the wall of a cavity) do so rightly:
/// the message says so, the number stands.
PartCounts count_parts(const Mesh& mesh, const std::vector<Edge>& edges) {
  PartCounts counts;
  std::vector<std::int32_t> part;
  counts.parts = part_of_faces(mesh, part);
  std::vector<char> closed(static_cast<size_t>(counts.parts), 1);
  for (const Edge& edge : edges)
    if (edge.face_count != 2 || !edge.consistent) closed[static_cast<size_t>(part[static_cast<size_t>(edge.face_a)])] = 0;
  const glm::dvec3 center = bounds(mesh).center();
  std::vector<double> volume(static_cast<size_t>(counts.parts), 0.0);
  std::vector<glm::dvec3> corners;
  std::int32_t first = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    gather_corners(mesh, face_corners(mesh, first, f), corners);
    for (size_t i = 2; i < corners.size(); ++i)
      volume[static_cast<size_t>(part[f])] += glm::dot(corners[0] - center, glm::cross(corners[i - 1] - center, corners[i] - center)) / 6.0;
    first += mesh.face_sizes[f];
  }
  for (size_t p = 0; p < closed.size(); ++p) {
    counts.closed += closed[p];
    counts.inverted += closed[p] && volume[p] < 0.0;
  }
  return counts;
}

struct VertexCounts {
  std::int64_t unused = 0, extraordinary = 0;
  int regular_valence = 6;
};

VertexCounts count_vertices(const Mesh& mesh, const std::vector<Edge>& edges) {
  VertexCounts counts;
  const auto quads = std::count(mesh.face_sizes.begin(), mesh.face_sizes.end(), 4);
  const auto triangles = std::count(mesh.face_sizes.begin(), mesh.face_sizes.end(), 3);
  counts.regular_valence = quads >= triangles ? 4 : 6;
  std::vector<std::int32_t> valence(mesh.vertex_count(), 0);
  std::vector<char> on_border(mesh.vertex_count(), 0);
  for (const Edge& edge : edges)
    for (const std::int32_t v : {edge.vertex_a, edge.vertex_b}) {
      ++valence[static_cast<size_t>(v)];
      if (edge.face_count != 2) on_border[static_cast<size_t>(v)] = 1;
    }
  // On a border half the plane is there: 3 edges among quads, 4 among triangles; a corner of a grid has 2.
  const int border_valence = counts.regular_valence == 4 ? 3 : 4;
  for (size_t v = 0; v < valence.size(); ++v) {
    counts.unused += valence[v] == 0;
    if (valence[v] == 0) continue;
    counts.extraordinary += on_border[v] ? (valence[v] != border_valence && valence[v] != 2) : valence[v] != counts.regular_valence;
  }
  return counts;
}

}  // namespace

std::vector<Finding> audit(const Mesh& mesh) {
  const std::vector<Edge> edges = build_edges(mesh);
  const EdgeCounts edge = count_edges(edges);
  const FaceCounts face = count_faces(mesh);
  const PartCounts part = count_parts(mesh, edges);
  const VertexCounts vertex = count_vertices(mesh, edges);
  const std::int64_t duplicates = count_duplicates(mesh);
  std::vector<Finding> findings;
  findings.push_back(
      {"parts", Severity::info, static_cast<double>(part.parts),
       fmt::format("{} part{} connected by vertices, {} of them closed", part.parts, part.parts == 1 ? "" : "s", part.closed)});
  findings.push_back(finding("open edges", Severity::warning, edge.open, "no open edges: the surface is closed",
                             fmt::format("{} edges have a face on one side only: holes or a sheet", edge.open)));
  findings.push_back(
      finding("non-manifold edges", Severity::warning, edge.non_manifold, "no edge has more than two faces",
              fmt::format("{} edges have more than two faces: inside and outside are not certain there", edge.non_manifold)));
  findings.push_back(finding("duplicate faces", Severity::warning, duplicates, "no face is there twice",
                             fmt::format("{} faces have the same vertices as another", duplicates)));
  findings.push_back(finding("zero-area faces", Severity::warning, face.zero_area, "every face has an area",
                             fmt::format("{} faces have no area; they are ignored", face.zero_area)));
  findings.push_back(finding("inconsistent orientation", Severity::warning, edge.inconsistent, "neighbouring faces agree on their outside",
                             fmt::format("{} edges join faces that disagree on the outside", edge.inconsistent)));
  findings.push_back(
      finding("inverted parts", Severity::warning, part.inverted, "no closed part is turned inside out",
              fmt::format("{} closed parts enclose a negative volume: turned inside out, or walls of a cavity", part.inverted)));
  findings.push_back({"extraordinary vertices", Severity::info, static_cast<double>(vertex.extraordinary),
                      fmt::format("{} vertices with a valence other than {}", vertex.extraordinary, vertex.regular_valence)});
  findings.push_back(finding("slivers", Severity::warning, face.slivers,
                             fmt::format("the smallest angle is {:.2f} degrees", face.smallest_angle * 180.0 / std::numbers::pi),
                             fmt::format("{} faces have an angle below 1 degree (smallest {:.3g}): their normals do not converge",
                                         face.slivers, face.smallest_angle * 180.0 / std::numbers::pi)));
  findings.push_back(finding("unused vertices", Severity::info, vertex.unused, "every vertex is used by a face",
                             fmt::format("{} vertices are used by no face", vertex.unused)));
  return findings;
}

}  // namespace limn
