// The formulas of rim and fresnel by hand, their pictures as text, and the notes they leave where they fail.

#include <fmt/core.h>

#include <cmath>

#include "raymarch/border/surface_notes.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

/// A G-buffer of one row with these values of N.V; the last pixel is background.
GBuffer row_of(const std::vector<float>& n_dot_v) {
  GBuffer seen;
  seen.width = static_cast<int>(n_dot_v.size()) + 1;
  seen.height = 1;
  seen.depth = {seen.width, 1, 1.0f};
  seen.position = {seen.width, 1, glm::vec3(0.0f)};
  seen.normal = {seen.width, 1, glm::vec3(0, 0, 1)};
  seen.n_dot_v = {seen.width, 1, 0.0f};
  seen.id = {seen.width, 1, 1};
  seen.material = {seen.width, 1, 0};
  seen.face = {seen.width, 1, -1};
  seen.status = {seen.width, 1, 1};
  std::copy(n_dot_v.begin(), n_dot_v.end(), seen.n_dot_v.pixels.begin());
  seen.id.pixels.back() = 0;
  seen.status.pixels.back() = 0;
  return seen;
}

std::vector<float> coverage_of(const std::string& method, const std::vector<float>& n_dot_v,
                               const std::map<std::string, ParameterInput>& given) {
  const GBuffer seen = row_of(n_dot_v);
  const Border border = find_border_method(method).draw({seen, Camera{}, SceneModel{}, Scene{}}, parameters_of(method, given));
  EXPECT_EQ(border.coverage.pixels.back(), 0.0f) << "ink on the background";
  return {border.coverage.pixels.begin(), border.coverage.pixels.end() - 1};
}

std::map<std::string, ParameterInput> numbers(const std::map<std::string, double>& values) {
  std::map<std::string, ParameterInput> given;
  for (const auto& [name, value] : values) given[name] = {{value}, {}, {}};
  return given;
}

TEST(Rim, HardStepAtTheThreshold) {
  EXPECT_EQ(coverage_of("rim", {0.0f, 0.399f, 0.401f, 1.0f}, {}), (std::vector<float>{1, 1, 0, 0}));
  // step(a, x) is 1 where x >= a, so the threshold itself is no border.
  EXPECT_EQ(coverage_of("rim", {0.5f, 0.25f, 0.249f}, numbers({{"threshold", 0.25}})), (std::vector<float>{0, 0, 1}));
}

TEST(Rim, SoftStepOfItsWidthAboutTheThreshold) {
  const std::vector<float> ink = coverage_of("rim", {0.29f, 0.35f, 0.4f, 0.45f, 0.51f}, numbers({{"softness", 0.2}}));
  // At a quarter of the step: 1 - (3 / 16 - 2 / 64) = 0.84375.
  const std::vector<float> expected = {1.0f, 0.84375f, 0.5f, 0.15625f, 0.0f};
  for (size_t i = 0; i < ink.size(); ++i) EXPECT_NEAR(ink[i], expected[i], 1e-6f);
}

TEST(Fresnel, PowerThenSmoothStepTimesStrength) {
  // f = (1 - 0.5)^2 = 0.25, step from 0.2 to 0.4: t = 0.25, 3/16 - 2/64 = 0.15625; times 0.5.
  const auto given = numbers({{"width", 0.8}, {"softness", 0.2}, {"power", 2.0}, {"strength", 0.5}});
  const std::vector<float> ink = coverage_of("fresnel", {0.5f, 0.0f, 1.0f}, given);
  EXPECT_NEAR(ink[0], 0.078125f, 1e-6f);
  EXPECT_NEAR(ink[1], 0.5f, 1e-6f);
  EXPECT_EQ(ink[2], 0.0f);
}

TEST(Fresnel, OfFullWidthIsOutlineEverywhereAndInkEndsAtOne) {
  EXPECT_EQ(coverage_of("fresnel", {0.0f, 0.5f, 1.0f}, numbers({{"width", 1.0}})), (std::vector<float>{1, 1, 1}));
  EXPECT_EQ(coverage_of("fresnel", {0.0f}, numbers({{"strength", 9.0}})), (std::vector<float>{1}));
}

TEST(Fresnel, HardAndOfPowerOneIsRim) {
  std::vector<float> n_dot_v;
  for (int i = 0; i <= 1000; ++i) n_dot_v.push_back(static_cast<float>(i) / 1000.0f + 3e-4f);
  EXPECT_EQ(coverage_of("fresnel", n_dot_v, numbers({{"softness", 0.0}, {"width", 0.3}})),
            coverage_of("rim", n_dot_v, numbers({{"threshold", 0.3}})));
}

TEST(BorderMethods, EveryOneStaysInRangeAndInkIsItsColour) {
  const std::vector<float> n_dot_v = {0.0f, 0.1f, 0.3f, 0.4f, 0.7f, 1.0f};
  for (const BorderMethod& method : border_methods()) {
    const std::map<std::string, ParameterInput> given = {{"color", {{0.1, 0.2, 0.3}, {}, {}}}};
    const GBuffer seen = row_of(n_dot_v);
    const Border border = method.draw({seen, Camera{}, SceneModel{}, Scene{}}, resolve(method.parameters, given));
    EXPECT_EQ(border.color, glm::vec3(0.1f, 0.2f, 0.3f)) << method.about.name;
    for (const float ink : border.coverage.pixels) EXPECT_TRUE(ink >= 0.0f && ink <= 1.0f) << method.about.name;
    EXPECT_FALSE(method.about.source.empty());
    EXPECT_FALSE(method.inputs.empty());
  }
  EXPECT_THROW(find_border_method("rimm"), InputError);
}

