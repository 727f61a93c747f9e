// Suggestive contours, ridges and valleys against closed forms of tori and ellipsoids.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "raymarch/lines.h"
#include "sdf/error.h"
#include "sdf/level_set.h"
#include "sdf/shape.h"
#include "tests/random_seed.h"
#include "tests/raymarch/feature_drawings.h"

namespace limn {
namespace {

constexpr double kPi = std::numbers::pi;
const std::vector<LineClass> kFeatures{LineClass::suggestive, LineClass::ridge, LineClass::valley};

/// A torus about the y axis, and what is seen of its curvature, all in closed form.
struct Torus {
  const Camera& camera;

  static glm::dvec3 along_u(double u) { return {-std::sin(u), 0.0, std::cos(u)}; }
  static glm::dvec3 along_v(double u, double v) { return {-std::sin(v) * std::cos(u), std::cos(v), -std::sin(v) * std::sin(u)}; }
  static glm::dvec3 normal(double u, double v) { return {std::cos(v) * std::cos(u), std::sin(v), std::cos(v) * std::sin(u)}; }
  static double ring(double v) { return kMajor + kMinor * std::cos(v); }
  static glm::dvec3 point(double u, double v) { return {ring(v) * std::cos(u), kMinor * std::sin(v), ring(v) * std::sin(u)}; }

