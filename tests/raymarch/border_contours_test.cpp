// The strokes of `contours` against areas in closed form and against counting points, and its lines against those of what is traced.

#include <fmt/core.h>

#include <numbers>
#include <random>

#include "raymarch/border/exact_coverage.h"
#include "raymarch/lines.h"
#include "tests/random_seed.h"
#include "tests/raymarch/image_buffers.h"

namespace limn::test {
namespace {

constexpr double kPi = std::numbers::pi;

Image<float> stroke_coverage(const std::vector<std::vector<StrokePoint>>& strokes, bool closed, int width = 64, int height = 48) {
  std::vector<Outline> outlines;
  for (const std::vector<StrokePoint>& stroke : strokes) outlines.push_back(outline_of(stroke, closed, 1e-4));
  return covered_by(outlines, width, height);
}

std::vector<StrokePoint> ring(const glm::dvec2& center, double radius, double width_px, int corners) {
  std::vector<StrokePoint> points;
  for (int i = 0; i < corners; ++i) {
    const double turn = 2.0 * kPi * i / corners;
    points.push_back({center + radius * glm::dvec2(std::cos(turn), std::sin(turn)), width_px});
  }
  return points;
}

/// Inside a disc that rolls along a segment while its width changes.
bool in_piece(const glm::dvec2& p, const StrokePoint& a, const StrokePoint& b) {
  const glm::dvec2 along = b.px - a.px, from = p - a.px;
  const double length = glm::length(along);
  if (glm::length(from) <= 0.5 * a.width_px || glm::length(p - b.px) <= 0.5 * b.width_px) return true;
  const double s = glm::dot(from, along) / (length * length);
  if (s < 0.0 || s > 1.0) return false;
  return std::fabs(from.x * along.y - from.y * along.x) / length <= 0.5 * (a.width_px + s * (b.width_px - a.width_px));
}

/// The share of each pixel's points, `side` x `side` of them, that a stroke covers.
Image<float> counted(const std::vector<std::vector<StrokePoint>>& strokes, bool closed, int width, int height, int side) {
  Image<float> share(width, height, 0.0f);
  for (int y = 0; y < height * side; ++y) {
    for (int x = 0; x < width * side; ++x) {
      const glm::dvec2 p((x + 0.5) / side, (y + 0.5) / side);
      bool inside = false;
      for (const std::vector<StrokePoint>& stroke : strokes) {
        const size_t n = stroke.size();
        for (size_t i = 0; i + (closed ? 0 : 1) < n && !inside; ++i) inside = in_piece(p, stroke[i], stroke[(i + 1) % n]);
      }
      if (inside) share.at(x / side, y / side) += 1.0f / static_cast<float>(side * side);
    }
  }
  return share;
}

double worst_difference(const Image<float>& a, const Image<float>& b) {
  double worst = 0.0;
  for (size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::fabs(double{a.pixels[i]} - double{b.pixels[i]}));
  return worst;
}

TEST(StrokeCoverage, AreasInClosedForm) {
  // A straight stroke: a rectangle and two half discs.
  EXPECT_NEAR(area(stroke_coverage({{{{10.3, 11.7}, 3.0}, {{40.1, 30.2}, 3.0}}}, false)),
              3.0 * glm::length(glm::dvec2(29.8, 18.5)) + kPi * 2.25, 2e-3);
  // Along the pixel grid each pixel is known.
  const Image<float> level = stroke_coverage({{{{5.0, 10.25}, 1.5}, {{20.0, 10.25}, 1.5}}}, false);
  EXPECT_NEAR(level.at(12, 9), 0.5, 1e-5);
  EXPECT_NEAR(level.at(12, 10), 1.0, 1e-5);
  EXPECT_NEAR(level.at(12, 11), 0.0, 1e-5);
  // A closed one: the ring between two polygons of a thousand corners.
  EXPECT_NEAR(area(stroke_coverage({ring({32.0, 24.0}, 15.0, 2.0, 1000)}, true)), 2.0 * kPi * 15.0 * 2.0, 5e-3);
  // A ring whose pen reaches beyond its middle is a disc.
  EXPECT_NEAR(area(stroke_coverage({ring({32.0, 24.0}, 3.0, 8.0, 400)}, true)), kPi * 49.0, 5e-3);
  // A single place is a disc, and none is nothing.
  EXPECT_NEAR(area(stroke_coverage({{{{20.5, 20.5}, 6.0}}}, false)), kPi * 9.0, 2e-3);
  EXPECT_EQ(area(stroke_coverage({{}}, false)), 0.0);
  // Two strokes that cross at a right angle, and one drawn twice, count what they share once.
  const std::vector<StrokePoint> across{{{10.0, 20.0}, 2.0}, {{30.0, 20.0}, 2.0}}, down{{{20.0, 10.0}, 2.0}, {{20.0, 30.0}, 2.0}};
  EXPECT_NEAR(area(stroke_coverage({across, down, across}, false)), 2.0 * (40.0 + kPi) - 4.0, 2e-3);
  // There and back again is the same stroke.
  EXPECT_NEAR(area(stroke_coverage({{across[0], across[1], across[0]}}, false)), 40.0 + kPi, 2e-3);
  // Partly outside: what lies inside.
  EXPECT_NEAR(area(stroke_coverage({{{{-10.0, 20.0}, 2.0}, {{10.0, 20.0}, 2.0}}}, false)), 20.0 + 0.5 * kPi, 2e-3);
}

TEST(StrokeCoverage, RandomStrokesCoverWhatPointsCount) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> any(0.0, 1.0);
  constexpr int kSide = 32;
  double worst = 0.0;
  for (int trial = 0; trial < 24; ++trial) {
    const bool closed = trial % 2 == 1;
    std::vector<std::vector<StrokePoint>> strokes;
    for (int s = 0; s < 1 + trial % 3; ++s) {
      // Sharp turns, knots and changing widths: corners anywhere, or a walk of small steps.
      std::vector<StrokePoint> points;
      glm::dvec2 p(4.0 + 16.0 * any(random), 4.0 + 12.0 * any(random));
      double way = 2.0 * kPi * any(random);
      const double least = 0.3 + any(random), spread = trial % 4 == 0 ? 0.0 : 2.0 * any(random);
      for (int i = 0; i < 24; ++i) {
        points.push_back({p, least + spread});
        way += (trial % 5 == 0 ? 3.0 : 0.7) * (any(random) - 0.5) * 2.0;
        p += (0.3 + any(random)) * glm::dvec2(std::cos(way), std::sin(way));
      }
      strokes.push_back(points);
    }
    const double difference = worst_difference(stroke_coverage(strokes, closed, 28, 24), counted(strokes, closed, 28, 24, kSide));
    worst = std::max(worst, difference);
    EXPECT_LE(difference, 3.0 / kSide) << "stroke " << trial;
  }
  // Points on a grid miss a straight edge by up to half a row of them a side.
  EXPECT_GT(worst, 1e-4);
}

struct Drawn {
  Border border;
  GBuffer seen;
};

Drawn drawn_contours(const Scene& scene, const SceneModel& model, const Camera& camera,
                     const std::map<std::string, ParameterInput>& given = {}) {
  GBuffer seen = render_gbuffer(model, camera, {});
  Border border = find_border_method("contours").draw({seen, camera, model, scene}, parameters_of("contours", given));
  return {std::move(border), std::move(seen)};
}

Scene ball_scene(double radius) { return scene_of({object_of(make_shape("sphere", {{"radius", {radius}}}))}); }

Camera across(double pixels_per_unit) {
  CameraSettings settings = view(96, 80, Projection::orthographic);
  settings.eye = glm::dvec3(0.0, 0.0, 5.0);
  settings.target = glm::dvec3(0.0);
  settings.ortho_height = 80.0 / pixels_per_unit;
  return resolve_camera(settings, Box{glm::dvec3(-1.0), glm::dvec3(1.0)});
}

TEST(ContoursMethod, ABallsStrokeIsTheRingOnEveryModel) {
  const Scene scene = ball_scene(1.0);
  const Camera camera = across(30.0);
  std::vector<StrokePoint> circle = ring({48.0, 40.0}, 30.0, 2.0, 2000);
  const Image<float> exact = stroke_coverage({circle}, true, 96, 80);
  EXPECT_LT(worst_difference(drawn_contours(scene, model_of(scene), camera).border.coverage, exact), 0.012);
  // Off by as much as the models are: a level set of a thirtieth of a pixel, a polygon of 3/100 px.
  EXPECT_LT(worst_difference(drawn_contours(scene, model_of(scene, "level_set"), camera).border.coverage, exact), 0.08);
  SurfaceSettings fine = surface_kind("mesh");
  fine.level = 6;
  EXPECT_LT(worst_difference(drawn_contours(scene, build_model(scene, fine), camera).border.coverage, exact), 0.12);
}

TEST(ContoursMethod, SamplesDoNotBlurIt) {
  const Scene scene = ball_scene(1.0);
  const SceneModel model = model_of(scene);
  PictureSettings settings;
  settings.methods = {call_of("contours")};
  const Picture one = draw_picture(scene, model, across(30.0), settings, {});
  settings.samples = 4;
  const Picture four = draw_picture(scene, model, across(30.0), settings, {});
  EXPECT_GT(area(one.border), 300.0);
  EXPECT_EQ(one.border.pixels, four.border.pixels);
}

TEST(ContoursMethod, WidthsFollowDepthAndCurvature) {
  // Two balls of one size in the picture, the right one twice as far away and twice as large.
  const Scene scene = scene_of({object_of(translate(make_shape("sphere", {{"radius", {0.5}}}), {-0.6, 0.0, 0.0})),
                                object_of(translate(make_shape("sphere", {{"radius", {1.0}}}), {1.2, 0.0, -5.0}))});
  CameraSettings settings = view(120, 80);
  settings.eye = glm::dvec3(0.0, 0.0, 5.0);
  settings.target = glm::dvec3(0.0);
  const Camera camera = resolve_camera(settings, bounds(scene));
  const SceneModel model = model_of(scene);
  const auto halves = [&](const std::string& from) {
    const Border border =
        drawn_contours(scene, model, camera, {{"width_from", word(from)}, {"width", value(4.0)}, {"thin_width", value(1.0)}}).border;
    std::array<double, 2> sums{};
    for (int y = 0; y < 80; ++y) {
      for (int x = 0; x < 120; ++x) sums[x < 60 ? 0 : 1] += double{border.coverage.at(x, y)};
    }
    return sums;
  };
  const auto same = halves("constant"), depth = halves("depth"), curvature = halves("curvature");
  EXPECT_NEAR(same[0] / same[1], 1.0, 0.05);
  // Depths run over the balls' contours only, so that each is nearly one width.
  EXPECT_NEAR(depth[0] / same[0], 1.0, 0.05);
  EXPECT_NEAR(depth[1] / same[1], 0.25, 0.02);
  // The distance to N.V = 0.2 is 0.02 of a ball's radius in the picture, for both: about half a pixel, clamped to the thinnest.
  EXPECT_NEAR(curvature[0] / same[0], 0.25, 0.01);
  EXPECT_NEAR(curvature[1] / same[1], 0.25, 0.01);
  // To first order c^2 / 2 of the radius: with N.V = 0.6 nearly a fifth of it.
  const double focal = camera.focal_px, radius_px = focal * 0.5 / std::sqrt(25.0 - 0.25);
  const double width_px = 0.18 * focal * 0.5 / 5.0;
  const Border wide = drawn_contours(scene, model, camera,
                                     {{"width_from", word("curvature")},
                                      {"width", value(40.0)},
                                      {"thin_width", value(0.0)},
                                      {"threshold", value(0.6)},
                                      {"crease", value(0.0)}})
                          .border;
  EXPECT_NEAR(area(wide.coverage), 2.0 * 2.0 * kPi * radius_px * width_px, 0.08 * area(wide.coverage));
}

/// A square that faces the camera, drawn 2 units to 30 px, with a colour at each vertex: red grows with x, green with y.
Scene painted_square(std::optional<Scheme> scheme) {
  Mesh mesh;
  for (int y = 0; y <= 4; ++y) {
    for (int x = 0; x <= 4; ++x) {
      mesh.positions.emplace_back(0.5 * x - 1.0, 0.5 * y - 1.0, 0.0);
      mesh.vertex_colors.emplace_back(0.25f * static_cast<float>(x), 0.25f * static_cast<float>(y), 0.5f);
    }
  }
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      for (const int v : {5 * y + x, 5 * y + x + 1, 5 * y + x + 6, 5 * y + x + 5}) mesh.corner_vertices.push_back(v);
      mesh.face_sizes.push_back(4);
    }
  }
  return scene_of({object_of(mesh, scheme)});
}

