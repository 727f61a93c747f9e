// A picture that shows nothing says why: known places, sizes and angles, and random ones.

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <numbers>
#include <random>
#include <regex>

#include "raymarch/picture.h"
#include "run_program.h"
#include "samples/experiment/empty_picture.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

Scene scene_of(SceneObject object) {
  Scene scene;
  object.name = "it";
  scene.objects.push_back(std::move(object));
  return scene;
}

Scene ball(double radius = 1.0) { return scene_of({.source = make_shape("sphere", {{"radius", {radius}}})}); }

Scene mesh_scene(const std::vector<glm::dvec3>& positions, const std::vector<std::int32_t>& triangles) {
  Mesh mesh;
  mesh.positions = positions;
  mesh.corner_vertices = triangles;
  mesh.face_sizes.assign(triangles.size() / 3, 3);
  return scene_of({.source = mesh_source(std::move(mesh), {}, "a.obj")});
}

struct Seen {
  HitCounts counts;
  std::vector<std::string> reasons;
  std::string text() const {
    std::string all;
    for (const std::string& reason : reasons) all += reason + "\n";
    return all;
  }
};

Seen look(const Scene& scene, const CameraSettings& settings, const SurfaceSettings& surface = {.kind = ""}) {
  const SceneModel model = build_model(scene, surface);
  const Camera camera = resolve_camera(settings, bounds(scene));
  Seen seen{count_hits(render_gbuffer(model, camera, {})), {}};
  seen.reasons = why_empty(scene, model, camera, seen.counts);
  return seen;
}

CameraSettings camera_at(const glm::dvec3& eye, const glm::dvec3& target) {
  CameraSettings camera;
  camera.eye = eye;
  camera.target = target;
  camera.width_px = 96;
  camera.height_px = 64;
  return camera;
}

void expect_reason(const Seen& seen, const std::string& hint) {
  EXPECT_EQ(seen.counts.hits, 0);
  ASSERT_EQ(seen.reasons.size(), 1u) << seen.text();
  EXPECT_NE(seen.reasons[0].find(hint), std::string::npos) << "wanted '" << hint << "' in: " << seen.text();
}

TEST(EmptyPicture, AFullOneSaysNothing) {
  EXPECT_TRUE(look(ball(), camera_at({0, 0, 5}, {0, 0, 0})).reasons.empty());
  EXPECT_TRUE(look(ball(), camera_at({0, 0, 0.1}, {0, 0, -1})).reasons.empty()) << "from within";
}

TEST(EmptyPicture, BehindTheCamera) {
  expect_reason(look(ball(), camera_at({0, 0, 5}, {0, 0, 9})), "it lies behind the camera, by 4 at least");
  CameraSettings flat = camera_at({0, 0, 5}, {0, 0, 9});
  flat.projection = Projection::orthographic;
  flat.ortho_height = 3.0;
  expect_reason(look(ball(), flat), "behind the camera, by 4 at least");
}

TEST(EmptyPicture, OutsideTheFrame) {
  // The eye looks along -z; each target lies 60 degrees off the ball.
  const double far = 5.0 * std::tan(60.0 * std::numbers::pi / 180.0);
  expect_reason(look(ball(), camera_at({0, 0, 5}, {far, 0, 0})),
                "outside the frame, to the left: the camera looks 60 degrees past its middle");
  expect_reason(look(ball(), camera_at({0, 0, 5}, {-far, 0, 0})), "to the right: the camera looks 60 degrees");
  expect_reason(look(ball(), camera_at({0, 0, 5}, {0, far, 0})), "below: the camera looks 60 degrees");
  expect_reason(look(ball(), camera_at({0, 0, 5}, {0, -far, 0})), "above: the camera looks 60 degrees");
}

TEST(EmptyPicture, SmallerThanAPixel) {
  // At this distance a pixel is 2 tan(fov / 2) / 64 of it high; the ball lies between two pixels' centres.
  CameraSettings camera = camera_at({0, 0, 1000}, {0, 0, 0});
  const double pixel = 2.0 * std::tan(0.5 * camera.vertical_fov) * 1000.0 / 64.0;
  const Seen seen = look(ball(0.05 * pixel), camera);
  EXPECT_EQ(seen.counts.hits, 0);
  std::smatch found;
  const std::string text = seen.text();
  ASSERT_TRUE(std::regex_search(text, found, std::regex("smaller than a pixel \\(([0-9.]+) px\\)"))) << text;
  // Of the box about the ball, corner to corner.
  EXPECT_NEAR(std::stod(found[1]), 0.1 * std::sqrt(2.0), 0.03);
}

