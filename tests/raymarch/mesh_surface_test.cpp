// Meshes as surfaces: exact on planes, watertight, sides and faces kept, the same wherever they are put.

#include <fmt/core.h>

#include <numbers>
#include <set>

#include "raymarch/surface/object_mesh.h"
#include "sdf/level_set_data.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

SurfaceSettings flat() {
  SurfaceSettings settings = surface_kind("mesh");
  settings.normals = NormalKind::flat;
  return settings;
}

/// A sphere of latitude and longitude, its poles fans of slender triangles: many shared edges and vertices to slip through.
Mesh globe(int rings, int sectors) {
  Mesh mesh;
  mesh.positions.emplace_back(0, 1, 0);
  for (int ring = 1; ring < rings; ++ring) {
    for (int sector = 0; sector < sectors; ++sector) {
      const double theta = std::numbers::pi * ring / rings, phi = 2.0 * std::numbers::pi * sector / sectors;
      mesh.positions.emplace_back(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
    }
  }
  mesh.positions.emplace_back(0, -1, 0);
  const auto at = [&](int ring, int sector) { return 1 + (ring - 1) * sectors + sector % sectors; };
  const auto add = [&](const std::vector<int>& corners) {
    mesh.face_sizes.push_back(static_cast<std::int32_t>(corners.size()));
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), corners.begin(), corners.end());
  };
  for (int sector = 0; sector < sectors; ++sector) {
    add({0, at(1, sector), at(1, sector + 1)});
    for (int ring = 1; ring + 1 < rings; ++ring)
      add({at(ring, sector), at(ring + 1, sector), at(ring + 1, sector + 1), at(ring, sector + 1)});
    add({at(rings - 1, sector), static_cast<int>(mesh.positions.size()) - 1, at(rings - 1, sector + 1)});
  }
  return mesh;
}

TEST(MeshSurface, ABoxOfQuadsIsTheBoxOfTheField) {
  const glm::dvec3 half(1.0, 0.7, 0.4);
  const Scene mesh = scene_of({object_of(box_mesh(half))}), field = scene_of({object_of(make_shape("box", {{"half", {1.0, 0.7, 0.4}}}))});
  const Camera camera = framing(field, view(160, 120));
  const GBuffer a = render_gbuffer(build_model(mesh, flat()), camera, {}), b = render_gbuffer(model_of(field), camera, {});
  int silhouette = 0, edge = 0;
  for (size_t i = 0; i < a.id.size(); ++i) {
    silhouette += a.id.pixels[i] != b.id.pixels[i];
    if (a.id.pixels[i] == 0 || b.id.pixels[i] == 0) continue;
    EXPECT_NEAR(a.depth.pixels[i], b.depth.pixels[i], 2e-6);
    edge += glm::length(a.normal.pixels[i] - b.normal.pixels[i]) > 1e-6f;
    EXPECT_GE(a.face.pixels[i], 0);
    EXPECT_LT(a.face.pixels[i], 6);
  }
  EXPECT_EQ(silhouette, 0);
  EXPECT_EQ(edge, 0);
}