/// Ink across the edges of that square: of the column `u` in [-1, 1] its bottom and top, of the row `u` its left and right.
std::array<double, 4> edge_widths(const Border& border, double u) {
  const auto column = static_cast<int>(48.0 + 30.0 * u), row = static_cast<int>(40.0 - 30.0 * u);
  std::array<double, 4> sums{};
  for (int y = 0; y < 80; ++y) sums[y < 40 ? 1 : 0] += double{border.coverage.at(column, y)};
  for (int x = 0; x < 96; ++x) sums[x < 48 ? 2 : 3] += double{border.coverage.at(x, row)};
  return sums;
}

TEST(ContoursMethod, WidthsFollowTheColoursOfVertices) {
  const Camera camera = across(30.0);
  for (const std::optional<Scheme> scheme : {std::optional<Scheme>{}, std::optional<Scheme>{Scheme::bilinear}}) {
    const Scene scene = painted_square(scheme);
    const SceneModel model = model_of(scene, "mesh");
    const auto drawn = [&](const std::string& from) {
      return drawn_contours(scene, model, camera, {{"width_from", word(from)}, {"width", value(5.0)}, {"thin_width", value(1.0)}}).border;
    };
    const Border red = drawn("red"), green = drawn("green"), blue = drawn("blue"), gray = drawn("luminance");
    for (const double u : {-0.75, -0.4, 0.05, 0.45, 0.7}) {
      // The pixel's centre, up to half a pixel beside u: there 1/15 px.
      const double along = 3.0 + 2.0 * u, luminance = 1.0 + 4.0 * (0.2126 * 0.5 * (1.0 + u) + 0.0722 * 0.5);
      const std::array<double, 4> reds = edge_widths(red, u), greens = edge_widths(green, u), grays = edge_widths(gray, u);
      EXPECT_NEAR(reds[0], along, 0.08) << u;
      EXPECT_NEAR(reds[1], along, 0.08) << u;
      EXPECT_NEAR(reds[2], 1.0, 0.02) << u;
      EXPECT_NEAR(reds[3], 5.0, 0.02) << u;
      EXPECT_NEAR(greens[0], 1.0, 0.02) << u;
      EXPECT_NEAR(greens[1], 5.0, 0.02) << u;
      EXPECT_NEAR(greens[2], along, 0.08) << u;
      EXPECT_NEAR(grays[0], luminance, 0.08) << u;
      for (const double width : edge_widths(blue, u)) EXPECT_NEAR(width, 3.0, 0.02) << u;
    }
    EXPECT_TRUE(red.notes.empty());
  }
}

