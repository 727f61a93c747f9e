// Normals of the limit surface at the corners of a refined level. On smooth vertices the two limit tangents span them. Along infinitely
// sharp edges the surface on one side does not depend on the other, so each side is a surface with a border of its own: the sectors of
// all such vertices are gathered into one mesh of loose fans, whose limit tangents OpenSubdiv's border masks give exactly.
#include <opensubdiv/far/primvarRefiner.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sdf/error.h"
#include "sdf/parallel.h"
#include "subdiv/opensubdiv_cage.h"

namespace limn {
namespace {

namespace Sdc = OpenSubdiv::Sdc;

/// One run of faces around a vertex between two infinitely sharp or open edges.
struct Sector {
  int vertex = 0;
  std::vector<int> faces, edges;  ///< Counter-clockwise; one edge more than faces.
};

int other_end(const Far::TopologyLevel& level, int edge, int vertex) {
  const Far::ConstIndexArray ends = level.GetEdgeVertices(edge);
  return ends[0] == vertex ? ends[1] : ends[0];
}

/// Faces and edges around a manifold vertex run counter-clockwise: face i lies between edges i and i + 1.
std::vector<Sector> sectors_at(const Far::TopologyLevel& level, int vertex) {
  const Far::ConstIndexArray faces = level.GetVertexFaces(vertex), edges = level.GetVertexEdges(vertex);
  const int n = faces.size();
  std::vector<int> starts;
  for (int i = 0; i < n; ++i)
    if (level.IsEdgeInfSharp(edges[i]) || level.IsEdgeBoundary(edges[i])) starts.push_back(i);
  std::vector<Sector> sectors;
  for (size_t s = 0; s < starts.size(); ++s) {
    const int begin = starts[s];
    const int end = s + 1 < starts.size() ? starts[s + 1] : (edges.size() > n ? n : starts[0] + n);
    Sector sector{vertex, {}, {}};
    for (int i = begin; i < end; ++i) sector.faces.push_back(faces[i % n]), sector.edges.push_back(edges[i % edges.size()]);
    sector.edges.push_back(edges[end % edges.size()]);
    sectors.push_back(std::move(sector));
  }
  return sectors;
}

class Normals {
 public:
  Normals(const Far::TopologyRefiner& refiner, Scheme scheme, const Points& points, const LimitFrame& limit)
      : level_(refiner.GetLevel(refiner.GetMaxLevel())), scheme_(scheme), points_(points), limit_(limit) {
    // Quads, or triangles for Loop.
    const auto faces = static_cast<size_t>(level_.GetNumFaces()), corners = static_cast<size_t>(level_.GetNumFaceVertices());
    sides_ = faces > 0 ? corners / faces : 0;
    LIMN_CHECK(sides_ * faces == corners);
    normals_.assign(corners, glm::vec3(0.0f));
  }

  std::vector<glm::vec3> run(const std::vector<int>* vertices) {
    const size_t count = vertices != nullptr ? vertices->size() : static_cast<size_t>(level_.GetNumVertices());
    // A vertex writes its own corners alone; what its border leaves for later is gathered in the order of vertices.
    constexpr size_t kTogether = 4096;
    std::vector<std::vector<Sector>> borders((count + kTogether - 1) / kTogether);
    parallel_each(borders.size(), [&](size_t part) {
      for (size_t i = part * kTogether; i < std::min(count, (part + 1) * kTogether); ++i)
        at_vertex(vertices != nullptr ? (*vertices)[i] : static_cast<int>(i), borders[part]);
    });
    for (std::vector<Sector>& part : borders)
      borders_.insert(borders_.end(), std::move_iterator(part.begin()), std::move_iterator(part.end()));
    border_sectors();
    for (const LimitFrame::Ring& ring : limit_.semi_sharp) {
      const Far::ConstIndexArray faces = level_.GetVertexFaces(ring.vertex);
      for (int i = 0; i < faces.size(); ++i) set(faces[i], ring.vertex, ring.normals[static_cast<size_t>(i)]);
    }
    return std::move(normals_);
  }

 private:
  glm::dvec3 point(int v) const { return points_[static_cast<size_t>(v)].p; }

  int corner_of(int face, int vertex) const {
    const Far::ConstIndexArray vertices = level_.GetFaceVertices(face);
    return static_cast<int>(std::find(vertices.begin(), vertices.end(), vertex) - vertices.begin());
  }

  void set(int face, int vertex, const glm::dvec3& normal) {
    const double length = glm::length(normal);
    const glm::dvec3 unit = length > 0.0 && std::isfinite(length) ? normal / length : facet(face);
    normals_[static_cast<size_t>(face) * sides_ + static_cast<size_t>(corner_of(face, vertex))] = glm::vec3(unit);
  }

  /// The normal of the face as a polygon: where tangents vanish (collapsed edges) it is the best there is.
  glm::dvec3 facet(int face) const {
    std::vector<glm::dvec3> corners;
    for (const int v : level_.GetFaceVertices(face)) corners.push_back(point(v));
    const glm::dvec3 area = vector_area(corners);
    const double length = glm::length(area);
    return length > 0.0 ? area / length : glm::dvec3(0.0, 0.0, 1.0);
  }

