// Edge lines against the edges themselves: which are drawn follows from the faces' sides and the kinds asked for, which parts of them are
// seen from solid_edges.h.

#include <fmt/core.h>

#include <numbers>
#include <random>

#include "raymarch/border/edge_visibility.h"
#include "raymarch/border/line_raster.h"
#include "tests/random_seed.h"
#include "tests/raymarch/border_distance.h"
#include "tests/raymarch/image_buffers.h"
#include "tests/raymarch/solid_edges.h"

namespace limn::test {
namespace {

using Given = std::map<std::string, ParameterInput>;

struct Kinds {
  bool contour = true, boundary = true, crease = true, material = true;
  double crease_deg = 40.0;
  Given given() const {
    return {{"contour", value(contour)},   {"boundary", value(boundary)},       {"crease", value(crease)},
            {"material", value(material)}, {"crease_angle", value(crease_deg)}, {"width", value(3.0)}};
  }
};

bool wanted(const Solid& solid, const SolidEdge& edge, const Kinds& kinds, const Camera& camera) {
  if (edge.faces.size() == 1) return kinds.boundary;
  const glm::dvec3 n1 = normal_of(solid.faces[edge.faces[0]]), n2 = normal_of(solid.faces[edge.faces[1]]);
  const glm::dvec3 v = view_vector(camera, edge.a);
  return (kinds.contour && glm::dot(n1, v) * glm::dot(n2, v) < 0.0) ||
         (kinds.crease && std::acos(std::clamp(glm::dot(n1, n2), -1.0, 1.0)) * 180.0 / std::numbers::pi > kinds.crease_deg) ||
         (kinds.material && solid.materials[edge.faces[0]] != solid.materials[edge.faces[1]]);
}

/// What `visible_stretches` says of the edge.
std::vector<EdgeStretch> stretches(const SampledEdge& edge, const BorderInput& input, const Solid& solid, size_t object) {
  const EdgeVisibility view(input);
  ImageEdge image;
  EXPECT_TRUE(view.place(edge.edge.a - input.model.render_origin, edge.edge.b - input.model.render_origin, 4.0, image));
  EXPECT_LT(glm::distance(image.a, glm::dvec2(edge.a)) + glm::distance(image.b, glm::dvec2(edge.b)), 1e-6);
  image.object = static_cast<std::int32_t>(object);
  image.face_a = static_cast<std::int32_t>(edge.edge.faces[0]);
  if (edge.edge.faces.size() == 2) image.face_b = static_cast<std::int32_t>(edge.edge.faces[1]);
  const glm::dvec3 to_eye = view_vector(input.camera, edge.edge.a);
  image.turned_away = edge.edge.faces.size() == 2 && glm::dot(normal_of(solid.faces[edge.edge.faces[0]]), to_eye) <= 0.0 &&
                      glm::dot(normal_of(solid.faces[edge.edge.faces[1]]), to_eye) <= 0.0;
  std::vector<EdgeStretch> result;
  EdgeVisibility::Scratch scratch;
  view.visible_stretches(image, scratch, result);
  return result;
}

double outside(const std::vector<EdgeStretch>& stretches, double s) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const EdgeStretch& stretch : stretches) nearest = std::min(nearest, std::max({0.0, stretch.from - s, s - stretch.to}));
  return nearest;
}

struct Comparison {
  std::int64_t points = 0, missed = 0, points_without_ink = 0, ink_far_from_edges = 0, hidden = 0;
  double leak_px = 0.0;      ///< From a hidden point that is drawn to the nearest that is seen, along the edge.
  double farthest_px = 0.0;  ///< From ink to the nearest point that is seen.
};

/// The farthest that a stretch may reach beyond what is seen, and the longest that may be missed: EdgeVisibility's promise, and the points
/// here.
constexpr double kPoint_px = 1.0 / kPointsPerPixel;
constexpr double kLeak_px = 0.125 + 1.0 / 64.0 + kPoint_px, kMissed_px = 0.25 + 2.0 * kPoint_px;

