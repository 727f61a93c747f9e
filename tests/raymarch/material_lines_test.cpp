// Materials of parts of one field: lines between them against closed forms and against pictures, and the layers that tell materials.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "raymarch/lines.h"
#include "raymarch/mattes.h"
#include "sdf/field_tree.h"
#include "sdf/segment.h"
#include "tests/random_seed.h"
#include "tests/raymarch/line_views.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 0.8, kAside = 0.6, kBlend = 0.5;
constexpr double kNearContour = 0.2;  // of N.V: on a ball of 100 px radius, 2 px from its contour

Field of(int material, const Field& field) { return with_material(field, material, {}); }

Field ball(double radius, const glm::dvec3& at) { return translate(make_shape("sphere", {{"radius", {radius}}}), at); }

/// Two equal balls, fused along x.
Field pair() { return combine(Csg::union_, of(1, ball(kRadius, {-kAside, 0.0, 0.0})), of(2, ball(kRadius, {kAside, 0.0, 0.0})), kBlend); }

/// Where both balls' values are v = sqrt(kAside^2 + r^2) - kRadius, the blend lies kBlend / 6 below them.
double circle_radius() { return std::sqrt(std::pow(kRadius + kBlend / 6.0, 2) - kAside * kAside); }

Camera random_camera(std::mt19937& random, const Scene& scene, bool perspective) {
  std::normal_distribution<double> normal;
  const glm::dvec3 direction = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
  return line_view(bounds(scene), direction, std::uniform_real_distribution<double>(2.5, 6.0)(random), perspective);
}

LineSettings only(std::vector<LineClass> classes) {
  LineSettings settings;
  settings.classes = std::move(classes);
  return settings;
}

/// Chords of all chains of a class, those in front alone where `visible`.
std::vector<std::array<LinePoint, 2>> chords(const ViewGraph& graph, LineClass line_class, bool visible = false) {
  std::vector<std::array<LinePoint, 2>> result;
  for (const LineChain& chain : graph.chains) {
    if (chain.line_class != line_class || (visible && chain.invisibility > 0)) continue;
    std::vector<LinePoint> points = points_of(graph, chain);
    if (chain.closed) points.push_back(points.front());
    for (size_t i = 0; i + 1 < points.size(); ++i) result.push_back({points[i], points[i + 1]});
  }
  return result;
}

std::string conflicts_of(const ViewGraph& graph) {
  std::string result;
  for (const LineConflict& conflict : graph.conflicts) result += fmt::format("{} at {}, {}\n", conflict.what, conflict.px.x, conflict.px.y);
  return result;
}

double distance_to(const std::vector<std::array<LinePoint, 2>>& lines, const glm::dvec2& px) {
  double least = 1e9;
  for (const auto& [a, b] : lines) least = std::min(least, distance_to_segment(px, a.px, b.px));
  return least;
}

/// The worst distance in the image from points of a curve to the lines, `at` over 0 to 1.
template <class At>
double worst_from(const std::vector<std::array<LinePoint, 2>>& lines, const Camera& camera, const At& at) {
  double worst = 0.0;
  for (int i = 0; i <= 500; ++i) worst = std::max(worst, distance_to(lines, glm::dvec2(project(camera, at(i / 500.0)))));
  return worst;
}

/// The least value of the field on the way from a point, moved off the surface, to the eye: below 0 where it is hidden.
double least_towards_eye(FieldEvaluator& field, const Camera& camera, const glm::dvec3& p) {
  constexpr double kFrom = 4e-3, kStep = 1e-3;
  const glm::dvec3 v = view_vector(camera, p);
  const auto value = [&](double t) { return field.value(p + t * v); };
  double least = 1.0;
  for (int i = 1; i <= 4000; ++i) {
    const double t = kFrom + kStep * i, here = value(t);
    least = std::min(least, here);
    if (here > 2.0 * kStep) continue;
    // It may go through less than a step of it.
    double low = std::max(kFrom, t - kStep), high = t + kStep;
    for (int cut = 0; cut < 40; ++cut) {
      const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
      (value(a) < value(b) ? high : low) = value(a) < value(b) ? b : a;
    }
    least = std::min(least, value(0.5 * (low + high)));
  }
  return least;
}

