#include "samples/scenes/cage_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sdf/error.h"

namespace limn {

std::int32_t CageBuilder::vertex(const glm::dvec3& position) {
  positions_.push_back(position);
  return static_cast<std::int32_t>(positions_.size()) - 1;
}

CageBuilder::Loop CageBuilder::vertices(std::span<const glm::dvec3> positions) {
  Loop loop;
  for (const glm::dvec3& position : positions) loop.push_back(vertex(position));
  return loop;
}

int CageBuilder::face(Loop corners) {
  faces_.push_back(std::move(corners));
  return static_cast<int>(faces_.size()) - 1;
}

int CageBuilder::band(const Loop& from, const Loop& to) {
  LIMN_CHECK(from.size() == to.size());
  const int first = static_cast<int>(faces_.size());
  for (size_t i = 0; i < from.size(); ++i) {
    const size_t next = (i + 1) % from.size();
    face({from[i], from[next], to[next], to[i]});
  }
  return first;
}

int CageBuilder::extrude(int base, const glm::dvec3& offset) {
  const Loop from = corners(base);
  Loop to;
  for (const std::int32_t corner : from) to.push_back(vertex(position(corner) + offset));
  remove(base);
  band(from, to);
  return face(to);
}

void CageBuilder::tube(int from, std::span<const std::vector<glm::dvec3>> sections, int to) {
  Loop loop = corners(from);
  remove(from);
  for (const std::vector<glm::dvec3>& section : sections) {
    const Loop next = vertices(section);
    band(loop, next);
    loop = next;
  }
  // The far face looks at the tube, so its corners run the other way round; the rotation with the shortest edges does not twist.
  Loop target = corners(to);
  remove(to);
  std::reverse(target.begin(), target.end());
  Loop best = target;
  double best_length = std::numeric_limits<double>::infinity();
  for (size_t turn = 0; turn < target.size(); ++turn) {
    std::rotate(target.begin(), target.begin() + 1, target.end());
    double length = 0.0;
    for (size_t i = 0; i < target.size(); ++i) length += glm::distance(position(loop[i]), position(target[i]));
    if (length >= best_length) continue;
    best_length = length;
    best = target;
  }
  band(loop, best);
}

void CageBuilder::crease(std::int32_t a, std::int32_t b, float sharpness) { creases_.push_back({a, b, sharpness}); }

void CageBuilder::crease_loop(const Loop& loop, float sharpness) {
  for (size_t i = 0; i < loop.size(); ++i) crease(loop[i], loop[(i + 1) % loop.size()], sharpness);
}

CageBuilder::Revolution CageBuilder::revolve(std::span<const ProfilePoint> profile, int segments, double phase) {
  Revolution made;
  made.segments = segments;
  for (const ProfilePoint& point : profile) {
    Loop ring;
    for (int i = 0; i < segments; ++i) {
      const double angle = phase + 2.0 * std::numbers::pi * i / segments;
      ring.push_back(vertex({point.radius * std::cos(angle), point.y, -point.radius * std::sin(angle)}));
    }
    if (point.sharpness > 0.0f) crease_loop(ring, point.sharpness);
    if (!made.rings.empty()) made.bands.push_back(band(made.rings.back(), ring));
    made.rings.push_back(std::move(ring));
  }
  Loop below = made.rings.front();
  std::reverse(below.begin(), below.end());
  face(below);
  face(made.rings.back());
  return made;
}

Mesh CageBuilder::mesh() const {
  Mesh mesh;
  mesh.positions = positions_;
  mesh.creases = creases_;
  for (const Loop& corners : faces_) {
    if (corners.empty()) continue;
    mesh.face_sizes.push_back(static_cast<std::int32_t>(corners.size()));
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), corners.begin(), corners.end());
  }
  return mesh;
}

}  // namespace limn