TEST(MeshSurface, IsWatertightAtEveryEdgeAndVertex) {
  const Mesh mesh = globe(24, 48);
  const Scene scene = scene_of({object_of(mesh)});
  const SceneModel model = build_model(scene, flat());
  CameraSettings settings = view(500, 500);
  settings.eye = glm::dvec3(1.3, 2.1, 2.4);
  settings.target = glm::dvec3(0.0);
  const Camera camera = framing(scene, settings);
  // Straight at vertices, at edge midpoints and at points along edges, from outside: the near side must stop the ray.
  const std::vector<std::int32_t> first = first_corners(mesh);
  std::vector<glm::dvec2> points;
  std::vector<glm::dvec3> targets;
  for (size_t face = 0; face < mesh.face_count(); ++face) {
    for (std::int32_t corner = 0; corner < mesh.face_sizes[face]; ++corner) {
      const glm::dvec3 a = mesh.positions[static_cast<size_t>(mesh.corner_vertices[static_cast<size_t>(first[face] + corner)])];
      const glm::dvec3 b = mesh.positions[static_cast<size_t>(
          mesh.corner_vertices[static_cast<size_t>(first[face] + (corner + 1) % mesh.face_sizes[face])])];
      for (const double s : {0.0, 0.123456789, 0.5, 0.9}) {
        const glm::dvec3 target = glm::mix(a, b, s);
        if (glm::dot(target, camera.eye - target) < 0.6) continue;  // the far side and the rim
        targets.push_back(target);
        points.emplace_back(project(camera, target));
      }
    }
  }
  std::vector<PointSample> samples(points.size());
  sample_points(model, camera, points, samples);
  Errors error;
  for (size_t i = 0; i < samples.size(); ++i) {
    ASSERT_EQ(samples[i].status, HitStatus::hit)
        << "a hole at " << targets[i].x << " " << targets[i].y << " " << targets[i].z << " pixel " << points[i].x << " " << points[i].y;
    error.add(glm::length(samples[i].position - targets[i]));
  }
  fmt::print("{} rays at edges and vertices: no hole, worst distance {:.1e}\n", error.count, error.largest);
  EXPECT_GT(error.count, 2000);
  EXPECT_LT(error.largest, 1e-5);
}

TEST(MeshSurface, FromInsideTheNormalStaysOutwardAndNDotVIsNought) {
  const Scene scene = scene_of({object_of(box_mesh(glm::dvec3(2.0)))});
  CameraSettings settings = view(16, 16);
  settings.eye = glm::dvec3(0.1, 0.2, 0.3);
  settings.target = glm::dvec3(0.0, 0.2, -1.0);
  const GBuffer seen = render_gbuffer(build_model(scene, flat()), framing(scene, settings), {});
  EXPECT_EQ(count_hits(seen).hits, 256);
  EXPECT_NEAR(seen.normal.at(8, 8).z, -1.0f, 1e-6f);
  EXPECT_EQ(seen.n_dot_v.at(8, 8), 0.0f);
}

TEST(MeshSurface, AReflectionKeepsTheOutsideOutside) {
  SceneObject object = object_of(globe(12, 24));
  object.world_from_object.linear = glm::dmat3(-1, 0, 0, 0, 0.5, 0, 0, 0, 2);
  const Scene scene = scene_of({object});
  for (const NormalKind kind : {NormalKind::flat, NormalKind::vertex}) {
    SurfaceSettings settings = surface_kind("mesh");
    settings.normals = kind;
    const GBuffer seen = render_gbuffer(build_model(scene, settings), framing(scene, view(60, 60)), {});
    EXPECT_GT(count_hits(seen).hits, 500);
    for (size_t i = 0; i < seen.id.size(); ++i) {
      if (seen.id.pixels[i] == 0) continue;
      const glm::vec3 p = seen.position.pixels[i], outward(p.x, p.y * 4.0f, p.z / 4.0f);
      EXPECT_GT(glm::dot(glm::normalize(outward), seen.normal.pixels[i]), 0.8f);  // facets of 15 degrees, stretched fourfold
    }
  }
}

TEST(MeshSurface, FacesKeepTheirMaterialsOnTopOfTheObjects) {
  Mesh mesh = box_mesh(glm::dvec3(1.0));
  mesh.face_materials = {0, 1, 2, 3, 4, 5};
  mesh.material_names = {"a", "b", "c", "d", "e", "f"};
  SceneObject object = object_of(mesh);
  object.material = 100;
  const Scene scene = scene_of({object});
  const GBuffer seen = render_gbuffer(build_model(scene, flat()), framing(scene, view(40, 40)), {});
  int faces = 0;
  for (size_t i = 0; i < seen.id.size(); ++i) {
    if (seen.id.pixels[i] == 0) continue;
    EXPECT_EQ(seen.material.pixels[i], 100 + seen.face.pixels[i]);
    ++faces;
  }
  EXPECT_GT(faces, 100);
}

