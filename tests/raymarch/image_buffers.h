#pragma once
// G-buffers written down by hand: what image methods read, without a surface behind it.

#include <algorithm>
#include <cmath>

#include "raymarch/border/silhouette.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {

inline ParameterInput word(const std::string& text) {
  ParameterInput input;
  input.word = text;
  return input;
}

inline ParameterInput value(double number) {
  ParameterInput input;
  input.numbers = {number};
  return input;
}

inline Camera straight_camera(int width, int height, Projection projection, double scale_px) {
  Camera camera;
  camera.projection = projection;
  camera.eye = glm::dvec3(0.0);
  camera.focal_px = scale_px;
  camera.pixels_per_unit = scale_px;
  camera.width_px = width;
  camera.height_px = height;
  return camera;
}

inline GBuffer nothing_hit(int width, int height) {
  constexpr float far = std::numeric_limits<float>::infinity();
  GBuffer out;
  out.width = width;
  out.height = height;
  out.depth = {width, height, far};
  out.position = {width, height, glm::vec3(far)};
  out.normal = {width, height, glm::vec3(0.0f)};
  out.n_dot_v = {width, height, 0.0f};
  out.id = {width, height, 0};
  out.material = {width, height, 0};
  out.face = {width, height, -1};
  out.status = {width, height, 0};
  return out;
}

/// Puts a point of object 1 at pixel (x, y), in the camera of straight_camera.
inline void hit(GBuffer& out, const Camera& camera, int x, int y, double z, const glm::dvec3& normal, int id = 1) {
  const CameraRay ray = camera_ray(camera, x + 0.5, y + 0.5);
  const size_t i = out.id.index(x, y);
  const glm::dvec3 position = ray.origin + ray.direction * (z / -ray.direction.z);
  out.depth.pixels[i] = static_cast<float>(z);
  out.position.pixels[i] = glm::vec3(position);
  out.normal.pixels[i] = glm::vec3(normal);
  out.n_dot_v.pixels[i] = static_cast<float>(std::clamp(-glm::dot(normal, ray.direction), 0.0, 1.0));
  out.id.pixels[i] = id;
  out.status.pixels[i] = 1;
}

/// The plane normal.p = -distance, filled in wherever its ray meets it in front of the eye.
inline GBuffer plane_buffer(const Camera& camera, const glm::dvec3& normal, double distance) {
  GBuffer out = nothing_hit(camera.width_px, camera.height_px);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      const CameraRay ray = camera_ray(camera, x + 0.5, y + 0.5);
      const double t = (-distance - glm::dot(normal, ray.origin)) / glm::dot(normal, ray.direction);
      hit(out, camera, x, y, -t * ray.direction.z, normal);
    }
  }
  return out;
}

/// Every pixel for which `inside(x, y)` holds, facing the camera at depth 5.
template <class Inside>
GBuffer mask_buffer(const Camera& camera, const Inside& inside) {
  GBuffer out = nothing_hit(camera.width_px, camera.height_px);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      if (inside(x, y)) hit(out, camera, x, y, 5.0, {0.0, 0.0, 1.0});
    }
  }
  return out;
}

inline Border drawn(const std::string& method, const GBuffer& gbuffer, const Camera& camera,
                    const std::map<std::string, ParameterInput>& given = {}) {
  SceneModel model;
  model.colors = {glm::vec3(0.8f, 0.5f, 0.3f), glm::vec3(0.2f, 0.4f, 0.9f), glm::vec3(0.9f, 0.9f, 0.1f)};
  model.materials = {0, 0, 0};
  const Scene scene;
  return find_border_method(method).draw({gbuffer, camera, model, scene}, parameters_of(method, given));
}

inline double area(const Image<float>& ink) {
  double sum = 0.0;
  for (const float value : ink.pixels) sum += double{value};
  return sum;
}

/// Every method but these, so that a new one is held to what must hold of all of them: no line on a plane, ink in range, equal bytes.
inline const std::vector<std::string>& image_methods() {
  static const std::vector<std::string> others{"rim",     "fresnel",    "rim_width",  // ink a whole plane that grazes the view
                                               "extrude", "edge_quads", "contours"};  // draw the model, which a buffer lacks
  static const std::vector<std::string> names = [] {
    std::vector<std::string> found = border_methods().names();
    std::erase_if(found, [](const std::string& name) { return std::find(others.begin(), others.end(), name) != others.end(); });
    return found;
  }();
  return names;
}

}  // namespace limn::test