/// What passes this near to a surface is hidden in one picture and seen in one shifted by a few hundredths of a pixel.
constexpr double kNearlyHidden = 3e-4;

TEST(MaterialLines, OfTwoFusedBallsIsTheCircleBetweenThem) {
  std::mt19937 random(random_seed());
  const Scene scene = scene_of({object_of(pair())});
  FieldEvaluator field(pair());
  const double radius = circle_radius();
  int asked = 0;
  for (int view = 0; view < 40; ++view) {
    const Camera camera = random_camera(random, scene, view % 2 == 0);
    const ViewGraph graph = solve_lines(scene, camera, only({LineClass::material}), {});
    EXPECT_EQ(conflicts_of(graph), "") << view;
    const auto lines = chords(graph, LineClass::material);
    ASSERT_FALSE(lines.empty()) << view;
    EXPECT_LE(
        worst_from(lines, camera, [&](double t) { return radius * glm::dvec3(0.0, std::cos(2.0 * kPi * t), std::sin(2.0 * kPi * t)); }),
        0.01)
        << view;
    for (const auto& [a, b] : lines) {
      const double near = 0.01 / pixels_per_unit_at(camera, a.depth);
      EXPECT_NEAR(a.position.x, 0.0, near) << view;
      EXPECT_NEAR(glm::length(a.position), radius, near) << view;
    }
    for (const LineEdge& edge : graph.edges) {
      const LinePoint& middle = edge.points[edge.points.size() / 2];
      const bool clear = glm::distance(middle.px, edge.points.front().px) > 3.0 && glm::distance(middle.px, edge.points.back().px) > 3.0;
      if (!clear || std::fabs(glm::dot(middle.normal, view_vector(camera, middle.position))) < 0.05) continue;
      const double least = least_towards_eye(field, camera, middle.position);
      if (std::fabs(least) < kNearlyHidden) continue;
      ++asked;
      EXPECT_EQ(edge.invisibility > 0, least < 0.0) << view << ": at " << middle.px.x << ", " << middle.px.y;
    }
  }
  EXPECT_GT(asked, 20);
}

/// A disk of material 1 with a bore of material 2.
Field hub() {
  const Field disk = make_shape("cylinder", {{"radius", {1.0}}, {"half_height", {0.5}}});
  const Field bore = make_shape("cylinder", {{"radius", {0.4}}, {"half_height", {2.0}}});
  return combine(Csg::difference, of(1, disk), of(2, bore));
}

TEST(MaterialLines, OfABoreAreItsRims) {
  std::mt19937 random(random_seed());
  const Scene scene = scene_of({object_of(hub())});
  for (int view = 0; view < 20; ++view) {
    const Camera camera = random_camera(random, scene, view % 2 == 0);
    LineSettings settings = only({LineClass::material});
    // In closed form, and found in cells.
    settings.closed_forms = view % 4 < 2;
    const ViewGraph graph = solve_lines(scene, camera, settings, {});
    EXPECT_EQ(conflicts_of(graph), "") << view;
    const auto lines = chords(graph, LineClass::material);
    for (const double y : {0.5, -0.5}) {
      EXPECT_LE(
          worst_from(lines, camera, [&](double t) { return glm::dvec3(0.4 * std::cos(2.0 * kPi * t), y, 0.4 * std::sin(2.0 * kPi * t)); }),
          0.01)
          << view;
    }
    for (const auto& [a, b] : lines)
      EXPECT_NEAR(std::hypot(a.position.x, a.position.z), 0.4, 0.01 / pixels_per_unit_at(camera, a.depth)) << view;
  }
}

