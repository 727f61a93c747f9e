#include "raymarch/border/edge_visibility.h"

#include <cmath>

namespace limn {
namespace {

/// Where the visibility of an edge is asked for, along its image.
constexpr double kStep_px = 0.5;
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

/// Depth range of a polygon's corners.
Interval depth_range(const Polygons& polygons, std::int32_t face, const Camera& camera) {
  const Mesh& mesh = polygons.mesh();
  const std::vector<std::int32_t>& first = polygons.edges().first_corners;
  Interval range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::int32_t c = first[static_cast<size_t>(face)]; c < first[static_cast<size_t>(face) + 1]; ++c) {
    const glm::dvec3& corner = mesh.positions[static_cast<size_t>(mesh.corner_vertices[static_cast<size_t>(c)])];
    const double z = -glm::dot(corner - camera.eye, camera.world_from_camera[2]);
    range = {std::min(range.lower, z), std::max(range.upper, z)};
  }
  return range;
}

/// Depth along `ray` of the plane through `point`; infinite where the ray runs along it.
double plane_depth(const glm::dvec3& normal, const glm::dvec3& point, const CameraRay& ray, const Camera& camera) {
  const double t = glm::dot(normal, point - ray.origin) / glm::dot(normal, ray.direction);
  const double z = -glm::dot(ray.origin + t * ray.direction - camera.eye, camera.world_from_camera[2]);
  return std::isfinite(z) ? z : std::numeric_limits<double>::infinity();
}

}  // namespace