/// Edge against edge: what is said to be seen against what is.
void compare_edge(const std::vector<Solid>& solids, const Solid& own, const SampledEdge& edge, const std::vector<EdgeStretch>& said,
                  const Camera& camera, std::vector<std::pair<glm::dvec2, glm::dvec2>>& allowed, Comparison& result) {
  const std::vector<EdgeStretch> truly = runs(edge);
  const double length = edge.length_px();
  for (size_t i = 0; i < edge.seen.size(); ++i) {
    if (edge.seen[i]) continue;
    ++result.hidden;
    const double s = edge.place(i);
    if (outside(said, s) > 0.0) continue;
    const double leak = outside(truly, s) * length;
    if (leak > kLeak_px && seen_nearby(solids, &own, edge.edge, edge.world(s), camera)) {
      allowed.push_back({edge.image(s), edge.image(s)});
    } else {
      result.leak_px = std::max(result.leak_px, leak);
    }
  }
  for (const EdgeStretch& run : truly) {
    allowed.push_back({edge.image(run.from), edge.image(run.to)});
    if ((run.to - run.from) * length < kMissed_px) continue;
    for (size_t i = 0; i < edge.seen.size(); ++i) {
      if (edge.place(i) < run.from || edge.place(i) > run.to) continue;
      ++result.points;
      result.missed += outside(said, edge.place(i)) * length > 1.0 / 64.0 + kPoint_px;
    }
  }
}

/// Every seen point of every wanted edge against the ink, and every inked pixel against those points.
Comparison compare(const std::vector<Solid>& solids, const Kinds& kinds, const BorderInput& input, const Image<float>& ink) {
  constexpr double width_px = 3.0;
  Comparison result;
  std::vector<std::pair<glm::dvec2, glm::dvec2>> allowed;
  for (size_t object = 0; object < solids.size(); ++object) {
    const Solid& solid = solids[object];
    for (const SolidEdge& edge : edges_of(solid)) {
      if (!wanted(solid, edge, kinds, input.camera)) continue;
      const SampledEdge sampled = sample_edge(solids, solid, edge, input.camera);
      compare_edge(solids, solid, sampled, stretches(sampled, input, solid, object), input.camera, allowed, result);
      for (const EdgeStretch& run : runs(sampled)) {
        if ((run.to - run.from) * sampled.length_px() < kMissed_px) continue;
        for (double s = run.from; s <= run.to; s += 0.1 / sampled.length_px()) {
          const glm::dvec2 at = sampled.image(s);
          const auto x = static_cast<int>(std::floor(at.x)), y = static_cast<int>(std::floor(at.y));
          result.points_without_ink += ink.inside(x, y) && ink.at(x, y) < 0.99f;
        }
      }
    }
  }
  for (int y = 0; y < ink.height; ++y) {
    for (int x = 0; x < ink.width; ++x) {
      if (ink.at(x, y) <= 0.0f) continue;
      double nearest = 1e30;
      for (const auto& [a, b] : allowed) nearest = std::min(nearest, test::segment_distance({x + 0.5, y + 0.5}, a, b));
      result.farthest_px = std::max(result.farthest_px, nearest);
      // Half the width and half a pixel of fading.
      result.ink_far_from_edges += nearest > 0.5 * width_px + 0.5 + kLeak_px;
    }
  }
  return result;
}

Border drawn_edges(const Scene& scene, const SceneModel& model, const Camera& camera, const Given& given) {
  const GBuffer gbuffer = render_gbuffer(model, camera, {});
  return find_border_method("edge_quads").draw({gbuffer, camera, model, scene}, parameters_of("edge_quads", given));
}

struct View {
  std::mt19937 random;
  explicit View(std::uint32_t seed) : random(seed) {}
  CameraSettings next() {
    std::normal_distribution<double> normal;
    CameraSettings settings = view(180, 140, normal(random) > 0.0 ? Projection::perspective : Projection::orthographic);
    settings.direction = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    if (std::abs(settings.direction->y) > 0.98) settings.up = glm::dvec3(0, 0, 1);
    return settings;
  }
};