TEST(ContoursMethod, WidthsByVerticesOutliveTheModelAndAreSaidToBeMissing) {
  // A cube's level set has no vertices of its own: the mesh that it came from has them. Moved and scaled, too.
  Mesh mesh = box_mesh(glm::dvec3(0.5));
  for (const glm::dvec3& p : mesh.positions) mesh.vertex_colors.emplace_back(p.x > 0.0 ? 1.0f : 0.0f, 0.0f, 0.0f);
  Scene scene = scene_of({object_of(mesh)});
  scene.objects[0].world_from_object = {glm::dmat3(2.0), {0.3, 0.0, 0.0}};
  SurfaceSettings grid = surface_kind("mesh_level_set");
  grid.voxels = 48;
  const SceneModel model = build_model(scene, grid);
  const std::map<std::string, ParameterInput> by_red{{"width_from", word("red")}, {"width", value(6.0)}, {"thin_width", value(1.0)}};
  const Border border = drawn_contours(scene, model, across(30.0), by_red).border;
  double left = 0.0, right = 0.0;
  for (int x = 0; x < 96; ++x) (x < 57 ? left : right) += double{border.coverage.at(x, 40)};
  EXPECT_NEAR(left, 1.0, 0.1);
  EXPECT_NEAR(right, 6.0, 0.1);
  // Without colours the lines are as thick as they get, and a note says so.
  const Scene ball = ball_scene(1.0);
  const Border plain = drawn_contours(ball, model_of(ball), across(30.0), by_red).border;
  EXPECT_EQ(plain.coverage.pixels, drawn_contours(ball, model_of(ball), across(30.0), {{"width", value(6.0)}}).border.coverage.pixels);
  ASSERT_EQ(plain.notes.size(), 1u);
  EXPECT_NE(plain.notes[0].find("width_from = red has no effect"), std::string::npos) << plain.notes[0];
}