EdgeVisibility::EdgeVisibility(const BorderInput& input) : input_(input), camera_(moved(input.camera, input.model.render_origin)) {
  bool bounded = true;
  for (const Surface& surface : input.model.surfaces) {
    if (surface.bounds.empty()) continue;
    bounded = bounded && surface.bounds.finite();
    if (!surface.bounds.finite()) continue;
    radius_ = std::max(radius_, glm::length(glm::max(glm::abs(surface.bounds.lower), glm::abs(surface.bounds.upper))));
  }
  // Beside an unbounded surface rays are not cut to the sphere and start at the eye.
  if (!bounded) radius_ = std::max(radius_, glm::length(camera_.eye));
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

// The depth of what a pixel sees, continued to the ray that is asked about: along the plane of the polygon seen, or of the normal seen.
// It must not be continued beyond the surface: a polygon reaches no deeper than its corners, anything else no deeper than the pixels
// around show.
double EdgeVisibility::seen_depth(size_t pixel, const CameraRay& ray) const {
  const GBuffer& seen = input_.gbuffer;
  const std::int32_t id = seen.id.pixels[pixel], face = seen.face.pixels[pixel];
  const Polygons* polygons = input_.model.surfaces[static_cast<size_t>(id - 1)].polygons.get();
  if (polygons && face >= 0) {
    const Interval range = depth_range(*polygons, face, camera_);
    const glm::dvec3& normal = polygons->edges().face_normals[static_cast<size_t>(face)];
    const auto corner = static_cast<size_t>(polygons->edges().first_corners[static_cast<size_t>(face)]);
    const glm::dvec3& point = polygons->mesh().positions[static_cast<size_t>(polygons->mesh().corner_vertices[corner])];
    return std::clamp(plane_depth(normal, point, ray, camera_), range.lower, range.upper);
  }
  const int x = static_cast<int>(pixel % static_cast<size_t>(seen.width)), y = static_cast<int>(pixel / static_cast<size_t>(seen.width));
  Interval range{double{seen.depth.pixels[pixel]}, double{seen.depth.pixels[pixel]}};
  for (int v = y - 1; v <= y + 1; ++v) {
    for (int u = x - 1; u <= x + 1; ++u) {
      if (!seen.id.inside(u, v) || seen.id.at(u, v) != id) continue;
      range = {std::min(range.lower, double{seen.depth.at(u, v)}), std::max(range.upper, double{seen.depth.at(u, v)})};
    }
  }
  const CameraRay own = camera_ray(camera_, x + seen.sample.x, y + seen.sample.y);
  const double t = double{seen.depth.pixels[pixel]} / -glm::dot(own.direction, camera_.world_from_camera[2]);
  const glm::dvec3 point = own.origin + t * own.direction;
  return std::clamp(plane_depth(glm::dvec3(seen.normal.pixels[pixel]), point, ray, camera_), range.lower, range.upper);
}

// The bias of the depth test, derived. An edge point and a pixel's sample lie up to a pixel apart, across which the surface changes depth
// by its slope: seen_depth continues the surface seen to the edge point's own ray, which takes all of that up and leaves rounding alone.
// With u = 2^-24, half a unit in the last place of 1, and R the radius within which rays are single precision: the ray's origin (at most
// R from the middle in each of three coordinates: R u each, sqrt(3) R u together) and its direction (sqrt(3) u over at most 2 R) put the
// hit at most 3 sqrt(3) R u < 5.2 R u beside the ray, which changes depth by that times the slope, and as much along it; its t, at most
// 2 R, adds 2 R u; the stored depth Z u. Together u (Z + 2 R + 5.2 R (1 + slope)). The polygon's own plane is known in double, so that the
// slope enters only where the plane is that of a normal in single precision: there the position is the hit's.
bool EdgeVisibility::hides(size_t pixel, const ImageEdge& edge, const glm::dvec2& at_px, double z) const {
  const GBuffer& seen = input_.gbuffer;
  const std::int32_t id = seen.id.pixels[pixel], face = seen.face.pixels[pixel];
  if (id == 0) return false;
  // A pixel that shows one of the edge's own faces shows its border too.
  if (id == edge.object + 1 && face >= 0 && (face == edge.face_a || face == edge.face_b)) return false;
  const CameraRay ray = camera_ray(camera_, at_px.x, at_px.y);
  const double cosine = std::abs(glm::dot(glm::dvec3(seen.normal.pixels[pixel]), ray.direction));
  // A slope above a thousand is an edge-on face, of which no pixel sees more than a thousandth.
  const double slope = std::min(1e3, std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / std::max(cosine, 1e-3));
  const double bias = std::ldexp(z + 2.0 * radius_ + 5.2 * radius_ * (1.0 + slope), -24);
  return z > seen_depth(pixel, ray) + bias;
}

/// The pixel sees a polygon of this object from behind.
bool EdgeVisibility::shows_back(size_t pixel, std::int32_t object) const {
  const GBuffer& seen = input_.gbuffer;
  const std::int32_t face = seen.face.pixels[pixel];
  if (seen.id.pixels[pixel] != object + 1 || face < 0) return false;
  const Polygons& polygons = *input_.model.surfaces[static_cast<size_t>(object)].polygons;
  const glm::dvec3 point = glm::dvec3(seen.position.pixels[pixel]) - input_.model.render_origin;
  return glm::dot(polygons.edges().face_normals[static_cast<size_t>(face)], view_vector(camera_, point)) <= 0.0;
}

// Seen where one of the four samples around the point sees nothing nearer: about a point of the outline some of them look past the
// object, about a hidden point all of them are on what hides it. An edge both of whose faces are turned away is no outline, and a sample
// that looks past the object says nothing about it: it is seen where backs are seen.
bool EdgeVisibility::visible(const ImageEdge& edge, double s) const {
  const GBuffer& seen = input_.gbuffer;
  const glm::dvec2 at = edge.a + s * (edge.b - edge.a);
  const double z = depth_of(edge.q_a + s * (edge.q_b - edge.q_a));
  const auto x0 = static_cast<int>(std::floor(at.x - seen.sample.x)), y0 = static_cast<int>(std::floor(at.y - seen.sample.y));
  for (int y = y0; y <= y0 + 1; ++y) {
    for (int x = x0; x <= x0 + 1; ++x) {
      // Beyond the picture's sides the nearest pixel speaks for the margin.
      const int u = std::clamp(x, 0, seen.width - 1), v = std::clamp(y, 0, seen.height - 1);
      const size_t pixel = seen.id.index(u, v);
      if (edge.turned_away && !shows_back(pixel, edge.object)) continue;
      if (!hides(pixel, edge, at, z)) return true;
    }
  }
  return false;
}

void EdgeVisibility::visible_stretches(const ImageEdge& edge, std::vector<Stretch>& seen) const {
  const double length = glm::length(edge.b - edge.a);
  const int count = std::max(1, static_cast<int>(std::ceil(length / kStep_px)));
  int start = -1;
  for (int i = 0; i <= count; ++i) {
    const bool now = i < count && visible(edge, (i + 0.5) / count);
    if (now && start < 0) start = i;
    if (now || start < 0) continue;
    seen.push_back({static_cast<double>(start) / count, static_cast<double>(i) / count});
    start = -1;
  }
}

}  // namespace limn