TEST(MeshSurface, OnATieTheLowerFaceIsSeenWhateverTheTree) {
  // Two coincident boxes in one mesh: every hit is a tie.
  Mesh mesh = box_mesh(glm::dvec3(1.0));
  Mesh twice = mesh;
  for (const glm::dvec3& position : mesh.positions) twice.positions.push_back(position);
  for (const std::int32_t vertex : mesh.corner_vertices) twice.corner_vertices.push_back(vertex + 8);
  twice.face_sizes.assign(12, 4);
  const Scene scene = scene_of({object_of(twice)});
  const GBuffer seen = render_gbuffer(build_model(scene, flat()), framing(scene, view(64, 64)), {});
  for (size_t i = 0; i < seen.id.size(); ++i) {
    if (seen.id.pixels[i]) {
      EXPECT_LT(seen.face.pixels[i], 6);
    }
  }
}

TEST(MeshSurface, ACageIsRefinedToItsLevelAndAMeshIsTakenAsItIs) {
  const Mesh cage = box_mesh(glm::dvec3(1.0));
  SurfaceSettings settings = surface_kind("mesh");
  settings.level = 2;
  EXPECT_EQ(build_model(scene_of({object_of(cage)}), settings).surfaces[0].info.triangles, 12);
  EXPECT_EQ(build_model(scene_of({object_of(cage, Scheme::catmark)}), settings).surfaces[0].info.triangles, 12 * 16);
  SceneObject own_level = object_of(cage, Scheme::catmark);
  own_level.level = 3;
  EXPECT_EQ(build_model(scene_of({own_level}), settings).surfaces[0].info.triangles, 12 * 64);
  settings.scheme = Scheme::bilinear;
  EXPECT_EQ(build_model(scene_of({object_of(cage)}), settings).surfaces[0].info.triangles, 12 * 16);
}

// Level sets of several sizes are made of one body; what it took counts as their building time all the same.
TEST(MeshSurface, LevelSetsOfAKeptMeshShareItsBody) {
  const Scene scene = scene_of({object_of(box_mesh(glm::dvec3(0.8, 0.6, 0.5)))});
  ObjectMeshCache cache;
  std::set<std::shared_ptr<const MeshBody>> bodies;
  for (const int voxels : {24, 40, 24}) {
    SurfaceSettings settings = surface_kind("mesh_level_set");
    settings.voxels = voxels;
    const SceneModel shared = build_model(scene, settings, &cache), alone = build_model(scene, settings);
    const SharedBody& kept = *cache.kept.front()->mesh.shared_body;
    bodies.insert(kept.body);
    EXPECT_GE(shared.surfaces[0].info.build_ms, bodies.size() == 1 && voxels == 24 ? 0.0 : kept.made_ms);
    const nanovdb::FloatGrid &of_shared = *shared.surfaces[0].level_set->data().grid, &of_alone = *alone.surfaces[0].level_set->data().grid;
    ASSERT_EQ(of_shared.tree().nodeCount(0), of_alone.tree().nodeCount(0));
    for (std::uint32_t leaf = 0; leaf < of_shared.tree().nodeCount(0); ++leaf)
      for (std::uint32_t n = 0; n < 512; ++n)
        ASSERT_EQ(of_shared.tree().getFirstLeaf()[leaf].getValue(n), of_alone.tree().getFirstLeaf()[leaf].getValue(n));
    // Offsets that reach farther than the band are made of it, too.
    OffsetWidth wide;
    wide.world = 0.3;
    const SurfaceOffset &by_body = shared.surfaces[0].offset, &by_mesh = alone.surfaces[0].offset;
    EXPECT_EQ(by_body.make(by_body.state.get(), wide).bounds.upper, by_mesh.make(by_mesh.state.get(), wide).bounds.upper);
  }
  ASSERT_EQ(bodies.size(), 1u) << "made twice";
  EXPECT_NE(*bodies.begin(), nullptr);
}