TEST(EmptyPicture, SeenEdgeOn) {
  const Scene plate = mesh_scene({{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}, {0, 1, 2, 0, 2, 3});
  expect_reason(look(plate, camera_at({0, 0, 5}, {0, 0, 0})), "seen edge-on");
  EXPECT_TRUE(look(plate, camera_at({0, 3, 5}, {0, 0, 0})).reasons.empty());
}

TEST(EmptyPicture, AMeshWithoutArea) {
  expect_reason(look(mesh_scene({{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}}, {0, 1, 2, 0, 1, 3}), camera_at({0, 2, 5}, {0, 0, 0})),
                "has no area: all 2 faces of its mesh are degenerate");
}

TEST(EmptyPicture, FromWithinAndPastAHole) {
  // An open box without its side towards -z: five faces of a cube, the camera in it.
  const Scene open = mesh_scene({{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}},
                                {4, 5, 6, 4, 6, 7, 0, 4, 7, 0, 7, 3, 1, 2, 6, 1, 6, 5});
  expect_reason(look(open, camera_at({0, 0, -0.9}, {0, 0, -5})), "has the camera within its bounds");
}

TEST(EmptyPicture, AFewHitsOfWhatTheBoundsPromise) {
  // A speck and, far off, one more: the bounds are large and hold next to nothing.
  std::vector<glm::dvec3> positions;
  std::vector<std::int32_t> triangles;
  for (const glm::dvec3& at : {glm::dvec3(-1, -1, 0), glm::dvec3(1, 1, 0)}) {
    const auto first = static_cast<std::int32_t>(positions.size());
    for (const glm::dvec3& by : {glm::dvec3(0, 0, 0), glm::dvec3(0.02, 0, 0), glm::dvec3(0, 0.02, 0)}) positions.push_back(at + by);
    triangles.insert(triangles.end(), {first, first + 1, first + 2});
  }
  CameraSettings camera = camera_at({0, 0, 5}, {0, 0, 0});
  camera.width_px = camera.height_px = 200;
  const Seen seen = look(mesh_scene(positions, triangles), camera);
  ASSERT_GT(seen.counts.hits, 0);
  ASSERT_EQ(seen.reasons.size(), 1u) << seen.text();
  EXPECT_TRUE(seen.reasons[0].starts_with(fmt::format("next to nothing is hit: {} of the ", seen.counts.hits))) << seen.text();
}

TEST(EmptyPicture, RandomCamerasAlwaysHaveAReasonThatHolds) {
  const unsigned seed = random_seed();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-6.0, 6.0);
  const Scene scene = ball();
  const SceneModel model = build_model(scene, {.kind = ""});
  int empty = 0;
  for (int k = 0; k < 400; ++k) {
    CameraSettings settings = camera_at({place(random), place(random), place(random)}, {place(random), place(random), place(random)});
    if (k % 3 == 0) {
      settings.projection = Projection::orthographic;
      settings.ortho_height = 3.0;
    }
    settings.width_px = 24;
    settings.height_px = 16;
    const Camera camera = resolve_camera(settings, bounds(scene));
    const HitCounts counts = count_hits(render_gbuffer(model, camera, {}));
    const std::vector<std::string> reasons = why_empty(scene, model, camera, counts);
    const auto where = [&] { return fmt::format("seed {} round {}: {}", seed, k, reasons.empty() ? "" : reasons[0]); };
    if (counts.hits > 0) {
      EXPECT_TRUE(reasons.empty()) << where();
      continue;
    }
    ++empty;
    ASSERT_EQ(reasons.size(), 1u) << where();
    const double depth = glm::dot(camera.eye, camera.world_from_camera[2]);  // of the ball's middle
    if (reasons[0].find("behind the camera") != std::string::npos) {
      EXPECT_LT(depth, 0.0) << where();
    } else if (depth > 1.8) {
      // The middle's place tells the side: a ball wholly beyond the left edge has its middle there.
      const glm::dvec3 at = project(camera, glm::dvec3(0.0));
      if (reasons[0].find("to the left") != std::string::npos) {
        EXPECT_LT(at.x, 0.0) << where();
      }
      if (reasons[0].find("to the right") != std::string::npos) {
        EXPECT_GT(at.x, 24.0) << where();
      }
      if (reasons[0].find("above") != std::string::npos) {
        EXPECT_LT(at.y, 0.0) << where();
      }
      if (reasons[0].find("below") != std::string::npos) {
        EXPECT_GT(at.y, 16.0) << where();
      }
    }
  }
  EXPECT_GT(empty, 100);
}

TEST(EmptyPicture, CommandsSaySo) {
  const TemporaryFolder folder;
  const RunResult drawn =
      run_limn({"render", "ellipsoid", "--size", "32x24", "--eye", "0,0,5", "--target", "0,0,9", "-o", folder.file("a.png"), "--json"});
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_NE(drawn.err.find("limn: warning: nothing is hit: ellipsoid lies behind the camera"), std::string::npos) << drawn.err;
  EXPECT_NE(drawn.json().at("warnings").dump().find("behind the camera"), std::string::npos);
  const RunResult compared = run_limn({"compare", "ellipsoid", "--size", "32x24", "--voxels", "16", "--level", "1", "--eye", "0,0,5",
                                       "--target", "0,0,9", "-o", folder.file("c"), "--json"});
  EXPECT_EQ(compared.exit_code, 0) << compared.err;
  EXPECT_NE(compared.err.find("behind the camera"), std::string::npos) << compared.err;
  EXPECT_NE(compared.json().at("warnings").dump().find("behind the camera"), std::string::npos);
  EXPECT_NE(read_bytes(folder.path() / "c/rows.json").find("behind the camera"), std::string::npos);
  const RunResult studied = run_limn({"study", "ellipsoid", "--size", "32x24", "--views", "1", "--surfaces", "level_set", "--voxels", "16",
                                      "--gradients", "cell", "--eye", "0,0,5", "--target", "0,0,9", "-o", folder.file("s")});
  EXPECT_NE(studied.err.find("behind the camera"), std::string::npos) << studied.err;
}

}  // namespace
}  // namespace limn