  struct View {
    double u = 0.0, v = 0.0, facing = 0.0, sine = 0.0;  ///< The view's tangential parts, and N.V.
  };
  View view_at(double u, double v) const {
    const glm::dvec3 view = view_vector(camera, point(u, v));
    View out{glm::dot(view, along_u(u)), glm::dot(view, along_v(u, v)), glm::dot(view, normal(u, v))};
    out.sine = std::hypot(out.u, out.v);
    return out;
  }
  double radial(double u, double v) const {
    const View w = view_at(u, v);
    return (w.u * w.u * std::cos(v) / ring(v) + w.v * w.v / kMinor) / (w.sine * w.sine);
  }
  /// Along w towards the eye, from the side that is seen, by differences.
  double slope(double u, double v) const {
    const View w = view_at(u, v);
    const double h = 1e-5, du = h * w.u / w.sine / ring(v), dv = h * w.v / w.sine / kMinor;
    return (w.facing < 0.0 ? -1.0 : 1.0) * (radial(u + du, v + dv) - radial(u - du, v - dv)) / (2.0 * h);
  }
};

TEST(FeatureLines, SuggestiveContoursOfATorusAreThoseOfItsClosedForm) {
  std::mt19937 random(random_seed());
  const Scene scene = scene_of(make_shape("torus", {{"major", {kMajor}}, {"minor", {kMinor}}}));
  const LineSettings settings{.classes = {LineClass::contour, LineClass::suggestive}};
  const double radius = bounds(scene).radius();
  int points = 0, places = 0;
  for (int round = 0; round < 12; ++round) {
    const Camera camera = camera_from(random_direction(random), bounds(scene), round % 2 == 0);
    const ViewGraph graph = solve_lines(scene, camera, settings, {});
    EXPECT_TRUE(graph.conflicts.empty()) << round;
    const std::vector<Polyline> lines = edges_of(graph, LineClass::suggestive);
    const Torus torus{camera};
    for (const Polyline& line : lines) {
      for (const LinePoint& point : line) {
        ++points;
        const glm::dvec3& p = point.position;
        const double u = std::atan2(p.z, p.x), v = std::atan2(p.y, std::hypot(p.x, p.z) - kMajor);
        EXPECT_LE(glm::distance(p, Torus::point(u, v)), 1e-9);
        // Ends that the view graph cuts at crossings lie on chords.
        EXPECT_LE(std::fabs(torus.radial(u, v)) * kMinor, 1e-3) << "view " << round;
        // On the contour itself, where a line begins at a cusp, neither side is the one that is seen.
        const bool at_cusp = std::fabs(torus.view_at(u, v).facing) < 1e-6;
        const double slope = at_cusp ? std::fabs(torus.slope(u, v)) : torus.slope(u, v);
        EXPECT_GE(slope * radius * radius, 0.99 * 0.5 * settings.suggestive_slope)
            << "view " << round << ", N.V " << torus.view_at(u, v).facing;
        EXPECT_LE(std::fabs(torus.view_at(u, v).facing), std::cos(settings.suggestive_angle_deg * kPi / 180.0) + 1e-4);
      }
    }
    // Roots of the radial curvature on the lines of a grid over the whole torus.
    constexpr int kGrid = 300;
    double worst = 0.0;
    for (int i = 0; i < kGrid; ++i) {
      for (int j = 0; j < kGrid; ++j) {
        for (const glm::dvec2& step : {glm::dvec2(2.0 * kPi / kGrid, 0.0), glm::dvec2(0.0, 2.0 * kPi / kGrid)}) {
          glm::dvec2 a(2.0 * kPi * i / kGrid, 2.0 * kPi * j / kGrid), b = a + step;
          const bool below = torus.radial(a.x, a.y) < 0.0;
          if (below == (torus.radial(b.x, b.y) < 0.0)) continue;
          for (int k = 0; k < 50; ++k) {
            const glm::dvec2 middle = 0.5 * (a + b);
            ((torus.radial(middle.x, middle.y) < 0.0) == below ? a : b) = middle;
          }
          const bool turned_enough =
              std::fabs(torus.view_at(a.x, a.y).facing) < std::cos((settings.suggestive_angle_deg + 1.0) * kPi / 180.0);
          // The model's radius is that of a mesh of it.
          if (!turned_enough || torus.slope(a.x, a.y) * radius * radius < 1.1 * settings.suggestive_slope) continue;
          ++places;
          worst = std::max(worst, distance_to_any(lines, glm::dvec2(project(camera, Torus::point(a.x, a.y)))));
        }
      }
    }
    EXPECT_LE(worst, 0.01) << "view " << round;
  }
  EXPECT_GT(points, 500);
  EXPECT_GT(places, 500);
}

TEST(FeatureLines, SuggestiveContoursGoOnFromTheCuspsOfContours) {
  Field ring = make_shape("torus", {{"major", {1.0}}, {"minor", {0.38}}});
  ring = rotate(ring, {1.0, 0.0, 0.35}, 22.0 * kPi / 180.0);
  const Scene scene = scene_of(ring);
  const Camera camera = camera_from({0.2, 0.15, 1.0}, bounds(scene), true);
  const ViewGraph graph = solve_lines(scene, camera, {.classes = {LineClass::contour, LineClass::suggestive}}, {});
  int cusps = 0;
  for (const LineVertex& vertex : graph.vertices) {
    if (vertex.kind != VertexKind::cusp) continue;
    ++cusps;
    EXPECT_LE(distance_to_any(edges_of(graph, LineClass::suggestive), vertex.px), 0.05) << vertex.px.x << ", " << vertex.px.y;
  }
  EXPECT_GE(cusps, 2);
}

/// Of the ellipsoid with these half-axes, at a point of it.
struct EllipsoidCurvature {
  double k_max = 0.0, k_min = 0.0;
};
EllipsoidCurvature curvature_of(const glm::dvec3& axes, const glm::dvec3& p) {
  // Gauss' and mean curvature in closed form (do Carmo 1976).
  const glm::dvec3 s = axes * axes, q = p / s;
  const double h = 1.0 / glm::length(q), gauss = h * h * h * h / (s.x * s.y * s.z);
  const double mean = h * h * h * (s.x + s.y + s.z - glm::dot(p, p)) / (2.0 * s.x * s.y * s.z),
               root = std::sqrt(std::max(0.0, mean * mean - gauss));
  return {mean + root, mean - root};
}

TEST(FeatureLines, RidgesOfAnEllipsoidLieInItsPlanesOfSymmetry) {
  std::mt19937 random(random_seed());
  const glm::dvec3 axes(1.1, 0.6, 0.8);
  const Scene scene = scene_of(make_shape("ellipsoid", {{"radii", {axes.x, axes.y, axes.z}}}));
  for (int round = 0; round < 4; ++round) {
    const Camera camera = camera_from(random_direction(random), bounds(scene), round % 2 == 0);
    const ViewGraph graph = solve_lines(scene, camera, {.classes = kFeatures, .ridge_strength = 0.01}, {});
    EXPECT_TRUE(edges_of(graph, LineClass::valley).empty());
    EXPECT_TRUE(edges_of(graph, LineClass::suggestive).empty());
    EXPECT_TRUE(graph.conflicts.empty());
    const std::vector<Polyline> ridges = edges_of(graph, LineClass::ridge);
    ASSERT_FALSE(ridges.empty());
    for (const Polyline& line : ridges) {
      for (const LinePoint& point : line) {
        const glm::dvec3 off = glm::abs(point.position / axes);
        EXPECT_LE(std::min({off.x, off.y, off.z}), 1e-6);
        EXPECT_LE(std::fabs(glm::dot(off, off) - 1.0), 1e-4);
      }
    }
    // Around each plane: where the larger curvature is that across the plane, and falls off on both sides, there is a ridge.
    double worst = 0.0;
    int places = 0, bare = 0;
    for (int plane = 0; plane < 3; ++plane) {
      for (int i = 0; i < 720; ++i) {
        const double angle = 2.0 * kPi * i / 720;
        glm::dvec3 p(0.0);
        p[(plane + 1) % 3] = axes[(plane + 1) % 3] * std::cos(angle);
        p[(plane + 2) % 3] = axes[(plane + 2) % 3] * std::sin(angle);
        const auto beside = [&](double step) {
          glm::dvec3 q = p;
          q[plane] = step;
          return q / glm::length(q / axes);
        };
        const double across = 1.0 / (axes[plane] * axes[plane] * glm::length(p / (axes * axes)));
        const EllipsoidCurvature here = curvature_of(axes, p);
        const double h = 1e-3,
                     bent = (curvature_of(axes, beside(h)).k_max + curvature_of(axes, beside(-h)).k_max - 2.0 * here.k_max) / (h * h);
        const double sharpness = -bent / (here.k_max * here.k_max * here.k_max);
        const double apart = distance_to_any(ridges, glm::dvec2(project(camera, p)));
        const bool is_largest = across > here.k_min * 1.05 && std::fabs(across - here.k_max) < 1e-9;
        if (is_largest && sharpness > 0.1) {
          ++places;
          worst = std::max(worst, apart);
        }
        if (!is_largest || sharpness < 0.0) ++bare;
      }
    }
    EXPECT_GT(places, 300);
    EXPECT_GT(bare, 300);
    EXPECT_LE(worst, 0.01);
  }
}

TEST(FeatureLines, ShapesOfConstantCurvatureHaveNone) {
  std::mt19937 random(random_seed());
  const Field torus = make_shape("torus", {{"major", {kMajor}}, {"minor", {kMinor}}});
  const std::array<std::pair<Field, std::vector<LineClass>>, 4> none{
      {{translate(make_shape("sphere", {{"radius", {0.7}}}), {0.3, -0.2, 5.0}), kFeatures},
       {rotate(make_shape("box"), {1.0, 2.0, 0.5}, 0.7), kFeatures},
       {rotate(make_shape("cylinder"), {1.0, 2.0, 0.5}, 0.7), kFeatures},
       {torus, {LineClass::ridge, LineClass::valley}}}};
  for (size_t i = 0; i < none.size(); ++i) {
    const Scene scene = scene_of(none[i].first);
    for (int round = 0; round < 3; ++round) {
      const Camera camera = camera_from(random_direction(random), bounds(scene), round % 2 == 0);
      LineSettings settings{.classes = none[i].second, .suggestive_slope = 0.01, .ridge_strength = 0.01};
      const ViewGraph graph = solve_lines(scene, camera, settings, {});
      EXPECT_TRUE(graph.edges.empty()) << "shape " << i << ", view " << round << ": " << graph.edges.size();
    }
  }
}

/// The torus as a cage of bicubic splines whose knots lie on it.
Mesh torus_cage(int around, int across) {
  const auto shrinks_by = [](int n) { return (4.0 + 2.0 * std::cos(2.0 * kPi / n)) / 6.0; };
  Mesh cage;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = 2.0 * kPi * i / around, v = 2.0 * kPi * j / across, minor = kMinor / shrinks_by(across);
      const double ring = (kMajor + minor * std::cos(v)) / shrinks_by(around);
      cage.positions.emplace_back(ring * std::cos(u), minor * std::sin(v), ring * std::sin(u));
      const auto at = [&](int k, int l) { return static_cast<std::int32_t>((k % around) * across + l % across); };
      cage.face_sizes.push_back(4);
      cage.corner_vertices.insert(cage.corner_vertices.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return cage;
}

TEST(FeatureLines, LinesOfCagesAndLevelSetsConvergeToTheFields) {
  const Field field = make_shape("torus", {{"major", {kMajor}}, {"minor", {kMinor}}});
  const Scene exact = scene_of(field);
  const Camera camera = camera_from({0.3, -0.9, 0.75}, bounds(exact), true);
  // Ends differ by what the cut-offs are: each is compared with longer ones of the other.
  const LineSettings strict{.classes = {LineClass::suggestive}, .suggestive_angle_deg = 25.0, .suggestive_slope = 3.0};
  const LineSettings loose{.classes = {LineClass::suggestive}, .suggestive_angle_deg = 20.0, .suggestive_slope = 1.0};
  const ViewGraph exact_strict = solve_lines(exact, camera, strict, {}), exact_loose = solve_lines(exact, camera, loose, {});
  ASSERT_FALSE(exact_strict.edges.empty());
  const auto off = [&](const Scene& scene) {
    const ViewGraph found_strict = solve_lines(scene, camera, strict, {}), found_loose = solve_lines(scene, camera, loose, {});
    EXPECT_FALSE(found_strict.edges.empty());
    return std::max(farthest(exact_strict, found_loose), farthest(found_strict, exact_loose));
  };
  std::vector<double> cages, grids;
  for (const int n : {16, 32, 64}) {
    Scene scene;
    scene.objects.push_back({.name = "cage", .source = mesh_source(torus_cage(2 * n, n), Scheme::catmark, "")});
    cages.push_back(off(scene));
  }
  for (const int voxels : {48, 96, 192}) {
    LevelSetSettings building;
    building.voxel_size = 2.8 / voxels;
    building.half_width_voxels = 5.0;
    Scene scene;
    scene.objects.push_back({.name = "grid", .source = LevelSetSource{level_set_from_field(field, building)}});
    grids.push_back(off(scene));
  }
  for (const std::vector<double>* series : {&cages, &grids}) {
    const std::string all = fmt::format("{:.4g} {:.4g} {:.4g} px", (*series)[0], (*series)[1], (*series)[2]);
    std::printf("%s: %s\n", series == &cages ? "cages" : "level sets", all.c_str());
    EXPECT_LE((*series)[1], (*series)[0] / 2.0) << all;
    EXPECT_LE((*series)[2], (*series)[1] / 2.0) << all;
  }
}

TEST(FeatureLines, RidgesOfALevelSetConvergeToThePlanesOfSymmetry) {
  const glm::dvec3 axes(1.1, 0.5, 0.8);
  // Turned, so that the grid does not share the symmetry.
  const glm::dvec3 axis(1.0, 0.4, 0.3);
  const Field field = rotate(make_shape("ellipsoid", {{"radii", {axes.x, axes.y, axes.z}}}), axis, 0.6);
  const glm::dvec3 k = glm::normalize(axis), y(0.0, 1.0, 0.0);
  const glm::dvec3 plane = std::cos(0.6) * y + std::sin(0.6) * glm::cross(k, y) + (1.0 - std::cos(0.6)) * glm::dot(k, y) * k;
  const Camera camera = camera_from({0.5, 0.6, 1.0}, field.traits().bounds, true);
  std::vector<double> worst;
  for (const int voxels : {32, 64, 128}) {
    LevelSetSettings building;
    building.voxel_size = 2.2 / voxels;
    building.half_width_voxels = 5.0;
    Scene scene;
    scene.objects.push_back({.name = "grid", .source = LevelSetSource{level_set_from_field(field, building)}});
    const ViewGraph graph = solve_lines(scene, camera, {.classes = {LineClass::ridge}, .ridge_strength = 5.0}, {});
    const std::vector<Polyline> ridges = edges_of(graph, LineClass::ridge);
    ASSERT_FALSE(ridges.empty()) << voxels;
    worst.push_back(0.0);
    for (const Polyline& line : ridges) {
      for (const LinePoint& point : line) worst.back() = std::max(worst.back(), std::fabs(glm::dot(point.position, plane)));
    }
  }
  std::printf("ridges: %g %g %g\n", worst[0], worst[1], worst[2]);
  EXPECT_LE(worst[1], worst[0] / 1.5);
  EXPECT_LE(worst[2], worst[1] / 1.5);
}

void expect_same_lines(const ViewGraph& one, const ViewGraph& other, double within_px) {
  ASSERT_EQ(one.edges.size(), other.edges.size());
  for (size_t i = 0; i < one.edges.size(); ++i) {
    const LineEdge &a = one.edges[i], &b = other.edges[i];
    EXPECT_EQ(a.line_class, b.line_class);
    EXPECT_EQ(a.invisibility, b.invisibility);
    ASSERT_EQ(a.points.size(), b.points.size());
    for (size_t k = 0; k < a.points.size(); ++k) EXPECT_LE(glm::distance(a.points[k].px, b.points[k].px), within_px);
  }
}

Field blob() {
  const Field ball = make_shape("ellipsoid", {{"radii", {0.9, 0.5, 0.7}}}),
              ring = make_shape("torus", {{"major", {0.8}}, {"minor", {0.25}}});
  return combine(Csg::union_, ball, rotate(ring, {1.0, 0.3, 0.2}, 0.8), 0.2);
}

TEST(FeatureLines, ScaleChangesNothing) {
  const Scene one = scene_of(blob()), large = scene_of(scale(blob(), 1024.0));
  const LineSettings settings{.classes = kFeatures};
  const ViewGraph small_graph = solve_lines(one, camera_from({0.3, 0.5, 1.0}, bounds(one), true), settings, {});
  EXPECT_FALSE(small_graph.edges.empty());
  expect_same_lines(small_graph, solve_lines(large, camera_from({0.3, 0.5, 1.0}, bounds(large), true), settings, {}), 1e-3);
}

TEST(FeatureLines, ThreadsChangeNothing) {
  const Scene scene = scene_of(blob());
  const Camera camera = camera_from({0.3, 0.5, 1.0}, bounds(scene), true);
  const ViewGraph one = solve_lines(scene, camera, {.classes = kFeatures}, {.threads = 1});
  const ViewGraph four = solve_lines(scene, camera, {.classes = kFeatures}, {.threads = 4});
  EXPECT_GT(one.edges.size(), 0u);
  EXPECT_EQ(one.chains.size(), four.chains.size());
  expect_same_lines(one, four, 0.0);
}

TEST(FeatureLines, AskingForThemChangesNoOtherLine) {
  const Scene scene = scene_of(blob());
  const Camera camera = camera_from({0.3, 0.5, 1.0}, bounds(scene), true);
  const ViewGraph without = solve_lines(scene, camera, {}, {});
  std::vector<LineClass> classes = kFeatures;
  for (const LineClassDescriptor& one : line_classes()) {
    if (one.by_default) classes.push_back(one.line_class);
  }
  ViewGraph with = solve_lines(scene, camera, {.classes = classes}, {});
  EXPECT_GT(with.edges.size(), without.edges.size());
  with.edges.erase(std::remove_if(with.edges.begin(), with.edges.end(),
                                  [](const LineEdge& edge) {
                                    return std::find(kFeatures.begin(), kFeatures.end(), edge.line_class) != kFeatures.end();
                                  }),
                   with.edges.end());
  expect_same_lines(without, with, 0.0);
  EXPECT_TRUE(std::none_of(without.edges.begin(), without.edges.end(),
                           [](const LineEdge& edge) { return edge.line_class == LineClass::suggestive; }));
}

TEST(FeatureLines, SettingsOutOfRangeAreRefused) {
  const Scene scene = scene_of(make_shape("sphere"));
  const Camera camera = resolve_camera({}, bounds(scene));
  EXPECT_THROW(solve_lines(scene, camera, {.suggestive_angle_deg = -1.0}, {}), InputError);
  EXPECT_THROW(solve_lines(scene, camera, {.suggestive_angle_deg = 90.0}, {}), InputError);
  EXPECT_THROW(solve_lines(scene, camera, {.suggestive_slope = -0.1}, {}), InputError);
  EXPECT_THROW(solve_lines(scene, camera, {.ridge_strength = 0.0}, {}), InputError);
}

}  // namespace
}  // namespace limn
