// Refinement kept at what the view needs: no more, and enough, against meshes two levels finer.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "raymarch/surface/object_mesh.h"
#include "raymarch/surface/view_level.h"
#include "subdiv/mesh_level_set.h"
#include "subdiv/tessellate.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

/// A cage with corners of many valences: boxes' corners pushed about.
Mesh bumpy_cage(std::mt19937_64& random) {
  Mesh mesh = box_mesh(glm::dvec3(1.0, 0.8, 0.6));
  for (glm::dvec3& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) p[axis] += 0.3 * (static_cast<double>(random() >> 11) * 0x1p-53 - 0.5);
  }
  return mesh;
}

Mesh tetrahedron() {
  Mesh mesh;
  mesh.positions = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  mesh.corner_vertices = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2};
  mesh.face_sizes.assign(4, 3);
  return mesh;
}

TriangleMesh triangles_at(const SceneObject& object, int level) {
  SurfaceSettings settings = surface_kind("mesh");
  SceneObject fixed = object;
  fixed.level = level;
  return *object_mesh(fixed, settings, glm::dvec3(0.0)).triangles;
}

/// How far the vertices of the mesh two levels finer are from the mesh, in pixels of the picture, those up to `aside_px` beside it counted.
double measured_px(const SceneObject& object, int level, const Camera& camera, double aside_px = 0.0) {
  const TriangleMesh coarse = triangles_at(object, level), fine = triangles_at(object, std::min(level + 2, 8));
  const ClosestPointQuery query(coarse);
  double largest = 0.0;
  for (const glm::dvec3& p : fine.positions) {
    const glm::dvec3 at = project(camera, p);
    if (camera.projection == Projection::perspective && at.z <= 0.0) continue;
    if (at.x < -aside_px || at.y < -aside_px || at.x > camera.width_px + aside_px || at.y > camera.height_px + aside_px) continue;
    largest = std::max(largest, query.closest(p).distance * pixels_per_unit_at(camera, at.z));
  }
  return largest;
}

Camera looking(const SceneObject& object, const glm::dvec3& from, double distance, Projection projection) {
  CameraSettings settings = view(320, 240, projection);
  settings.eye = distance * glm::normalize(from);
  settings.target = glm::dvec3(0.0);
  if (projection == Projection::orthographic) settings.ortho_height = distance;
  return framing(scene_of({object}), settings);
}

/// A cage drawn by `seed`, from somewhere: the level that is chosen, and what meshes two levels finer say of it and of the one before.
struct Chosen {
  double asked_px = 0.0, measured_px = 0.0, coarser_px = 0.0;
  ViewLevel level{};
};
Chosen chosen_for(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) { return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53); };
  const bool loop = random() % 3 == 0;
  SceneObject object = loop ? object_of(tetrahedron(), Scheme::loop) : object_of(bumpy_cage(random), Scheme::catmark);
  object.world_from_object.linear[0][0] = uniform(0.5, 1.5);
  object.world_from_object.linear[1][0] = uniform(-0.3, 0.3);
  const Projection projection = random() % 2 ? Projection::perspective : Projection::orthographic;
  // One draw after the other: compilers order arguments as they like.
  const double distance = std::exp(uniform(1.0, 4.0));
  const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(0.1, 1);
  const Camera camera = looking(object, {x, y, z}, distance, projection);
  Chosen chosen{.asked_px = uniform(0.05, 0.5)};
  chosen.level = level_for_views(object, surface_kind("mesh"), {&camera, 1}, chosen.asked_px);
  chosen.measured_px = measured_px(object, chosen.level.level, camera);
  // What lies just beside the picture counts, as its edges show inside.
  if (chosen.level.level >= 1) chosen.coarser_px = measured_px(object, chosen.level.level - 1, camera, 2.0);
  return chosen;
}

RC_GTEST_PROP(ViewLevel, TwoLevelsFinerNothingIsFartherThanAskedFor, ()) {
  const Chosen chosen = chosen_for(*rc::gen::arbitrary<std::uint64_t>());
  RC_ASSERT(chosen.level.limit.empty());
  RC_ASSERT(chosen.level.deviation_px <= chosen.asked_px);
  RC_ASSERT(chosen.measured_px <= chosen.asked_px);
  // No finer than it has to be: the next coarser mesh is off by more than what was asked for, less what is left beyond the chosen one.
  if (chosen.level.level >= 1) RC_ASSERT(chosen.coarser_px + chosen.level.deviation_px > chosen.asked_px);
}