/// As drawn_contours, with what models of one view share.
Border drawn_beside(const Scene& scene, const SceneModel& model, const Camera& camera, const std::map<std::string, ParameterInput>& given,
                    std::vector<std::shared_ptr<const SharedLines>>& lines) {
  const GBuffer seen = render_gbuffer(model, camera, {});
  SharedFindings shared;
  shared.lines = lines;
  Border border = find_border_method("contours").draw({seen, camera, model, scene, nullptr, &shared}, parameters_of("contours", given));
  lines = std::move(shared.lines);
  return border;
}

SceneModel mesh_at(const Scene& scene, int level) {
  SurfaceSettings settings = surface_kind("mesh");
  settings.level = level;
  return build_model(scene, settings);
}

TEST(ContoursMethod, LinesOfACageAreSolvedOnceForModelsOfAnyLevel) {
  const Camera camera = across(30.0);
  Scene scene = scene_of({object_of(box_mesh(glm::dvec3(0.8)), Scheme::catmark)});
  const SceneModel coarse = mesh_at(scene, 1), fine = mesh_at(scene, 3), grid = model_of(scene, "mesh_level_set");
  std::vector<std::shared_ptr<const SharedLines>> lines;
  const Border of_coarse = drawn_beside(scene, coarse, camera, {}, lines);
  const Border of_fine = drawn_beside(scene, fine, camera, {}, lines);
  EXPECT_EQ(lines.size(), 1u);
  EXPECT_GT(area(of_fine.coverage), 100.0);
  EXPECT_EQ(of_coarse.coverage.pixels, drawn_contours(scene, coarse, camera).border.coverage.pixels);
  EXPECT_EQ(of_fine.coverage.pixels, drawn_contours(scene, fine, camera).border.coverage.pixels);
  // A level set has lines of its own, and so has the cage in another place.
  const Border of_grid = drawn_beside(scene, grid, camera, {}, lines);
  EXPECT_EQ(lines.size(), 2u);
  EXPECT_EQ(of_grid.coverage.pixels, drawn_contours(scene, grid, camera).border.coverage.pixels);
  scene.objects[0].world_from_object.translation = {0.2, 0.1, 0.0};
  const SceneModel moved_model = mesh_at(scene, 1);
  const Border of_moved = drawn_beside(scene, moved_model, camera, {}, lines);
  EXPECT_EQ(lines.size(), 3u);
  EXPECT_EQ(of_moved.coverage.pixels, drawn_contours(scene, moved_model, camera).border.coverage.pixels);
  EXPECT_NE(of_moved.coverage.pixels, of_coarse.coverage.pixels);
}

