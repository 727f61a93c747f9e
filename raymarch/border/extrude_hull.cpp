// Where the corners of a mesh go when it is extruded.

#include "raymarch/border/extrude.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

/// Sine of the angle to the eye up to which a corner that faces it grows by less than the width: 17 degrees.
constexpr double kFacing = 0.3;

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0.0 && std::isfinite(length) ? v / length : glm::dvec3(0.0);
}

struct Frame {
  const Polygons& polygons;
  ExtrudeDirection direction;
  Affine render_from_object;
  glm::dmat3 object_from_render, transposed;
  std::span<const glm::vec3> normals{};  ///< By corner, or by vertex for smooth ones.

  glm::dvec3 normal(size_t corner) const {
    const bool smooth = direction == ExtrudeDirection::smooth_normal;
    return glm::dvec3(normals[smooth ? static_cast<size_t>(polygons.mesh().corner_vertices[corner]) : corner]);
  }
  bool by_position() const { return direction == ExtrudeDirection::position || direction == ExtrudeDirection::normalized_position; }

  /// The displacement for a width of 1, taken in object space and brought to render space.
  glm::dvec3 in_object(size_t corner, const glm::dvec3& point) const {
    if (!by_position()) return render_from_object.linear * unit_or_zero(transposed * normal(corner));
    const glm::dvec3 from_origin = point - render_from_object.translation;
    if (direction == ExtrudeDirection::position) return from_origin;
    const double length = glm::length(object_from_render * from_origin);
    return length > 0.0 ? from_origin / length : glm::dvec3(0.0);
  }
  /// The direction whose image counts, in render space.
  glm::dvec3 in_render(size_t corner, const glm::dvec3& point) const {
    return by_position() ? point - render_from_object.translation : normal(corner);
  }
};

}  // namespace

glm::dvec3 in_camera_axes(const Camera& camera, const glm::dvec3& p) {
  const glm::dvec3 q = glm::transpose(camera.world_from_camera) * (p - camera.eye);
  return {q.x, q.y, -q.z};
}

// In clip space the offset is normalize(n_px) / size_px * w_clip * width * 2: clip coordinates are pixels times 2 w_clip / size_px, so that
// after the division by w_clip it is `width` pixels long whatever the picture's shape and the depth. n_px is the normal in camera axes
// without its depth: it is square to the contour in the image, in perspective too, since the tangent plane at a contour point holds the
// eye. n_clip.xy itself is not where the picture is not square: its parts are stretched by 2 f / size_px, and are multiplied by size_px
// first. Here the same is written in camera axes, where a pixel is Z / focal_px wide.
PassingVector<glm::dvec3> extrude_corners(const Polygons& polygons, const Affine& render_from_object, const ExtrudeSettings& settings,
                                          const Camera& camera) {
  const Mesh& mesh = polygons.mesh();
  Frame frame{
      polygons, settings.direction, render_from_object, glm::inverse(render_from_object.linear), glm::transpose(render_from_object.linear),
      {}};
  if (settings.direction == ExtrudeDirection::vertex_normal) frame.normals = polygons.corner_normals();
  if (settings.direction == ExtrudeDirection::smooth_normal) frame.normals = polygons.smooth_normals();
  const glm::dmat3 camera_from_render = glm::transpose(camera.world_from_camera);
  PassingVector<glm::dvec3> grown(mesh.corner_vertices.size());
  parallel_for(size_t{0}, mesh.corner_vertices.size(), [&](size_t i) {
    const glm::dvec3& point = mesh.positions[static_cast<size_t>(mesh.corner_vertices[i])];
    const glm::dvec3 rest = in_camera_axes(camera, point);
    if (settings.space == ExtrudeSpace::object) {
      grown[i] = in_camera_axes(camera, point + settings.object_width * frame.in_object(i, point));
      return;
    }
    const glm::dvec3 towards = camera_from_render * unit_or_zero(frame.in_render(i, point));
    const glm::dvec2 across(towards);
    const double length = glm::length(across);
    // A normal that points straight at the eye has no direction in the image; below this it is rounding (normals are single precision).
    glm::dvec2 direction = length > 1e-6 ? across / length : glm::dvec2(0.0);
    // Around the place that faces the eye directions run apart in all ways, and triangles as small as the width would fold over: backs in
    // the middle of the surface. No contour is near.
    if (!frame.by_position() && towards.z > 0.0) direction *= std::min(1.0, length / kFacing);
    const double pixel = camera.projection == Projection::perspective ? rest.z / camera.focal_px : 1.0 / camera.pixels_per_unit;
    grown[i] = rest + glm::dvec3(settings.width_px * pixel * direction, 0.0);
  });
  return grown;
}

}  // namespace limn
