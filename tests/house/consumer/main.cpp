// Another project's unit test: the silhouette of a sphere, drawn through the installed library, has the area of its disc.
#include <raymarch/picture.h>
#include <sdf/shape.h>
#include <cmath>
#include <cstdio>

int main() {
  limn::Scene scene;
  scene.objects.push_back({.name = "ball", .source = limn::make_shape("sphere", {{"radius", {1.0}}})});
  scene.camera.projection = limn::Projection::orthographic;
  scene.camera.eye = glm::dvec3(0.0, 0.0, 5.0);
  scene.camera.target = glm::dvec3(0.0);
  scene.camera.ortho_height = 2.5;
  scene.camera.width_px = scene.camera.height_px = 200;
  const limn::SceneModel model = limn::build_model(scene, {});
  const limn::Camera camera = limn::resolve_camera(scene.camera, model.bounds);
  const limn::GBuffer gbuffer = limn::render_gbuffer(model, camera, {});
  const double radius_px = 200.0 / 2.5;
  const double expected = 3.14159265358979 * radius_px * radius_px;
  const double hits = static_cast<double>(limn::count_hits(gbuffer).hits);
  std::printf("hits %.0f, disc %.1f\n", hits, expected);
  // Gauss circle problem: the count differs from the area by far less than the circumference.
  return std::fabs(hits - expected) < 2.0 * radius_px ? 0 : 1;
}
