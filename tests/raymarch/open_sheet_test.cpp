// Open meshes seen from behind: normals turned towards the eye where most of what is seen is the back, and nowhere else. Hard edges of what
// is drawn as it is. Sizes that cannot be drawn.

#include <numbers>
#include <random>

#include "sdf/error.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

/// Half a ball above y = 0, open below: its front outside.
Mesh bowl(int rings, int sectors) {
  Mesh mesh;
  mesh.positions.emplace_back(0, 1, 0);
  for (int ring = 1; ring <= rings; ++ring)
    for (int sector = 0; sector < sectors; ++sector) {
      const double theta = 0.5 * std::numbers::pi * ring / rings, phi = 2.0 * std::numbers::pi * sector / sectors;
      mesh.positions.emplace_back(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
    }
  const auto at = [&](int ring, int sector) { return ring == 0 ? 0 : 1 + (ring - 1) * sectors + sector % sectors; };
  for (int sector = 0; sector < sectors; ++sector) {
    mesh.face_sizes.push_back(3);
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), {0, at(1, sector), at(1, sector + 1)});
    for (int ring = 1; ring < rings; ++ring) {
      mesh.face_sizes.push_back(4);
      mesh.corner_vertices.insert(mesh.corner_vertices.end(),
                                  {at(ring, sector), at(ring + 1, sector), at(ring + 1, sector + 1), at(ring, sector + 1)});
    }
  }
  return mesh;
}

Scene bowl_scene() { return scene_of({object_of(bowl(12, 40))}); }

Camera looking_from(const Scene& scene, const glm::dvec3& direction, int width = 160, int height = 120) {
  CameraSettings settings = view(width, height);
  settings.direction = direction;
  settings.up = std::abs(direction.y) > 0.9 * glm::length(direction) ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  return framing(scene, settings);
}

GBuffer plain(const Scene& scene, const Camera& camera) {
  SceneModel model = model_of(scene, "mesh");
  for (Surface& surface : model.surfaces) surface.open_sheet.reset();
  return render_gbuffer(model, camera, {});
}

TEST(OpenSheet, FromInsideTheNormalsAreTurnedAndNothingElse) {
  const Scene scene = bowl_scene();
  const SceneModel model = model_of(scene, "mesh");
  for (const glm::dvec3& direction : {glm::dvec3(0, -1, 0), glm::dvec3(0.3, -1, 0.2)}) {
    const Camera camera = looking_from(scene, direction);
    const GBuffer seen = render_gbuffer(model, camera, {}), before = plain(scene, camera);
    ASSERT_EQ(seen.turned, std::vector<std::int32_t>{1});
    int backs = 0;
    for (size_t i = 0; i < seen.id.size(); ++i) {
      ASSERT_EQ(seen.id.pixels[i], before.id.pixels[i]);
      if (seen.id.pixels[i] == 0) continue;
      ASSERT_EQ(seen.depth.pixels[i], before.depth.pixels[i]);
      const bool back = before.n_dot_v.pixels[i] <= 0.0f;
      backs += back;
      ASSERT_EQ(seen.normal.pixels[i], back ? -before.normal.pixels[i] : before.normal.pixels[i]);
      if (!back) {
        ASSERT_EQ(seen.n_dot_v.pixels[i], before.n_dot_v.pixels[i]);
      }
      // The inside of a ball: N.V is what the outside has at the mirrored place, not below 0.
      ASSERT_GE(seen.n_dot_v.pixels[i], 0.0f);
    }
    EXPECT_GT(backs, 2000);
  }
}

TEST(OpenSheet, FromTheFrontEveryPixelStays) {
  const Scene scene = bowl_scene();
  const SceneModel model = model_of(scene, "mesh");
  for (const glm::dvec3& direction : {glm::dvec3(0, 1, 0), glm::dvec3(1, 1, 0), glm::dvec3(1, 0.2, 0.5)}) {
    const Camera camera = looking_from(scene, direction);
    const GBuffer seen = render_gbuffer(model, camera, {}), before = plain(scene, camera);
    EXPECT_TRUE(seen.turned.empty());
    EXPECT_EQ(seen.n_dot_v.pixels, before.n_dot_v.pixels);
    EXPECT_EQ(seen.normal.pixels, before.normal.pixels);
  }
}

