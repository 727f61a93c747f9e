// Fields from lambdas go through everything that shapes do: pictures, level sets, truth.

#include <gtest/gtest.h>

#include <cmath>

#include "raymarch/measured_border.h"
#include "raymarch/metric.h"
#include "sdf/field_from_formula.h"
#include "sdf/field_from_functions.h"
#include "sdf/shape.h"

namespace limn {
namespace {

Scene scene_of_field(Field field) {
  Scene scene;
  scene.objects.push_back({.name = "torus", .source = std::move(field)});
  scene.camera.eye = glm::dvec3(2.0, 2.5, 3.5);
  scene.camera.target = glm::dvec3(0.0);
  scene.camera.width_px = 160, scene.camera.height_px = 120;
  return scene;
}

Field torus_of_functions() {
  return field_from_functions({.value = [](const glm::dvec3& p) { return std::hypot(std::hypot(p.x, p.z) - 1.0, p.y) - 0.4; },
                               .extent = {{-1.4, -0.4, -1.4}, {1.4, 0.4, 1.4}}});
}
Field torus_of_formula() {
  return field_from_formula([](auto x, auto y, auto z) { return sqrt(square(sqrt(x * x + z * z) - 1.0) + y * y) - 0.4; });
}

TEST(FunctionFields, AreDrawnAsTheShapeIs) {
  const Scene expected = scene_of_field(make_shape("torus", {{"major", {1.0}}, {"minor", {0.4}}}));
  const Camera camera = resolve_camera(expected.camera, bounds(expected));
  for (const char* kind : {"analytic", "level_set", "mesh"}) {
    const SurfaceSettings settings{.kind = kind, .voxels = 64};
    const GBuffer theirs = render_gbuffer(build_model(expected, settings), camera, {});
    for (const Field& field : {torus_of_functions(), torus_of_formula()}) {
      const Scene scene = scene_of_field(field);
      const GBuffer ours = render_gbuffer(build_model(scene, settings), camera, {});
      std::int64_t hits = 0, others = 0;
      double worst = 0.0;
      for (size_t i = 0; i < ours.id.size(); ++i) {
        hits += theirs.id.pixels[i] != 0;
        others += ours.id.pixels[i] != theirs.id.pixels[i];
        if (ours.id.pixels[i] != 0 && theirs.id.pixels[i] != 0 && theirs.n_dot_v.pixels[i] > 0.3f)
          worst = std::max(worst, std::abs(double{ours.depth.pixels[i]} - double{theirs.depth.pixels[i]}));
      }
      EXPECT_GT(hits, 2000) << kind;
      // Lattices and cages lie a little elsewhere where bounds are a little wider.
      EXPECT_LE(others, std::string(kind) == "analytic" ? 0 : 20) << kind;
      EXPECT_LT(worst, std::string(kind) == "analytic" ? 1e-5 : 0.01) << kind;
    }
  }
}

TEST(FunctionFields, HaveTheTruthOfTheShape) {
  const Scene expected = scene_of_field(make_shape("torus", {{"major", {1.0}}, {"minor", {0.4}}}));
  const Camera camera = resolve_camera(expected.camera, bounds(expected));
  const BorderTruth theirs = solve_truth(expected, camera, {}, {});
  ASSERT_TRUE(theirs.exact);
  for (const Field& field : {torus_of_functions(), torus_of_formula()}) {
    const Scene scene = scene_of_field(field);
    const BorderTruth ours = solve_truth(scene, camera, {}, {});
    const Picture none;
    for (const char* name : {"silhouette_displacement", "inner_displacement"}) {
      const std::vector<MetricValue> values = find_metric(name).measure({none, none, camera, &ours.curves, &theirs});
      EXPECT_LT(values[3].value, ours.bound_px + theirs.bound_px) << name;
      EXPECT_LT(values[6].value, 0.01) << name << " missing";
      EXPECT_LT(values[7].value, 0.01) << name << " false";
    }
  }
}

}  // namespace
}  // namespace limn
