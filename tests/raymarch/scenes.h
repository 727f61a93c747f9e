#pragma once
// What the tests of this folder draw: one field, one camera, one model, in few words.

#include <gtest/gtest.h>

#include <random>

#include "raymarch/gbuffer.h"
#include "raymarch/picture.h"
#include "sdf/shape.h"

namespace limn::test {

inline SceneObject object_of(const Field& field, const std::string& name = "object") {
  return {name, field, {}, glm::vec3(0.8f, 0.5f, 0.3f), 0, std::nullopt};
}

inline SceneObject object_of(const Mesh& mesh, std::optional<Scheme> scheme = std::nullopt) {
  return {"mesh", MeshSource{mesh, scheme, "test mesh"}, {}, glm::vec3(0.8f, 0.5f, 0.3f), 0, std::nullopt};
}

inline Scene scene_of(std::vector<SceneObject> objects) {
  Scene scene;
  scene.name = "test";
  scene.objects = std::move(objects);
  return scene;
}

inline SurfaceSettings surface_kind(const std::string& kind) {
  SurfaceSettings settings;
  settings.kind = kind;
  return settings;
}

inline SceneModel model_of(const Scene& scene, const std::string& kind = "analytic") { return build_model(scene, surface_kind(kind)); }

inline CameraSettings view(int width, int height, Projection projection = Projection::perspective) {
  CameraSettings settings;
  settings.projection = projection;
  settings.width_px = width;
  settings.height_px = height;
  return settings;
}

inline Camera framing(const Scene& scene, CameraSettings settings) { return resolve_camera(settings, bounds(scene)); }

inline Parameters parameters_of(const std::string& method, const std::map<std::string, ParameterInput>& given = {}) {
  return resolve(find_border_method(method).parameters, given);
}

inline MethodCall call_of(const std::string& method, const std::map<std::string, ParameterInput>& given = {}) {
  return {&find_border_method(method), parameters_of(method, given)};
}

/// A box of quads, wound outwards.
inline Mesh box_mesh(const glm::dvec3& half) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.push_back(half * glm::dvec3((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1));
  mesh.corner_vertices = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
  mesh.face_sizes.assign(6, 4);
  return mesh;
}

/// Largest and mean of what is added.
struct Errors {
  double largest = 0.0, sum = 0.0;
  int count = 0;
  void add(double error) {
    largest = std::max(largest, error);
    sum += error;
    ++count;
  }
  double mean() const { return count ? sum / count : 0.0; }
};

inline double angle_between(const glm::dvec3& a, const glm::dvec3& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)); }

}  // namespace limn::test