// Steps of 3.70, 0.93 and 0.32 px: the third is a third of the second, not a quarter as the second was of the first.
TEST(ViewLevel, AGuessThatIsJustWithinWhatIsAskedForIsHeldAgainstTheNextStep) {
  const Chosen chosen = chosen_for(26738159778u);
  EXPECT_EQ(chosen.level.level, 3);
  EXPECT_LE(chosen.measured_px, chosen.asked_px);
}

TEST(ViewLevel, FallsWithTheDistanceAndCountsTheNearestOfSeveralViews) {
  std::mt19937_64 random(3);
  const SceneObject object = object_of(bumpy_cage(random), Scheme::catmark);
  const SurfaceSettings settings = surface_kind("mesh");
  std::vector<Camera> cameras;
  int before = 9, nearest = 0;
  for (const double distance : {3.0, 12.0, 48.0, 200.0, 20000.0}) {
    cameras.push_back(looking(object, {1, 2, 3}, distance, Projection::perspective));
    const int level = level_for_views(object, settings, {&cameras.back(), 1}).level;
    EXPECT_LE(level, before) << distance;
    nearest = std::max(nearest, level);
    before = level;
  }
  EXPECT_EQ(before, 0);
  EXPECT_GE(nearest, 3);
  EXPECT_EQ(level_for_views(object, settings, cameras).level, nearest);
}

TEST(ViewLevel, OfAFieldIsWithinThePixelsAskedForByItsClosedForm) {
  const SceneObject object = object_of(make_shape("sphere", {{"radius", {1.0}}}));
  int before = 9;
  for (const double distance : {4.0, 16.0, 64.0}) {
    const Camera camera = looking(object, {1, 2, 3}, distance, Projection::perspective);
    const ViewLevel chosen = level_for_views(object, surface_kind("mesh"), {&camera, 1});
    EXPECT_LE(chosen.deviation_px, kViewDeviation_px);
    EXPECT_LE(chosen.level, before);
    before = chosen.level;
    const TriangleMesh mesh = triangles_at(object, chosen.level);
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3 middle = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0;
      const double off_px = (1.0 - glm::length(middle)) * pixels_per_unit_at(camera, project(camera, middle).z);
      ASSERT_LT(std::abs(off_px), 1.1 * kViewDeviation_px) << distance;
    }
  }
}