testing::AssertionResult exact(const std::string& what, const std::vector<Mesh>& meshes, const std::vector<glm::dvec3>& places,
                               const Kinds& kinds) {
  const std::uint32_t seed = random_seed();
  View views(seed);
  std::vector<SceneObject> objects;
  std::vector<Solid> solids;
  solids.reserve(meshes.size());
  for (size_t i = 0; i < meshes.size(); ++i) {
    objects.push_back(object_of(meshes[i]));
    objects.back().world_from_object.translation = places[i];
    solids.push_back(solid_of(meshes[i], places[i]));
  }
  const Scene scene = scene_of(objects);
  const SceneModel model = model_of(scene, "mesh");
  Comparison sum;
  for (int round = 0; round < 12; ++round) {
    const Camera camera = framing(scene, views.next());
    const GBuffer gbuffer = render_gbuffer(model, camera, {});
    const BorderInput input{gbuffer, camera, model, scene};
    const Border border = find_border_method("edge_quads").draw(input, parameters_of("edge_quads", kinds.given()));
    const Comparison result = compare(solids, kinds, input, border.coverage);
    if (result.missed > 0 || !(result.leak_px <= kLeak_px) || result.points_without_ink > 0 || result.ink_far_from_edges > 0)
      return testing::AssertionFailure() << fmt::format(
                 "{}, seed {}, view {}: {} seen points missed and {} without ink, none may be; a hidden one drawn {} px from one seen, "
                 "{} may be; ink too far from edges at {} pixels, none may be, {} px the farthest",
                 what, seed, round, result.missed, result.points_without_ink, result.leak_px, kLeak_px, result.ink_far_from_edges,
                 result.farthest_px);
    sum.points += result.points;
    sum.hidden += result.hidden;
    sum.leak_px = std::max(sum.leak_px, result.leak_px);
    sum.farthest_px = std::max(sum.farthest_px, result.farthest_px);
  }
  fmt::print(
      "{}: seed {}, {} points of edges seen and all drawn; of {} hidden ones none drawn farther than {:.3f} px from one seen; no ink "
      "farther than {:.2f} px\n",
      what, seed, sum.points, sum.hidden, sum.leak_px, sum.farthest_px);
  return testing::AssertionSuccess();
}

const std::vector<glm::dvec3> kOrigin{glm::dvec3(0.0)};

TEST(EdgeQuads, OfACubeAreExactlyTheSilhouetteAndCreasesSeen) {
  const Mesh cube = box_mesh({1.0, 0.9, 0.8});
  EXPECT_TRUE(exact("all kinds", {cube}, kOrigin, {}));
  EXPECT_TRUE(exact("contour", {cube}, kOrigin, {.boundary = false, .crease = false, .material = false}));
  EXPECT_TRUE(exact("crease", {cube}, kOrigin, {.contour = false, .boundary = false, .material = false}));
  EXPECT_TRUE(exact("crease beyond 100 degrees: none", {cube}, kOrigin,
                    {.contour = false, .boundary = false, .material = false, .crease_deg = 100.0}));
}

TEST(EdgeQuads, OfACubeWithAFaceTakenOffHaveItsBoundary) {
  Mesh open = box_mesh({1.0, 0.9, 0.8});
  open.corner_vertices.erase(open.corner_vertices.begin() + 12, open.corner_vertices.begin() + 16);
  open.face_sizes.pop_back();
  EXPECT_TRUE(exact("open box", {open}, kOrigin, {}));
  EXPECT_TRUE(exact("its boundary", {open}, kOrigin, {.contour = false, .crease = false, .material = false}));
}

TEST(EdgeQuads, OfACubeOfTwoMaterialsHaveTheLineBetweenThem) {
  Mesh cube = box_mesh({1.0, 0.9, 0.8});
  cube.material_names = {"a", "b"};
  cube.face_materials = {0, 1, 0, 1, 0, 0};
  EXPECT_TRUE(exact("material", {cube}, kOrigin, {.contour = false, .boundary = false, .crease = false}));
}

TEST(EdgeQuads, BehindAnotherObjectAreHidden) {
  EXPECT_TRUE(exact("three boxes", {box_mesh({0.7, 0.6, 0.5}), box_mesh({0.4, 0.8, 0.3}), box_mesh({0.3, 0.3, 0.9})},
                    {glm::dvec3(0.0), glm::dvec3(1.6, 0.3, 0.4), glm::dvec3(-0.2, 1.3, -1.1)}, {}));
}

