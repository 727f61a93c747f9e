#pragma once
// Internal: triangles that rays and lines go through, and where connected parts of them go through each other. Knows no view.

#include <array>
#include <memory>
#include <mutex>
#include <vector>

#include "raymarch/lines/exact_hits.h"
#include "raymarch/surface.h"

namespace limn {

/// A triangle's side of a ray.
struct LayerHit {
  double t = 0.0;
  std::uint32_t triangle = 0;
};

/// A triangle of vertices that are the same where they lie at one place.
struct LayerTriangle {
  std::array<std::uint32_t, 3> corners{};
  std::uint32_t part = 0;  ///< Connected by vertices.
  int object = 1;          ///< Index from 1.
  int material = 0;
};

/// Where an edge of one part goes through a triangle of another.
struct PartMeeting {
  glm::dvec3 p{0.0};
  glm::dvec3 lower_normal{0.0}, upper_normal{0.0};  ///< Unit, of the parts of lower and higher number.
  int object = 1, other_object = 1;
  int material = 0, other_material = 0;  ///< Of their faces.
};
/// A place that comes next to another, and the two faces that the line from one to the other lies in.
struct NextMeeting {
  size_t place = 0;
  std::array<std::uint32_t, 2> faces{};
};
/// Polylines along which parts go through each other: places, and those that come next to each.
struct PartMeetings {
  std::vector<PartMeeting> places{};
  std::vector<std::vector<NextMeeting>> next{};
};

/// Safe from many threads.
class MeshTree {
 public:
  /// Polygons, moved by `offset`, which stand for these objects (from 1); null where one has none. `exact`: where parts meet is found in
  /// double precision.
  MeshTree(const std::vector<std::shared_ptr<const Polygons>>& polygons, const glm::dvec3& offset, const std::vector<int>& objects,
           double extent, bool exact);
  ~MeshTree();
  MeshTree(const MeshTree&) = delete;
  MeshTree& operator=(const MeshTree&) = delete;

  const std::vector<glm::dvec3>& positions() const { return positions_; }
  const std::vector<LayerTriangle>& triangles() const { return triangles_; }
  std::uint32_t parts() const { return parts_; }
  /// Not unit.
  glm::dvec3 normal_of(const LayerTriangle& triangle) const;

  /// All hits on origin + t direction, 0 < t < end, in order; one where a shared edge or vertex is hit. Single precision, whose tree is
  /// built when first asked for.
  std::vector<LayerHit> hits_along(const glm::dvec3& origin, const glm::dvec3& direction, double end) const;
  /// Makes what rays from smooth curves ask for, by all threads: the first of them would make it while the others wait.
  void prepare_for_smooth() const;
  /// The same triangles for segments in double precision. Made when first asked for.
  const ExactHits& exact_hits() const;
  /// At a place on a triangle: between the normals of its corners, each the mean of those of the triangles around it. Unit.
  glm::dvec3 smooth_normal(std::uint32_t triangle, const glm::dvec3& place) const;
  /// Whether a way over triangles that share vertices within `reach` of the place leads from one to the other.
  bool joined_near(std::uint32_t one, std::uint32_t other, const glm::dvec3& place, double reach) const;
  /// Made when first asked for.
  const PartMeetings& meetings() const;

 private:
  struct Embree;
  void add(const class Polygons& polygons, const glm::dvec3& offset, int object);
  void weld();
  void build() const;
  bool same_side(const LayerHit& a, const LayerHit& b, const glm::dvec3& direction) const;
  /// An edge between two vertices, and the faces that it is one of.
  struct EdgeFaces {
    std::uint32_t a = 0, b = 0;
    std::vector<std::uint32_t> faces{};
  };
  std::vector<char> near_other_parts() const;
  std::vector<EdgeFaces> faces_of_edges(const std::vector<char>& asked) const;
  PartMeetings find_meetings() const;
  std::vector<LayerHit> hits_of_edge(std::uint32_t a, std::uint32_t b) const;
  void find_around() const;

  double extent_;
  bool exact_;
  std::vector<glm::dvec3> positions_{};
  std::vector<LayerTriangle> triangles_{};
  std::uint32_t parts_ = 0;
  std::unique_ptr<Embree> embree_;
  mutable std::once_flag built_;
  mutable std::once_flag exact_made_;
  mutable std::unique_ptr<const ExactHits> exact_hits_;
  /// Triangles around vertices: those of vertex v are `around_[first_around_[v]]` up to `around_[first_around_[v + 1]]`.
  mutable std::once_flag around_made_;
  mutable std::vector<std::uint32_t> first_around_{}, around_{};
  mutable std::once_flag meetings_made_;
  mutable PartMeetings meetings_;
};

}  // namespace limn