TEST(OpenSheet, ClosedMeshesNeverHaveTwoSides) {
  // Seen from within, all of a closed box is back, and stays so.
  const Scene scene = scene_of({object_of(box_mesh({1.0, 1.0, 1.0}))});
  CameraSettings settings = view(80, 60);
  settings.eye = glm::dvec3(0.0, 0.0, 0.9);
  settings.target = glm::dvec3(0.0);
  const GBuffer seen = render_gbuffer(model_of(scene, "mesh"), framing(scene, settings), {});
  EXPECT_TRUE(seen.turned.empty());
  for (const float n_dot_v : seen.n_dot_v.pixels) EXPECT_EQ(n_dot_v, 0.0f);
  // One face taken out, it has.
  Mesh open = box_mesh({1.0, 1.0, 1.0});
  open.face_sizes.pop_back();
  open.corner_vertices.resize(20);
  const Scene opened = scene_of({object_of(open)});
  EXPECT_EQ(render_gbuffer(model_of(opened, "mesh"), framing(opened, settings), {}).turned, std::vector<std::int32_t>{1});
  // Vertices twice at one place are no opening.
  Mesh doubled;
  const Mesh box = box_mesh({1.0, 1.0, 1.0});
  for (const std::int32_t v : box.corner_vertices) {
    doubled.corner_vertices.push_back(static_cast<std::int32_t>(doubled.positions.size()));
    doubled.positions.push_back(box.positions[static_cast<size_t>(v)]);
  }
  doubled.face_sizes = box.face_sizes;
  const Scene seams = scene_of({object_of(doubled)});
  EXPECT_TRUE(render_gbuffer(model_of(seams, "mesh"), framing(seams, settings), {}).turned.empty());
}

TEST(OpenSheet, ThreadsTilesSamplesAndSizesChangeNothing) {
  const Scene scene = bowl_scene();
  const SceneModel model = model_of(scene, "mesh");
  const Camera camera = looking_from(scene, {0.2, -1.0, 0.1});
  ExecutionSettings one;
  one.threads = 1;
  ExecutionSettings small;
  small.tile_px = 5;
  const GBuffer a = render_gbuffer(model, camera, {}), b = render_gbuffer(model, camera, one), c = render_gbuffer(model, camera, small);
  EXPECT_EQ(a.n_dot_v.pixels, b.n_dot_v.pixels);
  EXPECT_EQ(a.n_dot_v.pixels, c.n_dot_v.pixels);
  for (int sample = 1; sample < 8; ++sample)
    EXPECT_EQ(render_gbuffer(model, camera, {}, sample_offset(sample, 8)).turned, a.turned) << sample;
  for (const int scale : {2, 3}) {
    const Camera larger = looking_from(scene, {0.2, -1.0, 0.1}, 160 * scale, 120 * scale);
    EXPECT_EQ(render_gbuffer(model, larger, {}).turned, a.turned);
  }
}

TEST(OpenSheet, SinglePointsAreAsThePicture) {
  const Scene scene = bowl_scene();
  const SceneModel model = model_of(scene, "mesh");
  const unsigned seed = 7;
  std::mt19937 random(seed);
  for (const glm::dvec3& direction : {glm::dvec3(0.2, -1.0, 0.1), glm::dvec3(0.2, 1.0, 0.1)}) {
    const Camera camera = looking_from(scene, direction);
    const GBuffer seen = render_gbuffer(model, camera, {});
    std::vector<glm::dvec2> points;
    for (int i = 0; i < 500; ++i) points.emplace_back(static_cast<double>(random() % 160) + 0.5, static_cast<double>(random() % 120) + 0.5);
    std::vector<PointSample> samples(points.size());
    sample_points(model, camera, points, samples);
    for (size_t i = 0; i < points.size(); ++i) {
      if (samples[i].status != HitStatus::hit) continue;
      const size_t pixel = seen.id.index(static_cast<int>(points[i].x), static_cast<int>(points[i].y));
      ASSERT_NEAR(std::clamp(samples[i].n_dot_v, 0.0f, 1.0f), seen.n_dot_v.pixels[pixel], 1e-4f) << "seed " << seed;
    }
  }
}

TEST(OpenSheet, APictureSaysSo) {
  const Scene scene = bowl_scene();
  PictureSettings settings;
  settings.methods = {call_of("rim")};
  const auto notes_from = [&](const glm::dvec3& direction) {
    std::string all;
    for (const std::string& note : draw_picture(scene, model_of(scene, "mesh"), looking_from(scene, direction), settings, {}).notes)
      all += note + "\n";
    return all;
  };
  EXPECT_NE(notes_from({0, -1, 0}).find("'mesh' is open and shows mostly its back"), std::string::npos);
  EXPECT_EQ(notes_from({0, 1, 0}).find("shows mostly its back"), std::string::npos);
}