TEST(EdgeQuads, BehindSlatsThinnerThanAPixelAreSeenBetweenThem) {
  std::vector<Mesh> meshes{box_mesh({0.5, 0.8, 0.5})};
  std::vector<glm::dvec3> places{glm::dvec3(0.0)};
  for (int i = 0; i < 7; ++i) {
    meshes.push_back(box_mesh({0.008, 1.0, 0.004}));
    places.push_back({-0.6 + 0.2 * i, 0.1, 0.9});
  }
  EXPECT_TRUE(exact("slats", meshes, places, {}));
}

TEST(EdgeQuads, OfATorusOfFlatFacesAreExactlyItsContour) {
  constexpr int around = 15, across = 9;
  Mesh torus;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = 2.0 * std::numbers::pi * i / around, v = 2.0 * std::numbers::pi * (j + 0.3) / across, r = 1.0 + 0.4 * std::cos(v);
      torus.positions.push_back({r * std::cos(u), 0.4 * std::sin(v), -r * std::sin(u)});
      const int next_i = (i + 1) % around, next_j = (j + 1) % across;
      for (const int vertex : {i * across + j, next_i * across + j, next_i * across + next_j, i * across + next_j})
        torus.corner_vertices.push_back(vertex);
      torus.face_sizes.push_back(4);
    }
  }
  EXPECT_TRUE(exact("torus", {torus}, kOrigin, {.crease = false}));
}

TEST(EdgeQuads, OfABoxSeenStraightOnStillHaveItsOutline) {
  const Scene scene = scene_of({object_of(box_mesh({1.0, 0.8, 0.6}))});
  CameraSettings settings = view(120, 100, Projection::orthographic);
  settings.direction = glm::dvec3(0, 0, 1);
  const Camera camera = framing(scene, settings);
  const Border border = drawn_edges(scene, model_of(scene, "mesh"), camera, Kinds{true, false, false, false, 40.0}.given());
  for (double s = -1.0; s <= 1.0; s += 0.01) {
    for (const glm::dvec3& p :
         {glm::dvec3(s, 0.8, 0.6), glm::dvec3(s, -0.8, 0.6), glm::dvec3(1.0, 0.8 * s, 0.6), glm::dvec3(-1.0, 0.8 * s, 0.6)}) {
      const glm::dvec3 at = project(camera, p);
      ASSERT_GT(border.coverage.at(static_cast<int>(at.x), static_cast<int>(at.y)), 0.99f);
    }
  }
}

TEST(EdgeQuads, DecideCreasesWithoutASquareRootAsTheAngleDoes) {
  const std::uint32_t seed = random_seed();
  fmt::print("seed {}\n", seed);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> size(-8.0, 8.0), degrees(0.0, 180.0);
  int close = 0, above = 0;
  for (int i = 0; i < 200'000; ++i) {
    const glm::dvec3 a = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    glm::dvec3 b = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    if (i % 4 == 0) b = glm::normalize(a + 0.01 * b);
    const double angle = std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)), alpha = degrees(random) * std::numbers::pi / 180.0;
    // Where acos itself is uncertain there is nothing to compare.
    if (std::abs(angle - alpha) < 1e-7) {
      ++close;
      continue;
    }
    const double scale_a = std::pow(10.0, size(random)), scale_b = std::pow(10.0, size(random));
    above += angle > alpha;
    ASSERT_EQ(angle_exceeds(scale_a * a, scale_b * b, std::cos(alpha)), angle > alpha) << angle << " against " << alpha;
  }
  EXPECT_LT(close, 100);
  EXPECT_GT(above, 50'000);
}

/// Ink across a vertical line at the height y.
double ink_of_row(const Image<float>& ink, int y) {
  double sum = 0.0;
  for (int x = 0; x < ink.width; ++x) sum += double{ink.at(x, y)};
  return sum;
}

