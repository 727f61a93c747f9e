// Colours that a file gives to its mesh, in the composite: plates whose colour at each pixel is known.

#include "raymarch/gbuffer/file_colors.h"

#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

/// Two quads in the plane z = 0 that meet along x = 0, red on the left, green on the right.
Mesh two_colored() {
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {0, -1, 0}, {0, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {1, 1, 0}};
  mesh.face_sizes = {4, 4};
  mesh.corner_vertices = {0, 1, 2, 3, 1, 4, 5, 2};
  mesh.face_materials = {0, 1};
  mesh.material_names = {"red", "green"};
  mesh.material_colors = {{0.9f, 0.1f, 0.0f}, {0.0f, 0.6f, 0.2f}};
  return mesh;
}

glm::vec3 linear_color(const glm::dvec3& p) { return {0.5 + 0.25 * p.x, 0.5 - 0.25 * p.y, 0.3}; }

/// The plate from the front, so that N.V is 1: the composite is the colour.
struct Plate {
  Scene scene;
  Camera camera;
  explicit Plate(const Mesh& mesh, const glm::dvec3& at = glm::dvec3(0.0)) : scene(scene_of({object_of(mesh)})) {
    scene.objects[0].world_from_object.translation = at;
    CameraSettings settings = view(64, 48, Projection::orthographic);
    settings.eye = at + glm::dvec3(0.0, 0.0, 5.0);
    settings.target = at;
    settings.ortho_height = 2.4;
    camera = resolve_camera(settings, bounds(scene));
  }
  Picture draw(const std::string& kind = "mesh", int samples = 1) const {
    PictureSettings settings{{}, samples, {}};
    settings.layers = layers_read(settings.methods);
    return draw_picture(scene, model_of(scene, kind), camera, settings, {});
  }
  /// Relative to the plate's middle.
  glm::dvec3 point(int x, int y) const { return {(x + 0.5 - 32.0) / 20.0, (24.0 - y - 0.5) / 20.0, 0.0}; }
};

/// The worst difference between the composite and `expected`, over pixels that the plate fills; they must be many.
template <class Expected>
double worst(const Plate& plate, const Picture& picture, const Expected& expected) {
  double largest = 0.0;
  int pixels = 0;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      const glm::dvec3 p = plate.point(x, y);
      if (std::abs(p.x) > 0.96 || std::abs(p.y) > 0.96) continue;
      largest = std::max<double>(largest, glm::length(glm::vec3(picture.composite.at(x, y)) - expected(p)));
      ++pixels;
    }
  }
  EXPECT_GT(pixels, 1000);
  return largest;
}

TEST(FileColors, MaterialsAreDrawnInTheirColoursUpToTheEdgeBetweenThem) {
  const Plate plate(two_colored());
  const auto expected = [](const glm::dvec3& p) { return p.x < 0.0 ? glm::vec3(0.9f, 0.1f, 0.0f) : glm::vec3(0.0f, 0.6f, 0.2f); };
  EXPECT_LT(worst(plate, plate.draw(), expected), 1e-6);
  // Samples on both sides of the edge are averaged; beside it nothing changes.
  const Picture four = plate.draw("mesh", 4);
  for (const int x : {20, 30, 33, 44})
    EXPECT_LT(glm::length(glm::vec3(four.composite.at(x, 24)) - expected(plate.point(x, 24))), 1e-6f) << x;
}

TEST(FileColors, VertexColoursAreInterpolatedAndMultipliedFarFromTheOriginToo) {
  Mesh mesh = two_colored();
  for (const glm::dvec3& p : mesh.positions) mesh.vertex_colors.push_back(linear_color(p));
  mesh.material_colors = {glm::vec3(1.0f), {0.5f, 1.0f, 0.0f}};
  const auto expected = [&](const glm::dvec3& p) { return linear_color(p) * mesh.material_colors[p.x < 0.0 ? 0 : 1]; };
  for (const double far : {0.0, 1e6}) {
    const Plate plate(mesh, {far, -far, 2.0 * far});
    EXPECT_LT(worst(plate, plate.draw(), expected), 1e-4) << far;
  }
}

TEST(FileColors, RefinedCagesBlendTheColoursOfTheirVertices) {
  Mesh mesh = two_colored();
  mesh.material_colors.clear();
  for (const glm::dvec3& p : mesh.positions) mesh.vertex_colors.push_back(linear_color(p));
  Plate plate(mesh);
  std::get<MeshSource>(plate.scene.objects[0].source).scheme = Scheme::bilinear;
  EXPECT_LT(worst(plate, plate.draw(), linear_color), 1e-4);
}

TEST(FileColors, AnObjectsOwnColorIsDrawnWhereItIsAskedForOrNothingElseIsThere) {
  const glm::vec3 own(0.8f, 0.5f, 0.3f);
  const auto expected = [&](const glm::dvec3&) { return own; };
  Mesh mesh = two_colored();
  mesh.draws_colors = false;
  const Plate hidden(mesh);
  EXPECT_LT(worst(hidden, hidden.draw(), expected), 1e-6);
  EXPECT_FALSE(file_colors(model_of(hidden.scene, "mesh")).any);
  mesh = two_colored();
  mesh.material_colors.clear();
  const Plate plain(mesh);
  EXPECT_LT(worst(plain, plain.draw(), expected), 1e-6);
  // Without colours no layer is read for them.
  EXPECT_FALSE(layers_read(file_colors(model_of(plain.scene, "mesh"))).face);
}

TEST(FileColors, ALevelSetOfAColouredMeshSaysThatItHasNone) {
  Mesh mesh = box_mesh(glm::dvec3(1.0));
  mesh.face_materials = {0, 0, 0, 0, 0, 0};
  mesh.material_names = {"red"};
  mesh.material_colors = {{0.9f, 0.1f, 0.0f}};
  SurfaceSettings settings = surface_kind("mesh_level_set");
  settings.voxels = 24;
  const SceneModel model = build_model(scene_of({object_of(mesh)}), settings);
  EXPECT_FALSE(file_colors(model).any);
  int said = 0;
  for (const std::string& warning : model.surfaces[0].info.warnings) said += warning.find("colours") != std::string::npos;
  EXPECT_EQ(said, 1);
}

}  // namespace
}  // namespace limn::test