TEST(ViewLevel, KeepsToTheMemoryAndSaysSo) {
  std::mt19937_64 random(4);
  const SceneObject object = object_of(bumpy_cage(random), Scheme::catmark);
  SurfaceSettings settings = surface_kind("mesh");
  settings.max_bytes = 200'000;
  const Camera camera = looking(object, {1, 2, 3}, 3.0, Projection::perspective);
  const ViewLevel chosen = level_for_views(object, settings, {&camera, 1}, 1e-4);
  EXPECT_FALSE(chosen.limit.empty());
  EXPECT_GT(chosen.deviation_px, 1e-4);
  EXPECT_LE(predict_refined_size(std::get<MeshSource>(object.source).mesh, Scheme::catmark, chosen.level).bytes, 200'000);
  EXPECT_GT(predict_refined_size(std::get<MeshSource>(object.source).mesh, Scheme::catmark, chosen.level + 1).bytes, 200'000);
}

TEST(ViewLevel, OfAFieldKeepsToTheMemoryAndSaysSo) {
  const SceneObject object = object_of(make_shape("sphere"));
  SurfaceSettings settings = surface_kind("mesh");
  const Mesh cage = cage_of(std::get<Field>(object.source));
  settings.max_bytes = predict_refined_size(cage, Scheme::bilinear, 1).bytes;
  const Camera camera = looking(object, {1, 2, 3}, 3.0, Projection::perspective);
  const ViewLevel chosen = level_for_views(object, settings, {&camera, 1}, 1e-4);
  EXPECT_EQ(chosen.level, 1);
  EXPECT_EQ(chosen.limit, "a finer one would not fit into memory");
  EXPECT_GT(chosen.deviation_px, 1e-4);
}

// Each place asked of the whole field by itself.
TEST(ViewLevel, OfAFieldIsTheLargestDeviationThatItSays) {
  SceneObject object = object_of(make_shape("gyroid"));
  const glm::dvec3 render_origin(0.3, -0.2, 0.1);
  const Camera camera = looking(object, {3, 2, 1}, 12.0, Projection::perspective);
  const ViewLevel chosen = level_for_views(object, surface_kind("mesh"), {&camera, 1}, 4.0, render_origin);
  const Field& field = std::get<Field>(object.source);
  const Mesh mesh = tessellate(translate(field, -render_origin), {.level = chosen.level, .normals = NormalKind::flat});
  FieldEvaluator evaluator(field);
  double largest = 0.0;
  size_t first = 0;
  for (const std::int32_t size : mesh.face_sizes) {
    const auto at = [&](size_t k) {
      return mesh.positions[static_cast<size_t>(mesh.corner_vertices[first + k % static_cast<size_t>(size)])] + render_origin;
    };
    glm::dvec3 middle(0.0);
    std::vector<glm::dvec3> points;
    for (size_t k = 0; k < static_cast<size_t>(size); ++k) {
      middle += at(k) / static_cast<double>(size);
      points.push_back(0.5 * (at(k) + at(k + 1)));
    }
    points.push_back(middle);
    for (const glm::dvec3& point : points) {
      const glm::dvec3 px = project(camera, point);
      const bool seen = px.z > 0.0 && px.x > 0.0 && px.y > 0.0 && px.x < camera.width_px && px.y < camera.height_px;
      const FieldJet jet = evaluator.jet(point);
      if (seen) largest = std::max(largest, std::abs(jet.value) / glm::length(jet.gradient) * pixels_per_unit_at(camera, px.z));
    }
    first += static_cast<size_t>(size);
  }
  EXPECT_GT(largest, 0.0);
  EXPECT_NEAR(chosen.deviation_px, largest, 1e-9 * largest);
}

// What was found on the way to a level is where the model starts.
TEST(ViewLevel, OfAFieldLeavesItsMeshToTheModel) {
  Scene scene = scene_of({object_of(make_shape("superellipsoid"))});
  std::get<Field>(scene.objects[0].source) = translate(std::get<Field>(scene.objects[0].source), glm::dvec3(5.0, 0.0, -2.0));
  const Camera camera = framing(scene, view(200, 200));
  Scene alone = scene;
  ObjectMeshCache cache;
  refine_for_views(surface_kind("mesh"), {&camera, 1}, scene, &cache);
  refine_for_views(surface_kind("mesh"), {&camera, 1}, alone);
  ASSERT_EQ(scene.objects[0].level, alone.objects[0].level);
  ASSERT_EQ(cache.starts.size(), 1u);
  const std::shared_ptr<const FieldCage> found = cache.starts[0]->cage;
  ASSERT_TRUE(found);
  ASSERT_TRUE(cache.kept[0]);
  const std::shared_ptr<const Polygons> polygons = cache.kept[0]->mesh.polygons;
  const SceneModel model = build_model(scene, surface_kind("mesh"), &cache), anew = build_model(scene, surface_kind("mesh"));
  EXPECT_EQ(cache.starts[0]->cage, found);
  EXPECT_EQ(model.surfaces[0].polygons, polygons);
  EXPECT_EQ(model.surfaces[0].polygons->mesh().positions, anew.surfaces[0].polygons->mesh().positions);
  EXPECT_EQ(model.surfaces[0].polygons->mesh().corner_vertices, anew.surfaces[0].polygons->mesh().corner_vertices);
}

TEST(ViewLevel, IsSetWhereAMeshIsMadeAndNowhereElse) {
  std::mt19937_64 random(5);
  Scene scene = scene_of({object_of(bumpy_cage(random), Scheme::catmark), object_of(bumpy_cage(random)), object_of(make_shape("sphere"))});
  const Camera camera = framing(scene, view(200, 200));
  EXPECT_EQ(refine_for_views(surface_kind(""), {&camera, 1}, scene).size(), 1u);
  EXPECT_TRUE(scene.objects[0].level.has_value());
  EXPECT_FALSE(scene.objects[1].level || scene.objects[2].level);
  EXPECT_EQ(refine_for_views(surface_kind("mesh"), {&camera, 1}, scene).size(), 2u);
  EXPECT_TRUE(scene.objects[2].level.has_value());
}

}  // namespace
}  // namespace limn::test
