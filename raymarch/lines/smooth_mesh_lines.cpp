// Lines of the smooth surface that a mesh's vertex normals describe: N.V is interpolated between vertices, and its zeros are chained from
// face to face (Hertzmann & Zorin 2000, "Illustrating smooth surfaces"). Layers are counted on the facets.

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <unordered_map>

#include "raymarch/lines/mesh_layers.h"
#include "raymarch/lines/seams.h"
#include "raymarch/lines/smooth_mesh_lines.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kEdge_px = 1e9;    // meshes are not refined
constexpr double kEndShare = 1e-3;  // of a step
constexpr double kOwnReach = 3.0;   // longest sides of a facet: so near to a curve's own point two hits are its own surface

using Index = std::uint32_t;

struct EdgeUse {
  Index a = 0, b = 0;  ///< The lesser vertex first.
  Index triangle = 0;
};

/// An edge of the mesh with its faces.
struct SmoothEdge {
  Index a = 0, b = 0;
  std::vector<Index> triangles{};
  bool sharp = false;  ///< Normals are not averaged across.
  bool seam = false;   ///< Drawn, or a sheet ends here.
  LineClass line_class = LineClass::crease;
  bool taken = false;
};

class SmoothTracer {
 public:
  SmoothTracer(const LineTask& task, const MeshLayers& layers)
      : task_(task), positions_(layers.tree().positions()), triangles_(layers.tree().triangles()) {}

  std::vector<SurfaceCurve> run() {
    find_edges();
    find_normals();
    std::vector<SurfaceCurve> curves = contours();
    for (const Seam& seam : seams()) curves.push_back(curve_of_seam(task_.camera, seam));
    return curves;
  }

 private:
  glm::dvec3 face_normal(Index t) const {
    const auto& c = triangles_[t].corners;
    const glm::dvec3 normal = glm::cross(positions_[c[1]] - positions_[c[0]], positions_[c[2]] - positions_[c[0]]);
    const double length = glm::length(normal);
    return length > 0.0 ? normal / length : normal;
  }

  void find_edges() {
    std::vector<EdgeUse> uses;
    for (Index t = 0; t < triangles_.size(); ++t) {
      for (size_t k = 0; k < 3; ++k) {
        const Index a = triangles_[t].corners[k], b = triangles_[t].corners[(k + 1) % 3];
        if (a != b) uses.push_back({std::min(a, b), std::max(a, b), t});
      }
    }
    std::sort(uses.begin(), uses.end(),
              [](const EdgeUse& x, const EdgeUse& y) { return std::tie(x.a, x.b, x.triangle) < std::tie(y.a, y.b, y.triangle); });
    edges_of_.resize(triangles_.size());
    const double crease_cosine = std::cos(task_.settings.crease_angle_deg * std::numbers::pi / 180.0);
    for (size_t i = 0; i < uses.size();) {
      SmoothEdge edge{uses[i].a, uses[i].b, {}};
      for (; i < uses.size() && uses[i].a == edge.a && uses[i].b == edge.b; ++i) {
        edge.triangles.push_back(uses[i].triangle);
        edges_of_[uses[i].triangle].push_back(static_cast<Index>(edges_.size()));
      }
      const auto& faces = edge.triangles;
      const bool two = faces.size() == 2;
      const bool folded = two && side_of(faces[0], edge) == side_of(faces[1], edge);  // the faces' orientations disagree
      const bool sharp = !two || folded || glm::dot(face_normal(faces[0]), face_normal(faces[1])) < crease_cosine;
      edge.sharp = sharp;
      edge.seam = sharp || triangles_[faces[0]].material != triangles_[faces[1]].material;
      edge.line_class = faces.size() == 1 ? LineClass::boundary : sharp ? LineClass::crease : LineClass::material;
      edges_.push_back(std::move(edge));
    }
  }
  /// The triangle runs along the edge from its lesser vertex.
  bool side_of(Index t, const SmoothEdge& edge) const {
    const auto& c = triangles_[t].corners;
    const size_t at = static_cast<size_t>(std::find(c.begin(), c.end(), edge.a) - c.begin());
    return c[(at + 1) % 3] == edge.b;
  }