TEST(MaterialLines, AlongASharpEdgeThatIsDrawnAreThatEdge) {
  const Camera camera = line_view({glm::dvec3(-1.0), glm::dvec3(1.0)}, glm::normalize(glm::dvec3(0.5, 0.7, 0.6)), 4.0, true);
  SceneObject plain = object_of(hub());
  const ViewGraph graph = solve_lines(scene_of({plain}), camera, {}, {});
  plain.source = combine(Csg::difference, make_shape("cylinder", {{"radius", {1.0}}, {"half_height", {0.5}}}),
                         make_shape("cylinder", {{"radius", {0.4}}, {"half_height", {2.0}}}));
  const ViewGraph expected = solve_lines(scene_of({plain}), camera, {}, {});
  ASSERT_EQ(graph.edges.size(), expected.edges.size());
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    EXPECT_EQ(graph.edges[i].line_class, expected.edges[i].line_class) << i;
    ASSERT_EQ(graph.edges[i].points.size(), expected.edges[i].points.size()) << i;
    EXPECT_EQ(graph.edges[i].points[1].px, expected.edges[i].points[1].px) << i;
  }
}

/// The fused balls, below a plane of material 2.
Field cut_pair() {
  return combine(Csg::intersection, pair(), of(2, make_shape("plane", {{"normal", {0.0, 1.0, 0.0}}, {"offset", {0.0}}})));
}

TEST(MaterialLines, AlongAnEdgeAreDrawnOnceAndByTheSidesThatItHas) {
  // The plane between the two balls leaves one of them, and the line between both is the edge.
  const auto graph_of = [](int plane_material) {
    const Field halved = combine(Csg::intersection, pair(), of(plane_material, make_shape("plane", {{"normal", {1.0, 0.0, 0.0}}})));
    const Camera camera =
        line_view({glm::dvec3(-1.5, -1.0, -1.0), glm::dvec3(0.5, 1.0, 1.0)}, glm::normalize(glm::dvec3(0.7, 0.3, 0.6)), 4.0, true);
    return std::pair(camera, solve_lines(scene_of({object_of(halved)}), camera, only({LineClass::material}), {}));
  };
  const double radius = circle_radius();
  const auto circle = [&](double t) { return radius * glm::dvec3(0.0, std::cos(2.0 * kPi * t), std::sin(2.0 * kPi * t)); };
  const auto [camera, three] = graph_of(3);
  EXPECT_EQ(conflicts_of(three), "");
  const auto lines = chords(three, LineClass::material);
  ASSERT_FALSE(lines.empty());
  EXPECT_LE(worst_from(lines, camera, circle), 0.01);
  double length = 0.0;
  for (const auto& [a, b] : lines) length += glm::distance(a.position, b.position);
  EXPECT_NEAR(length, 2.0 * kPi * radius, 1e-3);
  // Of ball and plane of one material there is no line, whatever lies beyond.
  EXPECT_TRUE(graph_of(1).second.edges.empty());
}

TEST(MaterialLines, ChangeWhereAnEdgePassesFromPartToPart) {
  std::mt19937 random(random_seed());
  const Scene scene = scene_of({object_of(cut_pair())});
  FieldEvaluator whole(pair());
  // The edge y = 0 of the ball of material 1: seen from its middle.
  const auto edge_at = [&](double t) {
    // From the place where the circle meets the plane, round the far side of the ball.
    const double from = std::atan2(circle_radius(), kAside), angle = from + t * (2.0 * kPi - 2.0 * from);
    double low = 0.3, high = 1.5;
    const auto at = [&](double r) { return glm::dvec3(-kAside + r * std::cos(angle), 0.0, r * std::sin(angle)); };
    for (int i = 0; i < 60; ++i) (whole.value(at(0.5 * (low + high))) < 0.0 ? low : high) = 0.5 * (low + high);
    return at(low);
  };
  const auto arc_at = [&](double t) { return circle_radius() * glm::dvec3(0.0, -std::sin(kPi * t), std::cos(kPi * t)); };
  for (int view = 0; view < 12; ++view) {
    const Camera camera = random_camera(random, scene, view % 2 == 0);
    const ViewGraph graph = solve_lines(scene, camera, only({LineClass::material}), {});
    EXPECT_EQ(conflicts_of(graph), "") << view;
    const auto lines = chords(graph, LineClass::material);
    EXPECT_LE(worst_from(lines, camera, edge_at), 0.01) << view;
    EXPECT_LE(worst_from(lines, camera, arc_at), 0.01) << view;
    for (const auto& [a, b] : lines) {
      const double near = 0.01 / pixels_per_unit_at(camera, a.depth);
      const bool on_edge = std::fabs(a.position.y) < near && a.position.x < near, on_arc = std::fabs(a.position.x) < near;
      EXPECT_TRUE(on_edge || on_arc) << view << ": " << a.position.x << ", " << a.position.y << ", " << a.position.z;
    }
  }
}

