// OpenSubdiv's limit masks applied at all vertices of a level at once: its own refiner goes from vertex to vertex on one thread. The same
// masks, and the same order of sums, so that points and tangents are its own, bit for bit.
#include <opensubdiv/sdc/bilinearScheme.h>
#include <opensubdiv/sdc/catmarkScheme.h>
#include <opensubdiv/sdc/loopScheme.h>

#include <algorithm>

#include "sdf/parallel.h"
#include "subdiv/opensubdiv_cage.h"

namespace limn {
namespace {

namespace Sdc = OpenSubdiv::Sdc;

/// What a scheme asks about the surroundings of a vertex (sdc/scheme.h).
class Surroundings {
 public:
  Surroundings(const Far::TopologyLevel& level, int vertex) : level_(level), vertex_(vertex), edges_(level.GetVertexEdges(vertex)) {}

  int GetNumEdges() const { return edges_.size(); }
  int GetNumFaces() const { return level_.GetVertexFaces(vertex_).size(); }
  float GetSharpness() const { return level_.GetVertexSharpness(vertex_); }
  float* GetSharpnessPerEdge(float* sharpness) const {
    for (int i = 0; i < edges_.size(); ++i) sharpness[i] = level_.GetEdgeSharpness(edges_[i]);
    return sharpness;
  }

 private:
  const Far::TopologyLevel& level_;
  int vertex_;
  Far::ConstIndexArray edges_;
};

/// Where a scheme writes the weights of a vertex, of those beyond its edges, and of those across its faces.
class Mask {
 public:
  using Weight = double;
  Mask(double* weights, int valence) : of_vertex_(weights), of_edges_(weights + 1), of_faces_(weights + 1 + valence) {}

  int GetNumVertexWeights() const { return vertices_; }
  int GetNumEdgeWeights() const { return edges_; }
  int GetNumFaceWeights() const { return faces_; }
  void SetNumVertexWeights(int count) { vertices_ = count; }
  void SetNumEdgeWeights(int count) { edges_ = count; }
  void SetNumFaceWeights(int count) { faces_ = count; }
  double& VertexWeight(int i) { return of_vertex_[i]; }
  double& EdgeWeight(int i) { return of_edges_[i]; }
  double& FaceWeight(int i) { return of_faces_[i]; }
  double VertexWeight(int i) const { return of_vertex_[i]; }
  double EdgeWeight(int i) const { return of_edges_[i]; }
  double FaceWeight(int i) const { return of_faces_[i]; }
  bool AreFaceWeightsForFaceCenters() const { return false; }
  void SetFaceWeightsForFaceCenters(bool) {}

 private:
  double *of_vertex_, *of_edges_, *of_faces_;
  int vertices_ = 0, edges_ = 0, faces_ = 0;
};

/// The vertices that masks weigh: beyond edges, then across faces.
class Neighbors {
 public:
  void find(const Far::TopologyLevel& level, int vertex, bool with_faces) {
    const Far::ConstIndexArray around = level.GetVertexEdges(vertex), faces = level.GetVertexFaces(vertex);
    edges_ = static_cast<size_t>(around.size());
    const size_t count = edges_ + (with_faces ? static_cast<size_t>(faces.size()) : 0);
    if (vertices_.size() < count) vertices_.resize(count);
    for (int i = 0; i < around.size(); ++i) {
      const Far::ConstIndexArray ends = level.GetEdgeVertices(around[i]);
      vertices_[static_cast<size_t>(i)] = ends[0] == vertex ? ends[1] : ends[0];
    }
    if (!with_faces) return;
    const Far::ConstLocalIndexArray corner = level.GetVertexFaceLocalIndices(vertex);
    for (int i = 0; i < faces.size(); ++i) {
      const Far::ConstIndexArray corners = level.GetFaceVertices(faces[i]);
      const int across = corner[i] + 2;
      vertices_[edges_ + static_cast<size_t>(i)] = corners[across >= corners.size() ? across - corners.size() : across];
    }
  }
  size_t over_edge(int i) const { return static_cast<size_t>(vertices_[static_cast<size_t>(i)]); }
  size_t across_face(int i) const { return static_cast<size_t>(vertices_[edges_ + static_cast<size_t>(i)]); }