TEST(HardEdges, ACubeWithoutNormalsIsDrawnWithFacets) {
  const Mesh box = box_mesh({1.0, 0.7, 0.4});
  const auto normals = [&](std::optional<double> angle) {
    SceneObject object = object_of(box);
    std::get<MeshSource>(object.source).smooth_angle_deg = angle;
    const Scene scene = scene_of({object});
    return render_gbuffer(model_of(scene, "mesh"), looking_from(scene, {1, 0.8, 1.2}), {}).normal.pixels;
  };
  const Pixels<glm::vec3> usual = normals(std::nullopt);
  int seen = 0;
  for (const glm::vec3& n : usual) {
    if (n == glm::vec3(0.0f)) continue;
    ++seen;
    EXPECT_NEAR(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1.0f, 1e-6f);
  }
  EXPECT_GT(seen, 1000);
  EXPECT_EQ(normals(30.0), usual);
  EXPECT_NE(normals(180.0), usual) << "smooth everywhere, as asked for";
}

TEST(HardEdges, GroupsAndNormalsOfTheFileComeFirst) {
  Mesh box = box_mesh({1.0, 0.7, 0.4});
  const auto normals = [&](const Mesh& mesh, std::optional<double> angle) {
    SceneObject object = object_of(mesh);
    std::get<MeshSource>(object.source).smooth_angle_deg = angle;
    const Scene scene = scene_of({object});
    return render_gbuffer(model_of(scene, "mesh"), looking_from(scene, {1, 0.8, 1.2}), {}).normal.pixels;
  };
  const Pixels<glm::vec3> sharp = normals(box, 30.0), smooth = normals(box, 180.0);
  box.face_smoothing.assign(6, 1);
  EXPECT_EQ(normals(box, std::nullopt), smooth);
  EXPECT_EQ(normals(box, 30.0), sharp) << "an angle that is asked for goes over the groups";
  box.corner_normals.assign(24, glm::vec3(0.0f, 1.0f, 0.0f));
  for (const glm::vec3& n : normals(box, std::nullopt)) EXPECT_TRUE(n == glm::vec3(0.0f) || n == glm::vec3(0.0f, 1.0f, 0.0f));
  EXPECT_EQ(normals(box, 30.0), sharp) << "and over the file's normals";
}

TEST(Extent, WhatCannotBeHeldIsRefusedAndTheRestDrawnAlike) {
  const auto hits_at = [](double scale, double offset) {
    Mesh mesh = box_mesh({1.0, 0.7, 0.4});
    for (glm::dvec3& p : mesh.positions) p = scale * p + offset;
    const Scene scene = scene_of({object_of(mesh)});
    return count_hits(render_gbuffer(model_of(scene, "mesh"), looking_from(scene, {1, 0.8, 1.2}), {})).hits;
  };
  const std::int64_t usual = hits_at(1.0, 0.0);
  EXPECT_GT(usual, 1000);
  for (const double scale : {1e-11, 1e-6, 1e6, 1e11})
    EXPECT_NEAR(static_cast<double>(hits_at(scale, 0.0)), static_cast<double>(usual), 2.0) << scale;
  for (const double offset : {1e6, 1e10}) EXPECT_NEAR(static_cast<double>(hits_at(1.0, offset)), static_cast<double>(usual), 4.0) << offset;
  for (const double scale : {1e-30, 1e-25, 1e-13, 1e13, 1e30, 1e38, 1e90}) EXPECT_THROW(hits_at(scale, 0.0), InputError) << scale;
  for (const double offset : {1e14, 1e20}) EXPECT_THROW(hits_at(1.0, offset), InputError) << offset;
}

TEST(Extent, VerticesOfNoFaceFrameNothing) {
  Mesh mesh = box_mesh({1.0, 0.7, 0.4});
  const Scene scene = scene_of({object_of(mesh)});
  mesh.positions.emplace_back(1e6, 0.0, 0.0);
  const Scene stray = scene_of({object_of(mesh)});
  EXPECT_EQ(bounds(stray).upper, bounds(scene).upper);
  for (const char* kind : {"mesh", "mesh_level_set"}) {
    SurfaceSettings settings = surface_kind(kind);
    settings.voxels = 48;
    const SceneModel a = build_model(scene, settings), b = build_model(stray, settings);
    EXPECT_EQ(a.bounds.upper, b.bounds.upper) << kind;
    EXPECT_EQ(a.surfaces[0].info.voxel_size, b.surfaces[0].info.voxel_size) << kind;
    const Camera camera = looking_from(scene, {1, 0.8, 1.2});
    EXPECT_EQ(render_gbuffer(a, camera, {}).n_dot_v.pixels, render_gbuffer(b, camera, {}).n_dot_v.pixels) << kind;
  }
}

}  // namespace
}  // namespace limn::test
