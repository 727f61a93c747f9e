// Scenes of several kinds of objects: fields and cages are as exact together as alone, and what else there is says that it is not.

#include <fmt/core.h>

#include "raymarch/truth.h"
#include "tests/raymarch/border_distance.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

Camera looking(const glm::dvec3& eye, const glm::dvec3& target, Projection projection) {
  CameraSettings settings = view(320, 240, projection);
  settings.eye = eye;
  settings.target = target;
  if (projection == Projection::orthographic) settings.ortho_height = 2.6;
  return resolve_camera(settings, {});
}

/// Beside a cage a field is as exact as alone: what is not hidden is where it was, what is hidden is gone.
TEST(TruthMixed, FieldsAndCagesTogetherAreEachWhatTheyAreAlone) {
  const SceneObject ball = object_of(make_shape("sphere", {{"radius", {0.6}}}), "ball");
  SceneObject block = object_of(box_mesh({0.5, 0.4, 0.3}), Scheme::catmark);
  block.world_from_object.translation = {0.45, 0.2, 1.2};
  const Scene both = scene_of({ball, block});
  for (const Projection projection : {Projection::orthographic, Projection::perspective}) {
    const Camera camera = looking({0.4, 0.5, 5.0}, {0.1, 0.0, 0.5}, projection);
    const BorderTruth truth = solve_truth(both, camera, {}, {}), alone = solve_truth(scene_of({ball}), camera, {}, {}),
                      front = solve_truth(scene_of({block}), camera, {}, {});
    EXPECT_TRUE(truth.exact);
    EXPECT_LT(truth.bound_px, 0.01);
    EXPECT_EQ(truth.contour_generators, 2);
    EXPECT_EQ(truth.level_curves, alone.level_curves + front.level_curves);
    const auto expect_part_of = [&](const BorderCurves& part, int object, const BorderCurves& whole) {
      for (const BorderCurve& curve : part.curves) {
        if (curve.object != object) continue;
        for (const BorderPoint& point : curve.points) EXPECT_LT(distance_to(whole, curve.kind, point.px), 0.01);
      }
    };
    expect_part_of(truth.curves, 1, alone.curves);
    expect_part_of(truth.curves, 2, front.curves);
    const SceneModel cover = model_of(scene_of({block}), "mesh");
    int hidden = 0, seen = 0;
    for (const BorderCurve& curve : alone.curves.curves) {
      for (const BorderPoint& point : curve.points) {
        if (distance_to(front.curves, CurveKind::silhouette, point.px) < 0.5) continue;
        std::vector<PointSample> sample(1);
        sample_points(cover, camera, std::span(&point.px, 1), sample);
        const bool covered = sample[0].status == HitStatus::hit;
        EXPECT_EQ(distance_to(truth.curves, curve.kind, point.px, 1) > 0.01, covered);
        ++(covered ? hidden : seen);
      }
    }
    EXPECT_GT(hidden, 5);
    EXPECT_GT(seen, 20);
  }
}

/// A mesh that is all there is says so; a cage beside it is carried on to its limit.
TEST(TruthMixed, BesideARawMeshCagesAreExtrapolated) {
  SceneObject raw = object_of(box_mesh({0.3, 0.3, 0.3}));
  raw.name = "raw";
  raw.world_from_object.translation = {-1.5, 0.0, 0.0};
  SceneObject cage = object_of(box_mesh({0.5, 0.4, 0.3}), Scheme::catmark);
  cage.name = "cage";
  const Scene scene = scene_of({raw, cage});
  const Camera camera = looking({0.3, 1.9, 4.5}, {-0.5, 0.0, 0.0}, Projection::perspective);
  const BorderTruth truth = solve_truth(scene, camera, {}, {}), limit = solve_truth(scene_of({cage}), camera, {}, {});
  EXPECT_FALSE(truth.exact);
  ASSERT_EQ(truth.notes.size(), 2u);
  EXPECT_NE(truth.notes[0].find("cannot be refined"), std::string::npos) << truth.notes[0];
  EXPECT_NE(truth.notes[1].find("extrapolated"), std::string::npos) << truth.notes[1];
  double worst = 0.0;
  for (const BorderCurve& curve : truth.curves.curves) {
    if (curve.object != 2) continue;
    for (const BorderPoint& point : curve.points) worst = std::max(worst, distance_to(limit.curves, curve.kind, point.px));
  }
  EXPECT_LT(worst, 0.05);
  fmt::print("extrapolated cage: {:.4f} px from its limit at most; {}\n", worst, truth.notes[1]);
}

}  // namespace
}  // namespace limn::test