  /// Means of the faces' normals weighted by their angles (Thuermer & Wuethrich 1998), over the faces around a vertex that no sharp edge
  /// parts.
  void find_normals() {
    std::vector<Index> parent(3 * triangles_.size());
    for (Index i = 0; i < parent.size(); ++i) parent[i] = i;
    const auto root = [&](Index i) {
      while (parent[i] != i) i = parent[i] = parent[parent[i]];
      return i;
    };
    for (size_t e = 0; e < edges_.size(); ++e) {
      if (edges_[e].sharp) continue;
      for (const Index vertex : {edges_[e].a, edges_[e].b}) {
        const Index one = root(corner_at(edges_[e].triangles[0], vertex)), other = root(corner_at(edges_[e].triangles[1], vertex));
        parent[std::max(one, other)] = std::min(one, other);
      }
    }
    normals_.assign(parent.size(), glm::dvec3(0.0));
    for (Index i = 0; i < parent.size(); ++i) {
      const auto& c = triangles_[i / 3].corners;
      const glm::dvec3 &p = positions_[c[i % 3]], x = positions_[c[(i + 1) % 3]] - p, y = positions_[c[(i + 2) % 3]] - p;
      normals_[root(i)] += std::atan2(glm::length(glm::cross(x, y)), glm::dot(x, y)) * face_normal(i / 3);
    }
    facing_.resize(parent.size());
    for (Index i = 0; i < parent.size(); ++i) {
      if (root(i) == i && glm::length(normals_[i]) > 0.0) normals_[i] = glm::normalize(normals_[i]);
      normals_[i] = normals_[root(i)];
      facing_[i] = glm::dot(normals_[i], view_vector(task_.camera, positions_[triangles_[i / 3].corners[i % 3]]));
    }
  }
  Index corner_at(Index t, Index vertex) const {
    const auto& c = triangles_[t].corners;
    return 3 * t + static_cast<Index>(std::find(c.begin(), c.end(), vertex) - c.begin());
  }

  bool crosses(Index t, const SmoothEdge& edge) const {
    return (facing_[corner_at(t, edge.a)] > 0.0) != (facing_[corner_at(t, edge.b)] > 0.0);
  }

  /// N.V's zeros: each triangle whose corners differ is left through two of its edges.
  std::vector<SurfaceCurve> contours() {
    std::vector<SurfaceCurve> curves;
    std::vector<bool> taken(triangles_.size(), false);
    // Those that end on seams first, from there.
    for (Index e = 0; e < edges_.size(); ++e) {
      if (!edges_[e].sharp) continue;
      for (const Index t : edges_[e].triangles) {
        if (!taken[t] && crosses(t, edges_[e])) add(trace(t, e, taken), curves);
      }
    }
    for (Index t = 0; t < triangles_.size(); ++t) {
      if (taken[t]) continue;
      for (const Index e : edges_of_[t]) {
        if (!crosses(t, edges_[e])) continue;
        add(trace(t, e, taken), curves);
        break;
      }
    }
    return curves;
  }
  void add(SurfaceCurve curve, std::vector<SurfaceCurve>& curves) const {
    if (curve.samples.size() < 2) return;
    set_fold(task_.camera, curve);
    curves.push_back(std::move(curve));
  }

  SurfaceCurve trace(Index t, Index entry, std::vector<bool>& taken) const {
    SurfaceCurve curve{false, true, {}};
    curve.samples.push_back(sample_on(t, edges_[entry]));
    for (Index e = entry;;) {
      taken[t] = true;
      const auto next =
          std::find_if(edges_of_[t].begin(), edges_of_[t].end(), [&](Index other) { return other != e && crosses(t, edges_[other]); });
      if (next == edges_of_[t].end()) return curve;
      e = *next;
      if (e == entry) {
        curve.closed = curve.samples.size() > 2;
        return curve;
      }
      curve.samples.push_back(sample_on(t, edges_[e]));
      if (edges_[e].sharp) return curve;
      const auto& faces = edges_[e].triangles;
      t = faces[0] == t ? faces[1] : faces[0];
      if (taken[t]) return curve;
    }
  }

  /// How N.V changes towards the eye along a face, per world unit: the radial curvature of what is interpolated.
  double bend_of(Index t) const {
    const auto& c = triangles_[t].corners;
    const glm::dvec3 x = positions_[c[1]] - positions_[c[0]], y = positions_[c[2]] - positions_[c[0]];
    const double xx = glm::dot(x, x), xy = glm::dot(x, y), yy = glm::dot(y, y), determinant = xx * yy - xy * xy;
    if (!(determinant > 0.0)) return 0.0;
    const double fx = facing_[3 * t + 1] - facing_[3 * t], fy = facing_[3 * t + 2] - facing_[3 * t];
    const glm::dvec3 gradient = ((yy * fx - xy * fy) * x + (xx * fy - xy * fx) * y) / determinant;
    return glm::dot(gradient, view_vector(task_.camera, positions_[c[0]]));
  }

  CurveSample sample_on(Index t, const SmoothEdge& edge) const {
    const Index a = corner_at(t, edge.a), b = corner_at(t, edge.b);
    const double share = facing_[a] / (facing_[a] - facing_[b]);
    CurveSample sample;
    sample.p = glm::mix(positions_[edge.a], positions_[edge.b], share);
    sample.high = sample.low = glm::normalize(glm::mix(normals_[a], normals_[b], share));
    // Of the faces on both sides; at a seam of the curve's own.
    sample.radial_curvature = !edge.sharp ? 0.5 * (bend_of(edge.triangles[0]) + bend_of(edge.triangles[1])) : bend_of(t);
    sample.lift = sample.radial_curvature < 0.0 ? -sample.high : sample.high;
    sample.line_class = LineClass::contour;
    sample.object = triangles_[t].object;
    project_sample(task_.camera, sample);
    return sample;
  }

