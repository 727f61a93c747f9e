// Faces: slivers, duplicates, normals that agree with no neighbour's.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "subdiv/mesh_facts.h"
#include "subdiv/polygon.h"

namespace limn {
namespace {

constexpr double kSliverAngle = std::numbers::pi / 180.0;
/// Less is what coarse meshes of curved surfaces have anyway.
constexpr double kOffNormal = 20.0 * std::numbers::pi / 180.0;

std::uint64_t mixed(std::uint64_t x) {  // splitmix64 (Steele, Lea & Flood 2014)
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

std::vector<std::int32_t> sorted_corners(const Mesh& mesh, std::int32_t first, size_t face) {
  const auto corners = face_corners(mesh, first, face);
  std::vector<std::int32_t> sorted(corners.begin(), corners.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

double largest_corner_angle(std::span<const glm::dvec3> corners, const glm::dvec3& normal, double& smallest) {
  double largest = 0.0;
  smallest = std::numbers::pi;
  for (size_t i = 0; i < corners.size(); ++i) {
    const double angle = corner_angle(corners, i, normal);
    smallest = std::min(smallest, angle);
    largest = std::max(largest, angle);
  }
  return largest;
}

}  // namespace

void count_duplicates(const Mesh& mesh, MeshFacts& facts) {
  // A sum of mixed indices does not depend on where a face starts or which way it runs; equal sums are looked at again.
  struct Key {
    std::uint64_t hash;
    std::int32_t first;
    std::int32_t face;
  };
  std::vector<Key> keys(mesh.face_count());
  std::int32_t first = 0;
  for (size_t f = 0; f < keys.size(); ++f) {
    std::uint64_t hash = 0;
    for (const std::int32_t v : face_corners(mesh, first, f)) hash += mixed(static_cast<std::uint64_t>(v));
    keys[f] = {hash, first, static_cast<std::int32_t>(f)};
    first += mesh.face_sizes[f];
  }
  std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) { return a.hash != b.hash ? a.hash < b.hash : a.face < b.face; });
  for (size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].hash != keys[i - 1].hash) continue;
    const auto corners_of = [&](const Key& key) { return sorted_corners(mesh, key.first, static_cast<size_t>(key.face)); };
    facts.duplicate_faces += corners_of(keys[i]) == corners_of(keys[i - 1]);
  }
}

void measure_faces(const Mesh& mesh, const Edges& edges, size_t counted, MeshFacts& facts) {
  std::vector<glm::dvec3> normals(mesh.face_count(), glm::dvec3(0.0)), corners;
  std::vector<double> areas(mesh.face_count(), 0.0);
  std::vector<char> obtuse(mesh.face_count(), 0);
  facts.smallest_angle = std::numbers::pi;
  double area = 0.0;
  std::int32_t first = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    gather_corners(mesh, face_corners(mesh, first, f), corners);
    first += mesh.face_sizes[f];
    if (zero_area(corners)) {
      facts.zero_area_faces += f < counted;
      continue;
    }
    const glm::dvec3 normal = vector_area(corners);
    areas[f] = glm::length(normal);
    if (f < counted) area += areas[f];
    if (areas[f] > 0.0) normals[f] = normal / areas[f];
    if (f >= counted) continue;
    double smallest = 0.0;
    obtuse[f] = corners.size() == 3 && largest_corner_angle(corners, normal, smallest) > kObtuseAngle;
    if (corners.size() != 3) largest_corner_angle(corners, normal, smallest);
    facts.slivers += smallest < kSliverAngle;
    facts.smallest_angle = std::min(facts.smallest_angle, smallest);
  }
  std::vector<double> nearest(mesh.face_count(), std::numbers::pi);
  std::vector<char> has_neighbour(mesh.face_count(), 0);
  for (const Edge& edge : edges) {
    if (edge.face_b < 0 || edge.face_a == edge.face_b) continue;
    const auto a = static_cast<size_t>(edge.face_a), b = static_cast<size_t>(edge.face_b);
    if (!(areas[a] > 0.0) || !(areas[b] > 0.0) || (!obtuse[a] && !obtuse[b])) continue;
    // A neighbour that is wound the other way is judged by the plane it lies in.
    const double cosine = glm::dot(normals[a], normals[b]);
    const double angle = std::acos(std::clamp(edge.consistent ? cosine : -cosine, -1.0, 1.0));
    for (const size_t f : {a, b}) {
      nearest[f] = std::min(nearest[f], angle);
      has_neighbour[f] = 1;
    }
  }
  double off_area = 0.0;
  for (size_t f = 0; f < nearest.size(); ++f) {
    if (!obtuse[f] || !has_neighbour[f] || nearest[f] < kOffNormal) continue;
    ++facts.off_normal_faces;
    off_area += areas[f];
    facts.off_normal_angle = std::max(facts.off_normal_angle, nearest[f]);
  }
  if (area > 0.0) facts.off_normal_area_share = off_area / area;
}

}  // namespace limn