TEST(ContoursMethod, ModelsOfAPaintedCageHaveWidthsOfTheirOwn) {
  const Camera camera = across(30.0);
  const Scene scene = painted_square(Scheme::bilinear);
  const SceneModel coarse = mesh_at(scene, 1), fine = mesh_at(scene, 3);
  const std::map<std::string, ParameterInput> by_red{{"width_from", word("red")}, {"width", value(5.0)}, {"thin_width", value(1.0)}};
  std::vector<std::shared_ptr<const SharedLines>> lines;
  EXPECT_EQ(drawn_beside(scene, coarse, camera, by_red, lines).coverage.pixels,
            drawn_contours(scene, coarse, camera, by_red).border.coverage.pixels);
  EXPECT_EQ(drawn_beside(scene, fine, camera, by_red, lines).coverage.pixels,
            drawn_contours(scene, fine, camera, by_red).border.coverage.pixels);
  EXPECT_EQ(lines.size(), 2u);
}

TEST(ContoursMethod, ThreadsDoNotMatterAndClassesCanBeLeftOut) {
  const Scene scene = scene_of({object_of(make_shape("box", {{"half", {0.5, 0.4, 0.3}}}))});
  const SceneModel model = model_of(scene);
  const Camera camera = framing(scene, view(96, 80));
  PictureSettings settings;
  settings.methods = {call_of("contours")};
  ExecutionSettings one, many;
  one.threads = 1;
  many.threads = 4;
  const Picture whole = draw_picture(scene, model, camera, settings, one);
  EXPECT_EQ(whole.border.pixels, draw_picture(scene, model, camera, settings, many).border.pixels);
  settings.methods = {call_of("contours", {{"crease", value(0.0)}})};
  const Picture outline = draw_picture(scene, model, camera, settings, one);
  // Three edges of the nine that are seen are creases before the faces.
  EXPECT_LT(area(outline.border), 0.9 * area(whole.border));
  EXPECT_GT(area(outline.border), 0.5 * area(whole.border));
  for (size_t i = 0; i < whole.border.size(); ++i) EXPECT_LE(outline.border.pixels[i], whole.border.pixels[i] + 1e-4f);
}