 private:
  std::vector<int> vertices_{};
  size_t edges_ = 0;
};

/// Small weights first, as OpenSubdiv adds them.
glm::dvec3 weighed(const Mask& mask, const Neighbors& neighbors, int vertex, const Points& points) {
  WeightedPoint sum;
  for (int i = 0; i < mask.GetNumFaceWeights(); ++i) sum.AddWithWeight(points[neighbors.across_face(i)], mask.FaceWeight(i));
  for (int i = 0; i < mask.GetNumEdgeWeights(); ++i) sum.AddWithWeight(points[neighbors.over_edge(i)], mask.EdgeWeight(i));
  sum.AddWithWeight(points[static_cast<size_t>(vertex)], mask.VertexWeight(0));
  return sum.p;
}

template <Sdc::SchemeType type>
void limit_range(const Far::TopologyRefiner& refiner, const Points& points, const IndexRange<int>& vertices, LimitFrame& frame) {
  const Sdc::Scheme<type> scheme(refiner.GetSchemeOptions());
  const Far::TopologyLevel& level = refiner.GetLevel(refiner.GetMaxLevel());
  // Laid out as OpenSubdiv does: at an edge with more than two faces weights of one mask run into the next (see check_room_for_masks).
  const int valence = refiner.GetMaxValence(), stride = 1 + 2 * valence;
  std::vector<double> weights(static_cast<size_t>(std::max(3 * stride, 99)));
  Mask at(weights.data(), valence), along(weights.data() + stride, valence), across(weights.data() + 2 * stride, valence);
  int faces_of_masks = -1;  ///< Of the smooth vertex that they are of; -1: of another one.
  Neighbors neighbors;
  for (int v = vertices.begin(); v < vertices.end(); ++v) {
    const auto i = static_cast<size_t>(v);
    if (level.GetVertexEdges(v).size() == 0) {
      frame.positions[i] = points[i];
      frame.tangent1[i].p = frame.tangent2[i].p = glm::dvec3(0.0);
      continue;
    }
    // Those of smooth vertices depend on nothing but how many faces meet there, four at nearly all.
    const bool smooth = level.GetVertexRule(v) == Sdc::Crease::RULE_SMOOTH;
    const int faces = level.GetVertexFaces(v).size();
    if (!smooth || faces != faces_of_masks)
      scheme.ComputeVertexLimitMask(Surroundings(level, v), at, along, across, level.GetVertexRule(v));
    faces_of_masks = smooth ? faces : -1;
    neighbors.find(level, v, at.GetNumFaceWeights() > 0 || along.GetNumFaceWeights() > 0);
    frame.positions[i].p = weighed(at, neighbors, v, points);
    frame.tangent1[i].p = weighed(along, neighbors, v, points);
    frame.tangent2[i].p = weighed(across, neighbors, v, points);
  }
}

}  // namespace

void limit_points(const Far::TopologyRefiner& refiner, Scheme scheme, const Points& points, LimitFrame& frame) {
  frame.positions.resize(points.size());
  frame.tangent1.resize(points.size());
  frame.tangent2.resize(points.size());
  parallel_parts(refiner.GetLevel(refiner.GetMaxLevel()).GetNumVertices(), 2048, [&](const IndexRange<int>& vertices) {
    switch (scheme) {
      case Scheme::catmark:
        return limit_range<Sdc::SCHEME_CATMARK>(refiner, points, vertices, frame);
      case Scheme::loop:
        return limit_range<Sdc::SCHEME_LOOP>(refiner, points, vertices, frame);
      case Scheme::bilinear:
        return limit_range<Sdc::SCHEME_BILINEAR>(refiner, points, vertices, frame);
    }
  });
}

}  // namespace limn