/// A picture as text: '#' ink, '.' surface, ' ' nothing.
std::string text_of(const Picture& picture) {
  std::string text;
  for (int y = 0; y < picture.border.height; ++y) {
    for (int x = 0; x < picture.border.width; ++x) {
      text += picture.border.at(x, y) > 0.5f ? '#' : picture.gbuffer.id.at(x, y) ? '.' : ' ';
    }
    text += '\n';
  }
  return text;
}

TEST(Rim, OfASphereIsARing) {
  CameraSettings settings = view(21, 11, Projection::orthographic);
  settings.eye = glm::dvec3(0, 0, 5);
  settings.target = glm::dvec3(0.0);
  settings.ortho_height = 11.0 / 4.6;
  const Scene scene = scene_of({object_of(make_shape("sphere", {{"radius", {1.0}}}))});
  const Picture picture =
      draw_picture(scene, model_of(scene), framing(scene, settings), {{call_of("rim", numbers({{"threshold", 0.6}}))}, 1, {}}, {});
  // Radius 4.6 px, border beyond 3.68 px (sqrt(1 - 0.36) = 0.8).
  EXPECT_EQ(text_of(picture),
            "                     \n"
            "        #####        \n"
            "       #.....#       \n"
            "      #.......#      \n"
            "      #.......#      \n"
            "      #.......#      \n"
            "      #.......#      \n"
            "      #.......#      \n"
            "       #.....#       \n"
            "        #####        \n"
            "                     \n");
}

TEST(Rim, OnACubeReportsWholeFacesThatFlip) {
  const Scene scene = scene_of({object_of(make_shape("box", {{"half", {1.0, 1.0, 1.0}}}))});
  for (const std::string kind : {"analytic", "mesh", "level_set"}) {
    CameraSettings settings = view(120, 120, Projection::orthographic);
    settings.eye = glm::dvec3(3, 4, 9);
    settings.target = glm::dvec3(0.0);
    SurfaceSettings surface = surface_kind(kind);
    surface.voxels = 64;
    surface.level = 2;
    surface.normals = NormalKind::flat;
    const Camera camera = framing(scene, settings);
    const SceneModel model = build_model(scene, surface);
    // N.V of the three faces: 0.29, 0.39, 0.87.
    const Picture picture = draw_picture(scene, model, camera, {{call_of("rim", numbers({{"threshold", 0.35}}))}, 1, {}}, {});
    std::vector<FlatFace> faces = flat_faces(picture.gbuffer, picture.border, 100);
    ASSERT_EQ(faces.size(), 3u) << kind;
    int whole = 0, clear = 0;
    for (const FlatFace& face : faces) {
      whole += face.inked == face.pixels;
      clear += face.inked == 0;
    }
    EXPECT_EQ(whole, 1) << kind;
    EXPECT_EQ(clear, 2) << kind;
    ASSERT_FALSE(picture.notes.empty()) << kind;
    fmt::print("{}: {}\n", kind, picture.notes[0]);
    // In a level set the strips along the edges, whose gradients see two faces, are flat too.
    const std::string expected =
        kind == "level_set" ? "rim undefined (zero curvature) on" : "rim undefined (zero curvature) on 3 flat faces";
    EXPECT_NE(picture.notes[0].find(expected), std::string::npos) << picture.notes[0];
    EXPECT_NE(picture.notes[0].find("1 flipped whole"), std::string::npos) << picture.notes[0];
  }
}

TEST(Rim, OnACurvedSurfaceLeavesNoNote) {
  const Scene scene = scene_of({object_of(make_shape("sphere"))});
  for (const std::string kind : {"analytic", "level_set"}) {
    EXPECT_TRUE(draw_picture(scene, model_of(scene, kind), framing(scene, view(200, 200)), {{call_of("rim")}, 1, {}}, {}).notes.empty())
        << kind;
  }
}

TEST(Rim, OnAnInvertedMeshSaysThatTheWholeObjectIsBorder) {
  Mesh mesh = box_mesh({1.0, 0.8, 0.6});
  for (size_t face = 0; face < 6; ++face) std::swap(mesh.corner_vertices[4 * face + 1], mesh.corner_vertices[4 * face + 3]);
  const Scene scene = scene_of({object_of(mesh)});
  SurfaceSettings surface = surface_kind("mesh");
  surface.normals = NormalKind::flat;
  const Picture picture = draw_picture(scene, build_model(scene, surface), framing(scene, view(60, 60)), {{call_of("rim")}, 1, {}}, {});
  for (size_t i = 0; i < picture.border.size(); ++i) EXPECT_EQ(picture.border.pixels[i], picture.gbuffer.id.pixels[i] ? 1.0f : 0.0f);
  ASSERT_EQ(picture.notes.size(), 2u);
  EXPECT_NE(picture.notes[1].find("inverted"), std::string::npos) << picture.notes[1];
}

}  // namespace
}  // namespace limn::test