TEST(MeshSurface, OfAFieldInAnyOrderOfLevelsAndNormalsIsWhatItIsAlone) {
  const Field box = make_shape("box", {{"half", {1.0, 0.7, 0.5}}});
  for (const Field& field : {make_shape("torus"), combine(Csg::intersection, box, make_shape("sphere", {{"radius", {0.9}}}))}) {
    const Scene scene = scene_of({object_of(field)});
    ObjectMeshCache cache;
    for (const int level : {2, 0, 3, 1, 3}) {
      for (const NormalKind normals : {NormalKind::flat, NormalKind::limit}) {
        SurfaceSettings settings = surface_kind("mesh");
        settings.level = level;
        settings.normals = normals;
        const SceneModel shared = build_model(scene, settings, &cache), alone = build_model(scene, settings);
        const Mesh &of_shared = shared.surfaces[0].polygons->mesh(), &of_alone = alone.surfaces[0].polygons->mesh();
        EXPECT_EQ(of_shared.positions, of_alone.positions) << level;
        EXPECT_EQ(of_shared.corner_vertices, of_alone.corner_vertices) << level;
        EXPECT_EQ(of_shared.corner_normals, of_alone.corner_normals) << level;
        EXPECT_EQ(shared.surfaces[0].info.triangles, alone.surfaces[0].info.triangles) << level;
      }
    }
    // Each was made once, and what the last model was spared counts as its building time all the same.
    const FieldCages& refinements = cache.starts.front()->refinements;
    ASSERT_EQ(refinements.size(), 3u);
    double spared_ms = time_to_find_ms(*cache.starts.front()->cage);
    for (const auto& refinement : refinements) spared_ms += time_to_find_ms(*refinement);
    const std::vector<const FieldCage*> before = {refinements[0].get(), refinements[1].get(), refinements[2].get()};
    SurfaceSettings again = surface_kind("mesh");
    again.level = 3;
    again.normals = NormalKind::vertex;
    EXPECT_GE(build_model(scene, again, &cache).surfaces[0].info.build_ms, spared_ms);
    EXPECT_EQ(before, (std::vector<const FieldCage*>{refinements[0].get(), refinements[1].get(), refinements[2].get()})) << "made twice";
  }
}

TEST(MeshSurface, LimitNormalsWithoutALimitSurfaceAreSaidToBeVertexNormals) {
  SurfaceSettings settings = surface_kind("mesh");
  settings.normals = NormalKind::limit;
  const SceneModel model = build_model(scene_of({object_of(box_mesh(glm::dvec3(1.0)))}), settings);
  ASSERT_EQ(total(model).warnings.size(), 1u);
  EXPECT_NE(total(model).warnings[0].find("no limit surface"), std::string::npos);
}

TEST(Model, TotalsAndKindsAddUp) {
  const Scene scene = scene_of({object_of(box_mesh(glm::dvec3(1.0))), object_of(make_shape("sphere"))});
  const SceneModel model = build_model(scene, surface_kind(""));
  EXPECT_EQ(model.surfaces[0].info.kind, "mesh");
  EXPECT_EQ(model.surfaces[1].info.kind, "analytic");
  EXPECT_EQ(total(model).kind, "mixed");
  EXPECT_EQ(total(model).triangles, 12);
  EXPECT_THROW(find_surface("mehs"), InputError);
  for (const SurfaceDescriptor& kind : surface_kinds()) EXPECT_EQ(find_surface(kind.about.name).about.name, kind.about.name);
}

TEST(Model, BoundsAreThoseOfTheMovedMeshNotOfItsMovedBox) {
  SceneObject object = object_of(globe(32, 64));
  const double s = std::sqrt(0.5);
  object.world_from_object.linear = glm::dmat3(s, s, 0, -s, s, 0, 0, 0, 1);
  EXPECT_NEAR(bounds(object).upper.x, 1.0, 0.01);
  EXPECT_FALSE(bounds(scene_of({object_of(make_shape("plane"))})).finite());
}

}  // namespace
}  // namespace limn::test