  std::vector<Seam> seams() {
    for (Index e = 0; e < edges_.size(); ++e) {
      if (!edges_[e].seam) continue;
      seams_at_[edges_[e].a].push_back(e);
      seams_at_[edges_[e].b].push_back(e);
    }
    std::vector<Seam> seams;
    for (const bool from_ends : {true, false}) {
      for (Index e = 0; e < edges_.size(); ++e) {
        for (const Index vertex : {edges_[e].a, edges_[e].b}) {
          if (edges_[e].seam && !edges_[e].taken && (!from_ends || ends_at(vertex))) seams.push_back(walk(e, vertex));
        }
      }
    }
    return seams;
  }
  bool ends_at(Index vertex) const {
    const auto& edges = seams_at_.at(vertex);
    if (edges.size() != 2) return true;
    const SmoothEdge &one = edges_[edges[0]], &other = edges_[edges[1]];
    return one.line_class != other.line_class || one.triangles.size() != other.triangles.size() || one.triangles.size() > 2;
  }
  Seam walk(Index e, Index start) {
    Seam seam{false, edges_[e].line_class, {}};
    Index vertex = start;
    for (;;) {
      edges_[e].taken = true;
      const Index next = edges_[e].a == vertex ? edges_[e].b : edges_[e].a;
      seam.samples.push_back(seam_sample(edges_[e], vertex, vertex));
      if (next == start && !ends_at(start)) {
        seam.closed = seam.samples.size() > 2;
        if (seam.closed) return seam;
      }
      if (next == start || ends_at(next)) {
        seam.samples.push_back(seam_sample(edges_[e], next, vertex));
        return seam;
      }
      const auto& here = seams_at_.at(next);
      e = here[0] == e ? here[1] : here[0];
      vertex = next;
    }
  }
  /// At a vertex, with the edge's faces: those whose orientation runs along the walk from `from` first.
  SeamSample seam_sample(const SmoothEdge& edge, Index vertex, Index from) const {
    SeamSample sample{positions_[vertex], {}, triangles_[edge.triangles[0]].object};
    const glm::dvec3 v = view_vector(task_.camera, sample.p);
    std::vector<Index> faces = edge.triangles;
    std::stable_partition(faces.begin(), faces.end(), [&](Index t) { return side_of(t, edge) == (from == edge.a); });
    for (const Index t : faces) {
      const auto& c = triangles_[t].corners;
      const Index apex = *std::find_if(c.begin(), c.end(), [&](Index corner) { return corner != edge.a && corner != edge.b; });
      const glm::dvec3& normal = normals_[corner_at(t, vertex)];
      sample.sides.push_back({normal, positions_[apex] - 0.5 * (positions_[edge.a] + positions_[edge.b]), glm::dot(normal, v)});
    }
    return sample;
  }

  const LineTask& task_;
  const std::vector<glm::dvec3>& positions_;
  const std::vector<LayerTriangle>& triangles_;
  std::vector<SmoothEdge> edges_;
  std::vector<std::vector<Index>> edges_of_;  ///< Of triangles.
  std::vector<glm::dvec3> normals_;           ///< Of corners.
  std::vector<double> facing_;                ///< N.V of corners.
  std::unordered_map<Index, std::vector<Index>> seams_at_;
};

/// Facets beside the smooth surface's contour turn the other way, a little: a ray from it that goes in and out of them near by meets
/// nothing.
int layers_beyond_own(const MeshLayers& layers, const CurveSample& sample) {
  const std::vector<LayerHit> hits = layers.hits_to_eye(sample);
  const auto own = std::count_if(hits.begin(), hits.end(), [&](const LayerHit& hit) {
    const auto& c = layers.tree().triangles()[hit.triangle].corners;
    const std::vector<glm::dvec3>& p = layers.tree().positions();
    return hit.t <
           kOwnReach * std::max({glm::distance(p[c[0]], p[c[1]]), glm::distance(p[c[1]], p[c[2]]), glm::distance(p[c[2]], p[c[0]])});
  });
  return static_cast<int>(hits.size()) - 2 * static_cast<int>(own / 2);
}

}  // namespace

LineContribution smooth_mesh_lines(const LineTask& task, const std::vector<size_t>& objects) {
  LineContribution out;
  const auto layers = std::make_shared<const MeshLayers>(task, objects, kEdge_px, true);
  out.curves = SmoothTracer(task, *layers).run();
  add_mesh_layers(layers, out);
  for (SurfaceCurve& curve : out.curves) {
    if (curve.closed || curve.samples.size() < 2) continue;
    // Where a contour ends on a crease it meets the crease's other face, and does not go through it.
    std::erase_if(curve.samples.front().pierced, [](const Piercing& one) { return one.t < kEndShare; });
    std::erase_if(curve.samples[curve.samples.size() - 2].pierced, [](const Piercing& one) { return one.t > 1.0 - kEndShare; });
  }
  out.layers_before = [layers](const CurveSample& sample) { return LayersSeen{layers_beyond_own(*layers, sample)}; };
  out.exact = false;
  out.notes.emplace_back("contours are those of N.V interpolated between the mesh's vertices; what hides them is the facets");
  return out;
}

}  // namespace limn