  /// The face's own plane at the corner, from the two edges there: exact for a bilinear patch.
  void set_from_corner(int face, int vertex) {
    const Far::ConstIndexArray vertices = level_.GetFaceVertices(face);
    const int i = corner_of(face, vertex), n = vertices.size();
    set(face, vertex, glm::cross(point(vertices[(i + 1) % n]) - point(vertex), point(vertices[(i + n - 1) % n]) - point(vertex)));
  }

  void at_vertex(int v, std::vector<Sector>& borders) {
    const Far::ConstIndexArray faces = level_.GetVertexFaces(v);
    const Sdc::Crease::Rule rule = level_.GetVertexRule(v);
    if (scheme_ == Scheme::bilinear || level_.IsVertexNonManifold(v)) {
      for (const int f : faces) set_from_corner(f, v);
    } else if (still_semi_sharp(level_, v)) {
      return;  // among limit_.semi_sharp
    } else if (rule == Sdc::Crease::RULE_SMOOTH || rule == Sdc::Crease::RULE_DART) {
      const auto i = static_cast<size_t>(v);
      const glm::dvec3 normal = glm::cross(limit_.tangent1[i].p, limit_.tangent2[i].p);
      for (const int f : faces) set(f, v, normal);
    } else {
      std::vector<Sector> sectors = sectors_at(level_, v);
      if (sectors.empty())
        for (const int f : faces) set_from_corner(f, v);  // the tip of a spike: each face has its own side
      for (Sector& sector : sectors) {
        if (rule == Sdc::Crease::RULE_CORNER) {
          at_corner(sector);
        } else {
          borders.push_back(std::move(sector));
        }
      }
    }
  }

  /// A corner's tangent plane holds its two border curves (Biermann, Levin & Zorin 2000); where these form one line, the faces decide.
  void at_corner(const Sector& sector) {
    const glm::dvec3 center = point(sector.vertex);
    const glm::dvec3 a = point(other_end(level_, sector.edges.front(), sector.vertex)) - center;
    const glm::dvec3 b = point(other_end(level_, sector.edges.back(), sector.vertex)) - center;
    glm::dvec3 around(0.0);
    for (const int f : sector.faces) around += facet(f);
    glm::dvec3 normal = glm::cross(a, b);
    if (glm::dot(normal, around) < 0.0) normal = -normal;  // a reflex sector
    if (sector.faces.size() > 1 && glm::length(normal) < 1e-6 * glm::length(a) * glm::length(b)) normal = around;
    for (const int f : sector.faces) set(f, sector.vertex, normal);
  }

  OneRing ring_of(const Sector& sector) const {
    OneRing ring;
    ring.center = point(sector.vertex);
    ring.face_total = sector.faces.size();
    for (const int e : sector.edges) ring.edges.push_back(point(other_end(level_, e, sector.vertex)));
    ring.sharpness.assign(ring.edges.size(), 0.0f);
    if (scheme_ == Scheme::loop) return ring;
    for (const int f : sector.faces) {
      const Far::ConstIndexArray vertices = level_.GetFaceVertices(f);
      ring.diagonals.push_back(point(vertices[(corner_of(f, sector.vertex) + 2) % vertices.size()]));
    }
    return ring;
  }

  void border_sectors() {
    if (borders_.empty()) return;
    std::vector<OneRing> rings;
    for (const Sector& sector : borders_) rings.push_back(ring_of(sector));
    const Fans fans = gather_fans(rings, scheme_, CreaseMethod::uniform);  // nothing semi-sharp is left
    const std::unique_ptr<Far::TopologyRefiner> refiner = make_refiner(fans.mesh, scheme_, {});
    const Far::PrimvarRefinerReal<double> primvars(*refiner);
    std::vector<WeightedPoint> source(fans.mesh.vertex_count()), position(source), tangent1(source), tangent2(source);
    for (size_t i = 0; i < source.size(); ++i) source[i].p = fans.mesh.positions[i];
    primvars.Limit(source, position, tangent1, tangent2);
    for (size_t s = 0; s < borders_.size(); ++s) {
      const auto center = static_cast<size_t>(fans.centers[s]);
      const glm::dvec3 normal = glm::cross(tangent1[center].p, tangent2[center].p);
      for (const int f : borders_[s].faces) set(f, borders_[s].vertex, normal);
    }
  }

  const Far::TopologyLevel& level_;
  Scheme scheme_;
  const Points& points_;
  const LimitFrame& limit_;
  size_t sides_ = 0;  ///< Of each face.
  std::vector<glm::vec3> normals_;
  std::vector<Sector> borders_;
};

}  // namespace

std::vector<glm::vec3> limit_normals(const Far::TopologyRefiner& refiner, Scheme scheme, const Points& points, const LimitFrame& limit,
                                     const std::vector<int>* vertices) {
  return Normals(refiner, scheme, points, limit).run(vertices);
}

}  // namespace limn
