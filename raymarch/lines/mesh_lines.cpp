// Lines of meshes as they are: edges between a face that faces the eye and one that does not, open edges, sharp edges, edges of materials,
// chained. Everything about a polyhedron is exact: what hides an edge beside a vertex, the faces around the vertex say.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "raymarch/lines/mesh_layers.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kEdge_px = 1e9;  // meshes are not refined

struct EdgeUse {
  std::uint32_t a = 0, b = 0;  ///< The lesser vertex first.
  std::uint32_t triangle = 0;
};

/// An edge that is drawn, or that hides what is behind it.
struct MeshEdge {
  std::uint32_t a = 0, b = 0;
  LineClass line_class = LineClass::crease;
  int more_on_left = 0;  ///< From a to b.
  int object = 1;
  glm::dvec3 high{0.0}, low{0.0};
  bool taken = false;
};

class MeshTracer {
 public:
  MeshTracer(const LineTask& task, const MeshLayers& layers)
      : task_(task),
        positions_(layers.tree().positions()),
        triangles_(layers.tree().triangles()),
        crease_cosine_(std::cos(task.settings.crease_angle_deg * std::numbers::pi / 180.0)) {}

  std::vector<SurfaceCurve> run() {
    find_normals();
    find_edges();
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      at_vertex_[edges_[e].a].push_back(e);
      at_vertex_[edges_[e].b].push_back(e);
    }
    find_stars();
    std::vector<SurfaceCurve> curves;
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      for (const std::uint32_t vertex : {edges_[e].a, edges_[e].b}) {
        if (!edges_[e].taken && ends_at(vertex)) curves.push_back(walk(e, vertex));
      }
    }
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      if (!edges_[e].taken) curves.push_back(walk(e, edges_[e].a));
    }
    return curves;
  }

 private:
  void find_normals() {
    normals_.resize(triangles_.size());
    facing_.resize(triangles_.size());
    parallel_for(size_t{0}, triangles_.size(), [&](size_t i) {
      const auto& c = triangles_[i].corners;
      const glm::dvec3 normal = glm::cross(positions_[c[1]] - positions_[c[0]], positions_[c[2]] - positions_[c[0]]);
      const double length = glm::length(normal);
      normals_[i] = length > 0.0 ? normal / length : normal;
      facing_[i] = glm::dot(normals_[i], view_vector(task_.camera, positions_[c[0]]));
    });
  }

  void find_edges() {
    std::vector<EdgeUse> uses;
    uses.reserve(3 * triangles_.size());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      for (size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = triangles_[t].corners[k], b = triangles_[t].corners[(k + 1) % 3];
        if (a != b) uses.push_back({std::min(a, b), std::max(a, b), t});
      }
    }
    std::sort(uses.begin(), uses.end(),
              [](const EdgeUse& x, const EdgeUse& y) { return std::tie(x.a, x.b, x.triangle) < std::tie(y.a, y.b, y.triangle); });
    for (size_t i = 0; i < uses.size();) {
      size_t end = i;
      while (end < uses.size() && uses[end].a == uses[i].a && uses[end].b == uses[i].b) ++end;
      add_edge(std::span(uses).subspan(i, end - i));
      i = end;
    }
  }

  /// 1 where the triangle lies on the left of the way from a to b in the image, -1 on the right.
  int side_of(const EdgeUse& use) const {
    const auto& c = triangles_[use.triangle].corners;
    const size_t at = static_cast<size_t>(std::find(c.begin(), c.end(), use.a) - c.begin());
    const bool forward = c[(at + 1) % 3] == use.b;
    return forward == (facing_[use.triangle] > 0.0) ? 1 : -1;
  }

  void add_edge(std::span<const EdgeUse> uses) {
    MeshEdge edge{uses[0].a, uses[0].b};
    int left = 0;
    for (const EdgeUse& use : uses) left += side_of(use) > 0;
    const int all = static_cast<int>(uses.size());
    edge.more_on_left = 2 * left - all;
    edge.object = triangles_[uses[0].triangle].object;
    const auto lower = [&](const EdgeUse& x, const EdgeUse& y) { return facing_[x.triangle] < facing_[y.triangle]; };
    edge.high = normals_[std::max_element(uses.begin(), uses.end(), lower)->triangle];
    edge.low = normals_[std::min_element(uses.begin(), uses.end(), lower)->triangle];
    const bool materials = std::any_of(uses.begin(), uses.end(), [&](const EdgeUse& use) {
      return triangles_[use.triangle].material != triangles_[uses[0].triangle].material;
    });
    if (all == 1) {
      edge.line_class = LineClass::boundary;
    } else if (left == 0 || left == all) {
      edge.line_class = LineClass::contour;
    } else if (all > 2 || glm::dot(normals_[uses[0].triangle], normals_[uses[1].triangle]) < crease_cosine_) {
      edge.line_class = LineClass::crease;
    } else if (materials) {
      edge.line_class = LineClass::material;
    } else {
      return;
    }
    edges_.push_back(edge);
  }

  /// The triangles around each vertex that an edge ends at.
  void find_stars() {
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      for (const std::uint32_t corner : triangles_[t].corners) {
        if (const auto at = at_vertex_.find(corner); at != at_vertex_.end()) stars_[corner].push_back(t);
      }
    }
  }

  bool ends_at(std::uint32_t vertex) const {
    const auto& edges = at_vertex_.at(vertex);
    return edges.size() != 2 || edges_[edges[0]].line_class != edges_[edges[1]].line_class;
  }

  /// How many triangles around the vertex lie in front of the edge that leads from it to `other`, beside the vertex.
  int layers_beside(std::uint32_t vertex, std::uint32_t other) const {
    const glm::dvec3& p = positions_[vertex];
    const glm::dvec3 v = view_vector(task_.camera, p);
    const glm::dvec3 x =
        glm::normalize(std::fabs(v.x) < 0.8 ? glm::cross(v, glm::dvec3(1.0, 0.0, 0.0)) : glm::cross(v, glm::dvec3(0.0, 1.0, 0.0)));
    const glm::dvec3 y = glm::cross(v, x);
    const auto seen = [&](std::uint32_t q) {
      const glm::dvec3 d = positions_[q] - p;
      return glm::dvec3(glm::dot(d, x), glm::dot(d, y), glm::dot(d, v));
    };
    const glm::dvec3 e = seen(other);
    const double nearer = kExactNearer_px / pixels_per_unit_at(task_.camera, std::max(1e-9, project(task_.camera, p).z));
    int layers = 0;
    for (const std::uint32_t t : stars_.at(vertex)) {
      const auto& c = triangles_[t].corners;
      if (std::find(c.begin(), c.end(), other) != c.end()) continue;
      const size_t at = static_cast<size_t>(std::find(c.begin(), c.end(), vertex) - c.begin());
      const glm::dvec3 a = seen(c[(at + 1) % 3]), b = seen(c[(at + 2) % 3]);
      const double determinant = a.x * b.y - a.y * b.x;
      if (determinant == 0.0) continue;
      const double s = (e.x * b.y - e.y * b.x) / determinant, u = (a.x * e.y - a.y * e.x) / determinant;
      // Half-open, so that an edge on the border of two triangles is in one of them. Rays from the edge's middle have to say the same.
      if (s >= 0.0 && u > 0.0 && 0.5 * (s * a.z + u * b.z - e.z) > nearer) ++layers;
    }
    return layers;
  }

  SurfaceCurve walk(std::uint32_t first, std::uint32_t start) {
    SurfaceCurve curve;
    std::uint32_t vertex = start, before = start;
    for (std::uint32_t e = first;;) {
      MeshEdge& edge = edges_[e];
      edge.taken = true;
      const bool forward = edge.a == vertex;
      const std::uint32_t next = forward ? edge.b : edge.a;
      CurveSample sample = sample_at_vertex(vertex, edge);
      sample.more_on_left = forward ? edge.more_on_left : -edge.more_on_left;
      if (before != vertex) add_step(vertex, before, next, sample);
      curve.samples.push_back(sample);
      before = vertex;
      vertex = next;
      if (vertex == start || ends_at(vertex)) {
        curve.closed = vertex == start && !ends_at(start) && curve.samples.size() > 2;
        if (curve.closed) add_step(start, before, other_end(first, start), curve.samples.front());
        if (!curve.closed) curve.samples.push_back(sample_at_vertex(vertex, edge));
        make_exact(curve);
        return curve;
      }
      const auto& here = at_vertex_.at(vertex);
      e = here[0] == e ? here[1] : here[0];
    }
  }
  std::uint32_t other_end(std::uint32_t edge, std::uint32_t vertex) const {
    return edges_[edge].a == vertex ? edges_[edge].b : edges_[edge].a;
  }

  void add_step(std::uint32_t vertex, std::uint32_t before, std::uint32_t next, CurveSample& sample) const {
    const int step = layers_beside(vertex, next) - layers_beside(vertex, before);
    if (step != 0) sample.pierced.push_back({0.0, step});
  }

  CurveSample sample_at_vertex(std::uint32_t vertex, const MeshEdge& edge) const {
    CurveSample sample;
    sample.p = positions_[vertex];
    sample.high = edge.high;
    sample.low = edge.low;
    sample.lift = view_vector(task_.camera, sample.p);
    sample.line_class = edge.line_class;
    sample.object = edge.object;
    sample.edge = {edge.a, edge.b};
    project_sample(task_.camera, sample);
    return sample;
  }

  const LineTask& task_;
  const std::vector<glm::dvec3>& positions_;
  const std::vector<LayerTriangle>& triangles_;
  double crease_cosine_;
  std::vector<glm::dvec3> normals_;
  std::vector<double> facing_;
  std::vector<MeshEdge> edges_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> at_vertex_, stars_;
};

}  // namespace

LineContribution mesh_lines(const LineTask& task, const std::vector<size_t>& objects, const ExecutionSettings&) {
  LineContribution out;
  const auto layers = std::make_shared<const MeshLayers>(task, objects, kEdge_px, false);
  out.curves = MeshTracer(task, *layers).run();
  add_mesh_layers(layers, out);
  return out;
}

}  // namespace limn