Camera camera_at(const glm::dvec3& eye, const Scene& scene, bool perspective) {
  const Box box = bounds(scene);
  const glm::dvec3 off = eye - box.center();
  return line_view(box, glm::normalize(off), glm::length(off) / box.radius(), perspective);
}

TEST(MaterialLines, PassAContourBesideTheEndOfAnother) {
  // 0.013 px from the end of the line a contour of the body ends on the same edge. The line keeps its own turn away from the eye.
  const Scene scene = scene_of({object_of(cut_pair())});
  const Camera camera = camera_at({-4.5643924737142951, -1.7738545582245469, 0.64205675342752044}, scene, true);
  const ViewGraph graph = solve_lines(scene, camera, only({LineClass::material}), {});
  int on_arc = 0;
  for (const auto& [a, b] : chords(graph, LineClass::material)) {
    if (a.position.y > -1e-6) continue;  // The edge of the plane.
    ++on_arc;
    EXPECT_NEAR(a.position.x, 0.0, 1e-6) << a.position.y;
    EXPECT_NEAR(b.position.x, 0.0, 1e-6) << b.position.y;
  }
  EXPECT_GT(on_arc, 100);
}

TEST(FieldLines, AnEdgeHidesTheFartherArmOfACuspThoughTheNearerOneEndsOnIt) {
  // The contour runs up to its cusp behind the edge, and back in front of it to a joint with that edge, all within 0.1 px.
  const Scene scene = scene_of({object_of(cut_pair())});
  const ViewGraph graph =
      solve_lines(scene, camera_at({5.5599904822091766, 2.2262611994262009, -2.1024826827607059}, scene, false), {}, {});
  EXPECT_EQ(conflicts_of(graph), "");
  const auto crosses = [&](const LineVertex& vertex) {
    return vertex.kind == VertexKind::crossing && glm::distance(vertex.px, {248.15, 173.07}) < 0.1 && vertex.crossed_by >= 0 &&
           graph.edges[static_cast<size_t>(vertex.crossed_by)].crease;
  };
  EXPECT_EQ(std::count_if(graph.vertices.begin(), graph.vertices.end(), crosses), 1);
}

TEST(FieldLines, TurnWhereAContourDipsThroughAnEdgeForHalfAPixel) {
  // The edge is a fold but for half a pixel: there the fold is the contour beyond the edge, which begins and ends on it.
  const Scene scene = scene_of({object_of(cut_pair())});
  const Camera camera = camera_at({8.419723276817496, -2.099961961751548, 4.066719319675369}, scene, true);
  const ViewGraph graph = solve_lines(scene, camera, {}, {});
  EXPECT_EQ(conflicts_of(graph), "");
  const auto dip = [](const LineEdge& edge) {
    const double px = glm::distance(edge.points.front().px, edge.points.back().px);
    return edge.line_class == LineClass::crease && px > 0.45 && px < 0.55;
  };
  EXPECT_EQ(std::count_if(graph.edges.begin(), graph.edges.end(), dip), 1);
  for (const LineEdge& edge : graph.edges) {
    for (const int v : {edge.begin, edge.end}) {
      ASSERT_GE(v, 0);
      EXPECT_NE(graph.vertices[static_cast<size_t>(v)].kind, VertexKind::end);
    }
  }
}