TEST(EdgeQuads, TaperFromNearToFar) {
  // A strip that leads away from the eye: its two long borders, thick in front.
  Mesh strip;
  strip.positions = {{-0.5, -1.0, 0.0}, {0.5, -1.0, 0.0}, {0.5, -1.0, -12.0}, {-0.5, -1.0, -12.0}};
  strip.corner_vertices = {0, 1, 2, 3};
  strip.face_sizes = {4};
  const Scene scene = scene_of({object_of(strip)});
  CameraSettings settings = view(200, 200);
  settings.eye = glm::dvec3(0.0, 0.4, 4.0);
  settings.target = glm::dvec3(0.0, -0.9, 0.0);
  const Camera camera = framing(scene, settings);
  Given given{{"width", value(8.0)}, {"taper", value(1.0)}, {"far_width", value(2.0)}};
  const Border border = drawn_edges(scene, model_of(scene, "mesh"), camera, given);
  const auto width_at = [&](double z) {
    const glm::dvec3 left = project(camera, {-0.5, -1.0, z}), further = project(camera, {-0.5, -1.0, z - 0.01});
    const glm::dvec2 along = glm::normalize(glm::dvec2(further - left));
    return 0.5 * ink_of_row(border.coverage, static_cast<int>(left.y)) * std::abs(along.y);
  };
  const auto q = [&](double z) { return 1.0 / project(camera, {-0.5, -1.0, z}).z; };
  for (const double z : {-1.0, -3.0, -6.0, -10.0}) {
    const double expected = 8.0 + (q(0.0) - q(z)) / (q(0.0) - q(-12.0)) * (2.0 - 8.0);
    fmt::print("z {}: {:.2f} px wide, {:.2f} expected\n", z, width_at(z), expected);
    EXPECT_NEAR(width_at(z), expected, 0.25);
  }
}

TEST(EdgeQuads, CoverageIsTheBoxFilteredLine) {
  EXPECT_DOUBLE_EQ(line_coverage(0.0, 3.0), 1.0);
  EXPECT_DOUBLE_EQ(line_coverage(1.5, 3.0), 0.5);
  EXPECT_DOUBLE_EQ(line_coverage(2.0, 3.0), 0.0);
  EXPECT_DOUBLE_EQ(line_coverage(0.0, 0.25), 0.25);  // thinner than a pixel: paler
  Image<float> ink(40, 20, 0.0f);
  const std::vector<LinePiece> pieces{{{5.0, 10.25}, {20.0, 10.25}, 2.5, 2.5}, {{20.0, 10.25}, {35.0, 10.25}, 2.5, 2.5}};
  draw_lines(pieces, ink);
  for (int x = 7; x < 33; ++x) {  // over the joint as elsewhere
    double column = 0.0;
    for (int y = 0; y < 20; ++y) column += double{ink.at(x, y)};
    EXPECT_NEAR(column, 2.5, 1e-6) << x;
  }
}

TEST(EdgeQuads, AreTheSameForAnyNumberOfThreadsAndFromWithin) {
  const Scene scene = scene_of({object_of(make_shape("torus")), object_of(box_mesh({0.4, 0.9, 0.4}))});
  const SceneModel model = model_of(scene, "mesh");
  for (const bool within : {false, true}) {
    CameraSettings settings = view(130, 90);
    if (within) {  // in the box, which reaches behind the eye
      settings.eye = glm::dvec3(0.1, 0.2, 0.1);
      settings.target = glm::dvec3(1.0, 0.1, 0.3);
      settings.vertical_fov = 2.2;
    }
    const Camera camera = framing(scene, settings);
    ExecutionSettings one, three;
    one.threads = 1;
    three.threads = 3;
    const PictureSettings pictures{{call_of("edge_quads")}, 2, {}};
    const Picture a = draw_picture(scene, model, camera, pictures, one), b = draw_picture(scene, model, camera, pictures, three);
    EXPECT_EQ(a.border.pixels, b.border.pixels);
    for (const float ink : a.border.pixels) ASSERT_TRUE(ink >= 0.0f && ink <= 1.0f);
    EXPECT_GT(area(a.border), 100.0);
  }
}

TEST(EdgeQuads, AreRefusedWithAReasonWhereThereAreNoPolygons) {
  const Scene scene = scene_of({object_of(make_shape("sphere"))});
  EXPECT_NE(find_border_method("edge_quads").unsupported(model_of(scene, "analytic"), scene).find("polygons"), std::string::npos);
  EXPECT_TRUE(find_border_method("edge_quads").unsupported(model_of(scene, "mesh"), scene).empty());
}

}  // namespace
}  // namespace limn::test
