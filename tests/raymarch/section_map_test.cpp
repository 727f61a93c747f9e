// Section maps: what vertex colours, face groups and world cells give at each pixel, on a plate whose answer is known.

#include "raymarch/border/section_map.h"

#include "tests/raymarch/image_buffers.h"

namespace limn {
namespace {

// Two quads and a pentagon in the plane z = 0, meeting along x = 0; colour is linear in x and y at the vertices.
Mesh plate() {
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {0, -1, 0}, {0, 1, 0}, {-1, 1, 0}, {0.7, -1, 0}, {1, 0, 0}, {0.6, 1, 0}};
  mesh.face_sizes = {4, 5};
  mesh.corner_vertices = {0, 1, 2, 3, 1, 4, 5, 6, 2};
  mesh.face_groups = {0, 1};
  mesh.group_names = {"left", "right"};
  for (const glm::dvec3& p : mesh.positions) mesh.vertex_colors.push_back(glm::vec3(0.5 + 0.25 * p.x, 0.5 - 0.25 * p.y, 0.3));
  return mesh;
}

struct Seen {
  Scene scene = test::scene_of({test::object_of(plate())});
  SceneModel model = test::model_of(scene, "mesh");
  Camera camera;
  GBuffer gbuffer;
  Seen() {
    CameraSettings settings = test::view(64, 48, Projection::orthographic);
    settings.eye = glm::dvec3(0.0, 0.0, 5.0);
    settings.target = glm::dvec3(0.0);
    settings.ortho_height = 2.4;
    camera = resolve_camera(settings, model.bounds);
    gbuffer = render_gbuffer(model, camera, {});
  }
  BorderInput input() const { return {gbuffer, camera, model, scene}; }
};

TEST(SectionMap, VertexColoursAreInterpolatedExactlyWhereTheyAreLinear) {
  const Seen seen;
  const SectionMap map = section_map(seen.input(), SectionSource::vertex_colors, 1.0);
  ASSERT_EQ(map.missing, "");
  int hits = 0;
  for (size_t i = 0; i < map.sections.size(); ++i) {
    if (seen.gbuffer.id.pixels[i] == 0) continue;
    const glm::vec3 p = seen.gbuffer.position.pixels[i];
    const glm::vec3 expected(0.5f + 0.25f * p.x, 0.5f - 0.25f * p.y, 0.3f);
    EXPECT_LT(glm::length(map.sections.pixels[i] - expected), 1e-5f) << "pixel " << i;
    ++hits;
  }
  EXPECT_GT(hits, 1000);
}

// The only line that face groups draw on the plate is where they meet; everything else is flat, of one object and one colour.
TEST(SectionMap, FaceGroupsDrawTheLineWhereTheyMeetAndNoOther) {
  const Seen seen;
  for (const std::string method : {"roberts", "sobel"}) {
    const MethodCall call = test::call_of(method, {{"depth_weight", test::value(0)},
                                                   {"normal_weight", test::value(0)},
                                                   {"id_weight", test::value(0)},
                                                   {"custom_weight", test::value(1)},
                                                   {"custom_threshold", test::value(0.1)},
                                                   {"custom_from", test::word("groups")}});
    const Border border = call.method->draw(seen.input(), call.parameters);
    EXPECT_TRUE(border.notes.empty());
    int inside = 0;
    for (int y = 0; y < border.coverage.height; ++y) {
      for (int x = 0; x < border.coverage.width; ++x) {
        const glm::vec3 p = seen.gbuffer.position.at(x, y);
        if (!(std::abs(p.x) < 0.5f && std::abs(p.y) < 0.9f)) continue;  // the plate's outline is an edge of the map too
        const bool meets = std::abs(x + 0.5 - 32.0) <= 1.0;
        EXPECT_TRUE(meets || border.coverage.at(x, y) == 0.0f) << method << " at " << x << ", " << y;
        inside += border.coverage.at(x, y) > 0.0f;
      }
    }
    EXPECT_GE(inside, 30) << method;
  }
}

TEST(SectionMap, WorldCellsDifferFromTheirNeighboursByOneInOneComponent) {
  const Seen seen;
  const SectionMap map = section_map(seen.input(), SectionSource::position, 0.4);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      if (seen.gbuffer.id.at(x, y) == 0) continue;
      const glm::vec3 p = seen.gbuffer.position.at(x, y);
      EXPECT_EQ(map.sections.at(x, y).x, static_cast<float>(std::abs(static_cast<int>(std::floor(p.x / 0.4)) % 2)));
      EXPECT_EQ(map.sections.at(x, y).y, static_cast<float>(std::abs(static_cast<int>(std::floor(p.y / 0.4)) % 2)));
    }
  }
}

TEST(SectionMap, WhatNoObjectHasIsSaid) {
  const Scene scene = test::scene_of({test::object_of(make_shape("sphere"))});
  const SceneModel model = test::model_of(scene);
  const Camera camera = test::framing(scene, test::view(16, 16));
  const GBuffer gbuffer = render_gbuffer(model, camera, {});
  for (const SectionSource source : {SectionSource::groups, SectionSource::vertex_colors}) {
    EXPECT_NE(section_map({gbuffer, camera, model, scene}, source, 1.0).missing, "");
  }
}

}  // namespace
}  // namespace limn