TEST(MaterialLines, EndWhereTheyMeetCreasesAndContours) {
  std::mt19937 random(random_seed());
  const Scene scene = scene_of({object_of(cut_pair())});
  int on_creases = 0, on_contours = 0;
  for (int view = 0; view < 12; ++view) {
    const Camera camera = random_camera(random, scene, view % 2 == 0);
    const ViewGraph graph = solve_lines(scene, camera, {}, {});
    EXPECT_EQ(conflicts_of(graph), "") << view;
    const auto creases = chords(graph, LineClass::crease);
    auto edges = creases;
    const auto contours = chords(graph, LineClass::contour);
    edges.insert(edges.end(), contours.begin(), contours.end());
    for (const LineEdge& edge : graph.edges) {
      if (edge.line_class != LineClass::material) continue;
      for (const int v : {edge.begin, edge.end}) {
        ASSERT_GE(v, 0) << view << ": an arc is not closed";
        const LineVertex& vertex = graph.vertices[static_cast<size_t>(v)];
        EXPECT_NE(vertex.kind, VertexKind::end) << view << ": at " << vertex.px.x << ", " << vertex.px.y;
        if (vertex.kind != VertexKind::joint) continue;
        EXPECT_LE(distance_to(edges, vertex.px), 0.01) << view << ": at " << vertex.px.x << ", " << vertex.px.y;
        ++(distance_to(creases, vertex.px) <= 0.01 ? on_creases : on_contours);
      }
    }
  }
  // Each arc has two ends on the edge, a crease or a fold.
  EXPECT_GE(on_creases + on_contours, 24);
  EXPECT_GE(on_creases, 4);
  EXPECT_GE(on_contours, 4);
}

/// Three fused balls with a bore through them, the third of the object's own material.
SceneObject bored_three() {
  const Field balls = combine(Csg::union_, combine(Csg::union_, of(1, ball(0.8, {-0.6, 0.0, 0.0})), of(2, ball(0.8, {0.6, 0.0, 0.0})), 0.4),
                              ball(0.7, {0.0, 0.9, 0.0}), 0.4);
  const Field bore =
      translate(rotate(make_shape("cylinder", {{"radius", {0.3}}, {"half_height", {2.0}}}), {1.0, 0.0, 0.0}, 0.5 * kPi), {0.1, 0.35, 0.0});
  SceneObject object = object_of(combine(Csg::difference, balls, of(4, bore)));
  object.material = 7;
  return object;
}

GBuffer materials_of(const Scene& scene, const Camera& camera, const SurfaceSettings& surface) {
  return render_gbuffer(build_model(scene, surface), camera, {});
}

TEST(MaterialLines, LieWhereThePicturesMaterialsChange) {
  std::mt19937 random(random_seed());
  const Scene scene = scene_of({bored_three()});
  int changes = 0, told = 0;
  for (int view = 0; view < 8; ++view) {
    const Camera camera = random_camera(random, scene, true);
    const ViewGraph graph = solve_lines(scene, camera, only({LineClass::material}), {});
    // The certificate of the body's contours is no matter of its materials.
    for (const LineEdge& edge : graph.edges) {
      EXPECT_TRUE(edge.certain) << view;
      for (const int v : {edge.begin, edge.end}) {
        if (v < 0) continue;
        const LineVertex& vertex = graph.vertices[static_cast<size_t>(v)];
        EXPECT_NE(vertex.kind, VertexKind::end) << view << ": at " << vertex.px.x << ", " << vertex.px.y;
      }
    }
    const auto lines = chords(graph, LineClass::material, true);
    const GBuffer seen = materials_of(scene, camera, surface_kind("analytic"));
    for (int y = 0; y < seen.height; ++y) {
      for (int x = 0; x + 1 < seen.width; ++x) {
        const std::int32_t one = seen.material.at(x, y), other = seen.material.at(x + 1, y);
        const bool steep = std::fabs(seen.depth.at(x, y) - seen.depth.at(x + 1, y)) > 0.02f;
        if (one == other || one == 0 || other == 0 || steep) continue;
        ++changes;
        EXPECT_LE(distance_to(lines, {x + 1.0, y + 0.5}), 0.6) << view << ": at " << x << ", " << y;
      }
    }
    // Half a pixel about the ends of visible pieces is theirs, as the oracle of lines has it.
    const auto at_end = [&](const glm::dvec2& px) {
      return std::any_of(graph.vertices.begin(), graph.vertices.end(), [&](const LineVertex& v) { return glm::distance(v.px, px) < 0.5; });
    };
    int apart = 0;
    for (const auto& [a, b] : lines) {
      if (at_end(0.5 * (a.px + b.px))) continue;
      const glm::ivec2 at(glm::floor(0.5 * (a.px + b.px)));
      if (at.x < 2 || at.y < 2 || at.x + 2 >= seen.width || at.y + 2 >= seen.height) continue;
      // Beside a contour the part beyond the line is a sliver of less than a pixel, which no sample of the picture need meet.
      if (std::fabs(glm::dot(a.normal, view_vector(camera, a.position))) < kNearContour) continue;
      ++told;
      const std::int32_t middle = seen.material.at(at.x, at.y);
      bool differs = false;
      for (int k = 0; k < 25; ++k) differs = differs || seen.material.at(at.x + k % 5 - 2, at.y + k / 5 - 2) != middle;
      apart += differs ? 0 : 1;
    }
    EXPECT_EQ(apart, 0) << view;
  }
  EXPECT_GT(changes, 200);
  EXPECT_GT(told, 200);
}