TEST(ContoursMethod, LinesOfCurvatureAreDrawnAsWideAsInnerLines) {
  const Scene scene = scene_of({object_of(make_shape("torus", {{"major", {1.0}}, {"minor", {0.4}}}))});
  const SceneModel model = model_of(scene);
  CameraSettings looking = view(160, 120);
  looking.direction = glm::dvec3(0.3, -0.9, 0.75);
  const Camera camera = framing(scene, looking);
  double length_px = 0.0;
  for (const LineEdge& edge : solve_lines(scene, camera, {.classes = {LineClass::contour, LineClass::suggestive}}, {}).edges) {
    for (size_t i = 0; i + 1 < edge.points.size() && edge.line_class == LineClass::suggestive && edge.invisibility == 0; ++i)
      length_px += glm::distance(edge.points[i].px, edge.points[i + 1].px);
  }
  ASSERT_GT(length_px, 20.0);
  const auto ink = [&](std::map<std::string, ParameterInput> set) {
    set.insert({"width", value(1.0)});
    return area(drawn_contours(scene, model, camera, set).border.coverage);
  };
  const double outline = ink({}), wide = ink({{"suggestive", value(1.0)}}),
               thin = ink({{"suggestive", value(1.0)}, {"inner_width", value(0.5)}});
  // Where strokes end in others their ink is shared.
  EXPECT_NEAR(wide - outline, length_px, 0.1 * length_px + 2.0);
  EXPECT_NEAR(thin - outline, 0.5 * length_px, 0.1 * length_px + 2.0);
  EXPECT_EQ(ink({{"ridge", value(1.0)}}), outline);  // A torus has none.
}

}  // namespace
}  // namespace limn::test
