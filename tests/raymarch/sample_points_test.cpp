// Single image points: what packets of them hit, beside rays that go one by one.

#include "tests/random_seed.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

std::vector<glm::dvec2> random_points(const Camera& camera, size_t count, std::mt19937& random) {
  std::uniform_real_distribution<double> x(0.0, camera.width_px), y(0.0, camera.height_px);
  std::vector<glm::dvec2> points(count);
  for (glm::dvec2& point : points) point = {x(random), y(random)};
  return points;
}

struct Case {
  SceneModel model;
  Camera camera;
  double voxel = 0.0;
};

/// A torus through a ball, from outside, or from inside the ball.
Case level_set_case(const std::string& gradient, bool from_inside) {
  const Scene scene = scene_of({object_of(
      combine(Csg::union_, make_shape("torus", {{"major", {0.8}}, {"minor", {0.25}}}), make_shape("sphere", {{"radius", {0.5}}}), 0.1))});
  SurfaceSettings settings = surface_kind("level_set");
  settings.voxels = 96;
  settings.gradient = gradient;
  CameraSettings seen = view(160, 120);
  Case made{build_model(scene, settings), framing(scene, seen), 0.0};
  if (from_inside) made.camera.eye = glm::dvec3(0.0);
  made.voxel = made.model.surfaces.front().info.voxel_size;
  return made;
}

class SamplePoints : public testing::TestWithParam<std::tuple<std::string, bool>> {};

TEST_P(SamplePoints, PacketsHitWhereSingleRaysDo) {
  const auto& [gradient, from_inside] = GetParam();
  const Case made = level_set_case(gradient, from_inside);
  std::mt19937 random(random_seed());
  const std::vector<glm::dvec2> points = random_points(made.camera, 4000, random);
  std::vector<PointSample> packets(points.size()), single(points.size());
  sample_points(made.model, made.camera, points, packets, PointRays::in_packets);
  sample_points(made.model, made.camera, points, single);
  int hits = 0, differ = 0, bent = 0;
  double worst_voxels = 0.0, worst_normal = 0.0;
  for (size_t i = 0; i < points.size(); ++i) {
    if (packets[i].status != single[i].status) {
      ++differ;
      continue;
    }
    if (single[i].status != HitStatus::hit) continue;
    ++hits;
    // A cell's own gradient jumps from cell to cell, and grazing rays slide: neither is what rays differ by.
    if (double{single[i].n_dot_v} < 0.2) continue;
    worst_voxels = std::max(worst_voxels, glm::distance(packets[i].position, single[i].position) / made.voxel);
    if (gradient == "cell") continue;
    const double normal = double{glm::length(packets[i].normal - single[i].normal)};
    worst_normal = std::max(worst_normal, normal);
    bent += normal > 5e-4;
  }
  EXPECT_GT(hits, 500);
  EXPECT_LE(differ, 1);  // on the very silhouette
  EXPECT_LT(worst_voxels, 0.01);
  // Packets' spline differs in a few cells of the concave seam, as it does in pictures.
  EXPECT_LE(bent, 4);
  EXPECT_LT(worst_normal, 0.05);
}

TEST_P(SamplePoints, OfAPacketDependOnNoOther) {
  const auto& [gradient, from_inside] = GetParam();
  const Case made = level_set_case(gradient, from_inside);
  std::mt19937 random(random_seed());
  const std::vector<glm::dvec2> points = random_points(made.camera, 700, random);
  std::vector<PointSample> together(points.size());
  sample_points(made.model, made.camera, points, together, PointRays::in_packets);
  int hits = 0, differ = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    PointSample alone;
    sample_points(made.model, made.camera, {&points[i], 1}, {&alone, 1}, PointRays::in_packets);
    const bool hit = alone.status == HitStatus::hit;
    hits += hit;
    differ += alone.status != together[i].status || alone.id != together[i].id ||
              (hit && (alone.position != together[i].position || alone.normal != together[i].normal));
  }
  EXPECT_GT(hits, 80);
  EXPECT_EQ(differ, 0);
}

INSTANTIATE_TEST_SUITE_P(Gradients, SamplePoints,
                         testing::Combine(testing::Values("cell", "central", "cubic"), testing::Values(false, true)),
                         [](const auto& of) { return std::get<0>(of.param) + (std::get<1>(of.param) ? "FromInside" : ""); });

}  // namespace
}  // namespace limn::test