TEST(MaterialLayers, TellThePartWhateverTheFieldIsModelledAs) {
  const Scene scene = scene_of({bored_three()});
  const Camera camera = line_view(bounds(scene), glm::normalize(glm::dvec3(0.3, 0.4, 1.0)), 3.0, true);
  const GBuffer exact = materials_of(scene, camera, surface_kind("analytic"));
  for (const std::int32_t material : {1, 2, 4, 7})
    EXPECT_GT(std::count(exact.material.pixels.begin(), exact.material.pixels.end(), material), 200) << material;
  FieldEvaluator field(std::get<Field>(scene.objects[0].source));
  for (const char* kind : {"level_set", "mesh"}) {
    SurfaceSettings surface = surface_kind(kind);
    surface.voxels = 128;
    surface.level = 5;
    const GBuffer modelled = materials_of(scene, camera, surface);
    int differ = 0, both = 0;
    for (size_t i = 0; i < exact.material.pixels.size(); ++i) {
      if (exact.id.pixels[i] == 0 || modelled.id.pixels[i] == 0) continue;
      ++both;
      differ += exact.material.pixels[i] != modelled.material.pixels[i];
    }
    EXPECT_GT(both, 20000) << kind;
    EXPECT_LT(differ, both / 100) << kind;
  }
}

TEST(MaterialLayers, PartsHaveTheirColoursAndMattes) {
  SceneObject object = object_of(combine(Csg::union_, with_material(ball(0.8, {-0.6, 0.0, 0.0}), 1, glm::vec3(0.9f, 0.1f, 0.0f)),
                                         with_material(ball(0.8, {0.6, 0.0, 0.0}), 2, {})));
  const Scene scene = scene_of({object});
  const Camera camera = line_view(bounds(scene), {0.0, 0.0, 1.0}, 4.0, true);
  PictureSettings settings;
  settings.shading.shading = Shading::flat;
  settings.mattes = true;
  const Picture picture = draw_picture(scene, model_of(scene), camera, settings, {});
  // 100 px left and right of the middle.
  EXPECT_EQ(glm::vec3(picture.composite.at(220, 240)), glm::vec3(0.9f, 0.1f, 0.0f));
  EXPECT_EQ(glm::vec3(picture.composite.at(420, 240)), object.color);
  ASSERT_NE(picture.mattes, nullptr);
  std::vector<std::string> names;
  for (const MatteName& name : picture.mattes->materials.names) names.push_back(name.name);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"material 1", "material 2"}));
}

TEST(MaterialLayers, EdgesOfMaterialsAreInked) {
  const Scene scene = scene_of({object_of(pair())});
  const Camera camera = line_view(bounds(scene), {0.0, 0.0, 1.0}, 4.0, true);
  const auto ink_at_middle = [&](const Scene& of_scene) {
    PictureSettings settings;
    settings.methods = {call_of("sobel", {{"depth_weight", {{0.0}}}, {"normal_weight", {{0.0}}}})};
    settings.layers = layers_read(settings.methods);
    return draw_picture(of_scene, model_of(of_scene), camera, settings, {}).border.at(320, 240);
  };
  EXPECT_GT(ink_at_middle(scene), 0.5f);
  EXPECT_EQ(ink_at_middle(
                scene_of({object_of(combine(Csg::union_, ball(kRadius, {-kAside, 0.0, 0.0}), ball(kRadius, {kAside, 0.0, 0.0}), kBlend))})),
            0.0f);
}

}  // namespace
}  // namespace limn::test
