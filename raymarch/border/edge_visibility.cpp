#include "raymarch/border/edge_visibility.h"

#include <cmath>

namespace limn {
namespace {

/// Where the visibility of an edge is asked for, along its image; and how closely the place is found where it changes.
constexpr double kStep_px = 0.25, kPlace_px = 1.0 / 64.0;
/// Nearer to a pinhole than this share of the scene's radius, an edge is cut off: its image would lie beyond all bounds.
constexpr double kNearShare = 1e-5;

/// Keeps the part of [low, high] in which start + s * slope >= 0 (Liang & Barsky 1984).
bool clip(double start, double slope, double& low, double& high) {
  if (slope == 0.0) return start >= 0.0;
  const double s = -start / slope;
  if (slope > 0.0) low = std::max(low, s);
  if (slope < 0.0) high = std::min(high, s);
  return low <= high;
}

}  // namespace

EdgeVisibility::EdgeVisibility(const BorderInput& input) : input_(input), camera_(moved(input.camera, input.model.render_origin)) {
  for (const Surface& surface : input.model.surfaces) {
    if (surface.bounds.empty()) continue;
    bounded_ = bounded_ && surface.bounds.finite();
    if (!surface.bounds.finite()) continue;
    // A hundredth more, as rays take it.
    radius_ = std::max(radius_, 1.01 * glm::length(glm::max(glm::abs(surface.bounds.lower), glm::abs(surface.bounds.upper))));
  }
  // Beside an unbounded surface rays are not cut to the sphere and start at the eye.
  if (!bounded_) radius_ = std::max(radius_, glm::length(camera_.eye));
}

double EdgeVisibility::near() const { return camera_.projection == Projection::perspective ? kNearShare * radius_ : 0.0; }

bool EdgeVisibility::place(const glm::dvec3& a, const glm::dvec3& b, double margin_px, ImageEdge& edge) const {
  const bool perspective = camera_.projection == Projection::perspective;
  const glm::dvec3 backward = camera_.world_from_camera[2];
  const double z_a = -glm::dot(a - camera_.eye, backward), z_b = -glm::dot(b - camera_.eye, backward);
  double low = 0.0, high = 1.0;
  if (!clip(z_a - near(), z_b - z_a, low, high)) return false;
  const glm::dvec3 from = project(camera_, a + low * (b - a)), to = project(camera_, a + high * (b - a));
  if (perspective && !(from.z > 0.0 && to.z > 0.0)) return false;
  low = 0.0, high = 1.0;
  const glm::dvec3 along = to - from;
  const double right = input_.gbuffer.width + margin_px, bottom = input_.gbuffer.height + margin_px;
  if (!clip(from.x + margin_px, along.x, low, high) || !clip(right - from.x, -along.x, low, high) ||
      !clip(from.y + margin_px, along.y, low, high) || !clip(bottom - from.y, -along.y, low, high))
    return false;
  const double q_from = perspective ? 1.0 / from.z : from.z, q_to = perspective ? 1.0 / to.z : to.z;
  edge.a = glm::dvec2(from + low * along);
  edge.b = glm::dvec2(from + high * along);
  edge.q_a = q_from + low * (q_to - q_from);
  edge.q_b = q_from + high * (q_to - q_from);
  return std::isfinite(edge.a.x + edge.a.y + edge.b.x + edge.b.y + edge.q_a + edge.q_b);
}

// The bias of the depth test, derived. A ray through the point of the edge meets what hides it exactly where that is asked about, so that
// rounding alone is left. With u = 2^-24, half a unit in the last place of 1, R the radius within which rays are single precision and T the
// length of the single precision ray (it starts where it enters that sphere, or at the eye beside an unbounded surface): the ray's origin
// (at most R from the middle in each of three coordinates: sqrt(3) R u together) and its direction (sqrt(3) T u at its end) put the hit at
// most sqrt(3) (R + T) u beside the ray, which changes depth by that times the slope, and as much along it; its t adds T u.
double EdgeVisibility::bias(const PointSample& seen, const glm::dvec3& facet, const glm::dvec3& direction, double distance) const {
  const glm::dvec3 normal = facet == glm::dvec3(0.0) ? glm::dvec3(seen.normal) : glm::normalize(facet);
  const double cosine = std::abs(glm::dot(normal, direction));
  // A slope above a thousand is an edge-on face, of which a ray sees no more than a thousandth.
  const double slope = std::min(1e3, std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / std::max(cosine, 1e-3));
  const double reach = bounded_ ? 2.0 * radius_ : distance;
  return std::ldexp(std::sqrt(3.0) * (radius_ + reach) * (1.0 + slope) + reach, -24);
}

bool EdgeVisibility::shows(const PointSample& seen, const ImageEdge& edge, double s) const {
  // Nothing there: the ray passed the edge of the outline on its outer side. It passes no edge whose faces both show their backs, since
  // those lie on both sides of it.
  if (seen.status != HitStatus::hit) return !edge.turned_away;
  const bool own_object = seen.id == edge.object + 1 && seen.face >= 0;
  if (own_object && (seen.face == edge.face_a || seen.face == edge.face_b)) return true;
  const glm::dvec2 at = edge.a + s * (edge.b - edge.a);
  const CameraRay ray = camera_ray(camera_, at.x, at.y);
  const glm::dvec3 point = seen.position - input_.model.render_origin;
  const Polygons* polygons = input_.model.surfaces[static_cast<size_t>(seen.id - 1)].polygons.get();
  const glm::dvec3 facet = polygons && seen.face >= 0 ? polygons->edges().face_normals[static_cast<size_t>(seen.face)] : glm::dvec3(0.0);
  if (edge.turned_away && !(own_object && glm::dot(facet, ray.direction) >= 0.0)) return false;
  const glm::dvec3 backward = camera_.world_from_camera[2];
  const double z = depth_of(edge.q_a + s * (edge.q_b - edge.q_a)), seen_z = -glm::dot(point - camera_.eye, backward);
  const double along_axis = -glm::dot(ray.direction, backward);
  return z <= seen_z + bias(seen, facet, ray.direction, z / along_axis);
}

void EdgeVisibility::ask(const ImageEdge& edge, std::span<const double> places, Scratch& scratch) const {
  scratch.points_px.clear();
  for (const double s : places) scratch.points_px.push_back(edge.a + s * (edge.b - edge.a));
  scratch.samples.resize(places.size());
  scratch.visible.resize(places.size());
  sample_points(input_.model, input_.camera, scratch.points_px, scratch.samples);
  for (size_t i = 0; i < places.size(); ++i) scratch.visible[i] = shows(scratch.samples[i], edge, places[i]);
}

bool EdgeVisibility::visible(const ImageEdge& edge, double s) const {
  Scratch scratch;
  ask(edge, {&s, 1}, scratch);
  return scratch.visible[0];
}

void EdgeVisibility::visible_stretches(const ImageEdge& edge, Scratch& scratch, std::vector<EdgeStretch>& seen) const {
  const double length = glm::length(edge.b - edge.a);
  const int count = std::max(1, static_cast<int>(std::ceil(length / kStep_px)));
  scratch.places.clear();
  for (int i = 0; i < count; ++i) scratch.places.push_back((i + 0.5) / count);
  ask(edge, scratch.places, scratch);
  scratch.changes.clear();
  for (int i = 1; i < count; ++i) {
    if (scratch.visible[static_cast<size_t>(i)] != scratch.visible[static_cast<size_t>(i) - 1])
      scratch.changes.push_back({(i - 0.5) / count, (i + 0.5) / count});
  }
  bool now = scratch.visible[0];
  // Bisected all at once; whether the lower end of the first is seen says it of all of them, since they take turns.
  for (double gap = length / count; gap > kPlace_px && !scratch.changes.empty(); gap *= 0.5) {
    scratch.places.clear();
    for (const EdgeStretch& change : scratch.changes) scratch.places.push_back(0.5 * (change.from + change.to));
    ask(edge, scratch.places, scratch);
    for (size_t i = 0; i < scratch.changes.size(); ++i) {
      const bool lower_seen = now == (i % 2 == 0);
      (scratch.visible[i] == lower_seen ? scratch.changes[i].from : scratch.changes[i].to) = scratch.places[i];
    }
  }
  double start = 0.0;
  for (const EdgeStretch& change : scratch.changes) {
    // What is drawn ends where it was last seen.
    if (now) seen.push_back({start, change.from});
    start = change.to;
    now = !now;
  }
  if (now) seen.push_back({start, 1.0});
}

}  // namespace limn
