// Lines in closed form: against the search in cells of space on random bodies, and against known answers.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "raymarch/lines.h"
#include "raymarch/lines/field_layers.h"
#include "raymarch/lines/form_layers.h"
#include "raymarch/lines/form_tracing.h"
#include "raymarch/lines/trig_polynomial.h"
#include "sdf/segment.h"
#include "sdf/shape.h"
#include "tests/random_seed.h"
#include "tests/raymarch/line_views.h"

namespace limn {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kBodies = 24;
constexpr int kMostConflicts = 1;  // of a test's views: there were 2 in 3,000 random ones

double uniform(std::mt19937& random, double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }

glm::dvec3 direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

/// Turned and moved at random, its middle not far from the origin.
Field placed(const Field& field, std::mt19937& random) {
  return translate(rotate(field, direction(random), uniform(random, 0.0, 2.0 * kPi)), uniform(random, 0.1, 0.5) * direction(random));
}

enum Solid { cylinder, oval_cylinder, cone, box, sphere, ellipsoid, torus };

Field solid(Solid kind, std::mt19937& random) {
  switch (kind) {
    case cylinder:
      return make_shape("cylinder", {{"radius", {uniform(random, 0.2, 0.5)}}, {"half_height", {uniform(random, 0.4, 1.0)}}});
    case oval_cylinder:
      return scale(make_shape("cylinder", {{"radius", {0.4}}, {"half_height", {0.7}}}), {uniform(random, 0.6, 1.2), 1.0, 0.8});
    case cone:
      return make_shape("cone", {{"angle_deg", {uniform(random, 15.0, 45.0)}}, {"height", {uniform(random, 0.8, 1.4)}}});
    case box:
      return make_shape("box", {{"half", {uniform(random, 0.2, 0.6), uniform(random, 0.2, 0.6), uniform(random, 0.2, 0.6)}}});
    case sphere:
      return make_shape("sphere", {{"radius", {uniform(random, 0.3, 0.8)}}});
    case ellipsoid:
      return make_shape("ellipsoid", {{"radii", {uniform(random, 0.4, 0.9), uniform(random, 0.3, 0.7), uniform(random, 0.3, 0.7)}}});
    case torus:
      break;
  }
  return make_shape("torus", {{"major", {uniform(random, 0.5, 0.7)}}, {"minor", {uniform(random, 0.12, 0.3)}}});
}

/// Two to four solids, joined, cut and drilled in a random order. With an ellipsoid there are no spheres: those two meet in no curve with a
/// closed form.
Field random_body(std::mt19937& random) {
  const auto below = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  const bool oval = below(4) == 0;
  Field body = placed(solid(oval ? ellipsoid : static_cast<Solid>(below(5)), random), random);
  for (int i = 1 + below(3); i-- >= 0;) {
    const Csg operation = std::array{Csg::union_, Csg::intersection, Csg::difference}[static_cast<size_t>(below(3))];
    const Field next = combine(operation, body, placed(solid(static_cast<Solid>(below(oval ? 4 : 5)), random), random));
    if (next.traits().bounds.finite()) body = next;
  }
  return body;
}

Camera random_camera(std::mt19937& random, const Box& box, bool perspective) {
  const glm::dvec3 way = direction(random);
  return line_view(box, way, uniform(random, 2.5, 6.0), perspective);
}

using Polyline = std::vector<glm::dvec2>;

/// Polylines whose nearest point is asked for often: their steps by cells of the picture.
class Lines {
 public:
  explicit Lines(std::vector<Polyline> lines) : lines_(std::move(lines)) {
    for (const Polyline& line : lines_) {
      for (size_t i = 0; i + 1 < line.size(); ++i) {
        const double length = glm::distance(line[i], line[i + 1]);
        const int parts = 1 + static_cast<int>(length);
        for (int k = 0; k < parts; ++k) {
          const glm::dvec2 a = glm::mix(line[i], line[i + 1], static_cast<double>(k) / parts),
                           b = glm::mix(line[i], line[i + 1], (k + 1.0) / parts);
          cells_[cell(0.5 * (a + b))].push_back({a, b});
        }
      }
    }
  }
  double distance_to(const glm::dvec2& p) const {
    double least = 1e9;
    for (int i = 0; i < 9; ++i) {
      const auto at = cells_.find(cell(p + glm::dvec2(i % 3 - 1, i / 3 - 1)));
      if (at == cells_.end()) continue;
      for (const auto& [a, b] : at->second) least = std::min(least, distance_to_segment(p, a, b));
    }
    return least;
  }

 private:
  static std::pair<int, int> cell(const glm::dvec2& p) { return {static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y))}; }
  std::vector<Polyline> lines_;
  std::map<std::pair<int, int>, std::vector<std::pair<glm::dvec2, glm::dvec2>>> cells_;
};

Lines drawn(const ViewGraph& graph, LineClass line_class) {
  std::vector<Polyline> lines;
  for (const LineEdge& edge : graph.edges) {
    if (edge.line_class != line_class) continue;
    Polyline line;
    for (const LinePoint& point : edge.points) line.push_back(point.px);
    if (edge.begin < 0) line.push_back(line.front());
    lines.push_back(std::move(line));
  }
  return Lines(std::move(lines));
}

/// In a picture: a body, and from where.
struct Seen {
  const Field& body;
  const Camera& camera;
  std::string what{};
  int &points, &edges, &counted,
      &conflicts;  ///< Of another graph that were found; of the graph; those whose layers were counted; conflicts.
};

/// What makes a point one of a line, by the field alone: it lies on the surface, and smooth surface turns away from the eye there.
bool is_on_line(FieldEvaluator& field, const Seen& seen, const LineEdge& edge, size_t i) {
  const glm::dvec3 p = edge.points[i].position;
  const FieldJet jet = field.jet(p);
  if (!(std::fabs(jet.value) < 1e-7)) return false;
  if (edge.crease || i == 0 || i + 1 == edge.points.size()) return true;
  return std::fabs(glm::dot(jet.gradient, view_vector(seen.camera, p))) < 1e-5;
}

/// The layers before the middle of an edge, by bounds of the field along the ray; nothing where the middle is on a chord alone.
std::optional<int> layers_by_bounds(const FieldLayers& layers, const FormBody& form, const Camera& camera, const LineEdge& edge) {
  const size_t n = edge.points.size();
  const LinePoint& middle = edge.points[n / 2];
  const glm::dvec3 p = n > 2 ? middle.position : 0.5 * (edge.points[0].position + edge.points[1].position);
  const auto on = std::count_if(form.surfaces.begin(), form.surfaces.end(),
                                [&](const FormSurface& surface) { return std::fabs(signed_value(surface, p)) < 1e-9; });
  if (on < (edge.crease ? 2 : 1)) return {};
  CurveSample sample;
  sample.depth = middle.depth;
  sample.lift = edge.crease ? view_vector(camera, p) : middle.radial_curvature < 0.0 ? -middle.normal : middle.normal;
  // Farther than faces that coincide are moved apart (SharpField::epsilon).
  sample.p = p + (edge.crease ? 1e-5 : 1e-6) * sample.lift;
  return layers.before(sample);
}

double length_px(const LineEdge& edge) {
  double length = 0.0;
  for (size_t i = 0; i + 1 < edge.points.size(); ++i) length += glm::distance(edge.points[i].px, edge.points[i + 1].px);
  return length;
}

/// Every point fulfils the equations of its line, and is hidden by as many layers as bounds along a ray find.
void expect_true(const ViewGraph& graph, const Seen& seen) {
  for (const LineConflict& conflict : graph.conflicts)
    std::printf("%s: conflict at %f, %f: %s\n", seen.what.c_str(), conflict.px.x, conflict.px.y, conflict.what.c_str());
  seen.conflicts += static_cast<int>(graph.conflicts.size());
  FieldEvaluator field(seen.body);
  const auto form = form_body(seen.body);
  const FieldLayers layers({seen.body}, seen.camera, seen.body.traits().bounds.radius());
  for (const LineEdge& edge : graph.edges) {
    for (size_t i = 0; i < edge.points.size(); ++i) {
      EXPECT_TRUE(is_on_line(field, seen, edge, i))
          << seen.what << fmt::format(", {} at {}, {}", name_of(edge.line_class), edge.points[i].px.x, edge.points[i].px.y);
    }
    if (length_px(edge) < 3.0) continue;
    const std::optional<int> counted = layers_by_bounds(layers, *form, seen.camera, edge);
    if (!counted) continue;
    EXPECT_EQ(edge.invisibility, *counted) << seen.what
                                           << fmt::format(", {} from {}, {}", name_of(edge.line_class), edge.points[0].px.x,
                                                          edge.points[0].px.y);
    ++seen.counted;
  }
}

/// Of another graph every point that fulfils the equations is found; the tips of narrow cones it knows to a cell only.
void expect_complete(const ViewGraph& graph, const ViewGraph& other, const Seen& seen) {
  FieldEvaluator field(seen.body);
  for (const LineClass line_class : {LineClass::contour, LineClass::crease}) {
    const Lines lines = drawn(graph, line_class);
    for (const LineEdge& edge : other.edges) {
      if (edge.line_class != line_class) continue;
      for (size_t i = 1; i + 1 < edge.points.size(); ++i) {
        if (!is_on_line(field, seen, edge, i)) continue;
        const glm::dvec2 px = edge.points[i].px;
        EXPECT_LE(lines.distance_to(px), 0.01) << seen.what << fmt::format(", {} not found at {}, {}", name_of(line_class), px.x, px.y);
        ++seen.points;
      }
    }
  }
}

void expect_agreement(const Scene& scene, const Seen& seen) {
  const ViewGraph form = solve_lines(scene, seen.camera, {}, {}), cells = solve_lines(scene, seen.camera, {.closed_forms = false}, {});
  expect_true(form, seen);
  expect_complete(form, cells, seen);
  seen.edges += static_cast<int>(form.edges.size());
}

TEST(FormLines, AgreeWithTheFieldAndWithTheSearchInCells) {
  std::mt19937 random(random_seed());
  int points = 0, edges = 0, counted = 0, conflicts = 0;
  for (int i = 0; i < kBodies; ++i) {
    const Field body = random_body(random);
    ASSERT_TRUE(form_body(body).has_value());
    const Scene scene = scene_of(body);
    for (const bool perspective : {true, false}) {
      const Camera camera = random_camera(random, body.traits().bounds, perspective);
      expect_agreement(scene, {body, camera, fmt::format("body {}, {}", i, perspective ? "perspective" : "orthographic"), points, edges,
                               counted, conflicts});
    }
  }
  EXPECT_GT(edges, 20 * kBodies);
  EXPECT_GT(points, 1000 * kBodies);
  EXPECT_GT(counted, 10 * kBodies);
  EXPECT_LE(conflicts, kMostConflicts);
}

TEST(FormLines, ToriCutByPlanesAndSpheresAgreeWithTheFieldAndWithTheSearchInCells) {
  std::mt19937 random(random_seed());
  int points = 0, edges = 0, counted = 0, conflicts = 0;
  constexpr int kTori = 8;
  for (int i = 0; i < kTori; ++i) {
    const Field ring = solid(torus, random);
    const Field tool = i % 2 == 0 ? make_shape("box", {{"half", {0.4, 0.5, 0.3}}}) : make_shape("sphere", {{"radius", {0.45}}});
    const Field body = combine(i % 4 < 2 ? Csg::union_ : Csg::difference, ring, translate(placed(tool, random), {0.5, 0.0, 0.1}));
    const Camera camera = random_camera(random, body.traits().bounds, i % 3 != 0);
    const auto form = form_body(body);
    ASSERT_TRUE(form.has_value());
    ASSERT_TRUE(trace_form_curves(form_meetings(*form, {}), camera, make_viewer(camera, glm::dvec3(0.0)), 0.005, {}).has_value());
    expect_agreement(scene_of(body), {body, camera, fmt::format("body {}", i), points, edges, counted, conflicts});
  }
  EXPECT_GT(edges, 4 * kTori);
  EXPECT_GT(points, 500 * kTori);
  EXPECT_GT(counted, 2 * kTori);
  EXPECT_LE(conflicts, kMostConflicts);
}

TEST(FormLines, AreTheSameForAnyNumberOfThreads) {
  std::mt19937 random(random_seed());
  for (int i = 0; i < kBodies; ++i) {
    const Field body = random_body(random);
    const Camera camera = random_camera(random, body.traits().bounds, i % 2 == 0);
    ExecutionSettings one, three;
    one.threads = 1;
    three.threads = 3;
    const ViewGraph a = solve_lines(scene_of(body), camera, {}, one), b = solve_lines(scene_of(body), camera, {}, three);
    ASSERT_EQ(a.edges.size(), b.edges.size()) << i;
    for (size_t e = 0; e < a.edges.size(); ++e) {
      EXPECT_EQ(a.edges[e].invisibility, b.edges[e].invisibility) << i;
      ASSERT_EQ(a.edges[e].points.size(), b.edges[e].points.size()) << i;
      for (size_t k = 0; k < a.edges[e].points.size(); ++k) EXPECT_EQ(a.edges[e].points[k].position, b.edges[e].points[k].position) << i;
    }
  }
}

/// Curves on both of two fields, in space.
std::vector<FieldCurve> seams_of_field(const Field& body) {
  CameraSettings settings;
  settings.eye = glm::dvec3(1.3, 2.1, 5.0);
  settings.target = glm::dvec3(0.0);
  const Camera camera = resolve_camera(settings, body.traits().bounds);
  const auto form = form_body(body);
  EXPECT_TRUE(form.has_value());
  auto curves = trace_form_curves(form_meetings(*form, {}), camera, make_viewer(camera, glm::dvec3(0.0)), 0.005, {});
  EXPECT_TRUE(curves.has_value());
  std::vector<FieldCurve> seams;
  for (FormTrace& trace : *curves) {
    if (trace.curve.seam) seams.push_back(std::move(trace.curve));
  }
  return seams;
}

double length_of(const std::vector<FieldCurve>& curves) {
  double length = 0.0;
  for (const FieldCurve& curve : curves) {
    for (size_t i = 0; i + (curve.closed ? 0 : 1) < curve.points.size(); ++i)
      length += glm::distance(curve.points[i].p, curve.points[(i + 1) % curve.points.size()].p);
  }
  return length;
}

double ellipse_length(double a, double b) {
  double length = 0.0;
  constexpr int kSteps = 100'000;
  for (int i = 0; i < kSteps; ++i) {
    const double t = 2.0 * kPi * (i + 0.5) / kSteps;
    length += std::hypot(a * std::sin(t), b * std::cos(t)) * 2.0 * kPi / kSteps;
  }
  return length;
}

TEST(FormLines, EqualCylindersThatCrossMeetInTwoEllipses) {
  const double r = 0.5, half = 2.0;
  const Field one = make_shape("cylinder", {{"radius", {r}}, {"half_height", {half}}});
  const Field cross = combine(Csg::union_, one, rotate(one, {0.0, 0.0, 1.0}, 0.5 * kPi));
  // And four round rims.
  EXPECT_NEAR(length_of(seams_of_field(cross)), 2.0 * ellipse_length(r, r * std::numbers::sqrt2) + 4.0 * 2.0 * kPi * r, 1e-3);
  const Field both = combine(Csg::intersection, one, rotate(one, {0.0, 0.0, 1.0}, 0.5 * kPi));
  EXPECT_NEAR(length_of(seams_of_field(both)), 2.0 * ellipse_length(r, r * std::numbers::sqrt2), 1e-3);
}

TEST(FormLines, ConesAreCutInConics) {
  // Of the cone r = (0.8 - y) tan 30 deg; each plane's section between its ends, by its equation alone.
  const double slope = std::tan(kPi / 6.0);
  const Field cone = make_shape("cone", {{"angle_deg", {30.0}}, {"height", {1.6}}});
  for (const double x : {0.0, 0.15, 0.3}) {
    const Field half = combine(Csg::intersection, cone, make_shape("plane", {{"normal", {-1.0, 0.0, 0.0}}, {"offset", {-x}}}));
    // A hyperbola z^2 = ((0.8 - y) slope)^2 - x^2 above the base at y = -0.8, two straight lines for x = 0.
    const double rim = 1.6 * slope;
    double branch = 0.0;
    constexpr int kSteps = 400'000;
    const double most = std::sqrt(rim * rim - x * x);
    for (int i = 0; i < kSteps; ++i) {
      const double z = most * (i + 0.5) / kSteps, dy = x == 0.0 ? 1.0 / slope : z / (slope * std::hypot(x, z));
      branch += std::hypot(1.0, dy) * most / kSteps;
    }
    const double chord = 2.0 * most, arc = 2.0 * rim * std::acos(x / rim);
    EXPECT_NEAR(length_of(seams_of_field(half)), 2.0 * branch + chord + arc, 1e-3) << x;
  }
}

TEST(FormLines, SeamsLieOnBothSurfaces) {
  std::mt19937 random(random_seed());
  size_t points = 0;
  for (int i = 0; i < kBodies; ++i) {
    const Field body = random_body(random);
    const auto form = form_body(body);
    ASSERT_TRUE(form.has_value());
    FieldEvaluator whole(body);
    for (const FieldCurve& curve : seams_of_field(body)) {
      for (const CurvePoint& point : curve.points) {
        EXPECT_NEAR(whole.value(point.p), 0.0, 1e-8);
        int on = 0;
        for (const FormSurface& surface : form->surfaces) on += std::fabs(signed_value(surface, point.p)) < 1e-8;
        EXPECT_GE(on, 2);
        ++points;
      }
    }
  }
  EXPECT_GT(points, 1000u);
}

TEST(FormLines, SeamsOfAPlaneNearlyAlongACylinderEndOnWhatCutsThem) {
  std::mt19937 random(random_seed());
  size_t points = 0;
  for (int i = 0; i < 60; ++i) {
    // The ellipse is as long as the radius over the angle.
    const double angle = std::pow(10.0, uniform(random, -6.0, -2.0));
    const Field pillar = make_shape("cylinder", {{"radius", {0.5}}, {"half_height", {2.0}}}),
                side = make_shape("plane", {{"normal", {std::cos(angle), std::sin(angle), 0.0}}, {"offset", {uniform(random, -0.2, 0.3)}}});
    const Field cutters[] = {make_shape("cylinder", {{"radius", {0.3}}, {"half_height", {2.0}}}),
                             make_shape("sphere", {{"radius", {0.45}}}), make_shape("cone", {{"angle_deg", {20.0}}, {"height", {1.5}}})};
    const Field cutter = rotate(cutters[i % 3], direction(random), uniform(random, 1.0, 2.0));
    const Field half = combine(Csg::intersection, pillar, side);
    const Field body = rotate(combine(Csg::difference, half, cutter), direction(random), uniform(random, 0.0, 3.0));
    FieldEvaluator whole(body);
    for (const FieldCurve& curve : seams_of_field(body)) {
      for (const CurvePoint& point : curve.points) EXPECT_NEAR(whole.value(point.p), 0.0, 1e-8) << angle;
      points += curve.points.size();
    }
  }
  EXPECT_GT(points, 1000u);
}

TEST(FormLines, LayersAreTheSignChangesAlongRays) {
  std::mt19937 random(random_seed());
  int several = 0;
  for (int i = 0; i < kBodies; ++i) {
    const Field body = random_body(random);
    const auto form = form_body(body);
    ASSERT_TRUE(form.has_value());
    const Camera camera = random_camera(random, body.traits().bounds, i % 2 == 0);
    const FieldLayers by_bounds({body}, camera, form->extent);
    for (int k = 0; k < 300; ++k) {
      CurveSample sample;
      sample.p = body.traits().bounds.center() + uniform(random, 0.0, 1.2) * form->extent * direction(random);
      sample.lift = direction(random);
      sample.radial_curvature = 1.0;
      const int count = layers_before(*form, camera, form->extent, sample);
      EXPECT_EQ(count, by_bounds.before(sample)) << "body " << i;
      several += count > 1;
    }
  }
  EXPECT_GT(several, 10 * kBodies);
}

TEST(FormLines, ZerosOfTrigonometricPolynomials) {
  std::mt19937 random(random_seed());
  int found = 0;
  for (int i = 0; i < 2000; ++i) {
    const TrigPolynomial f{uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0),
                           uniform(random, -1.0, 1.0)};
    const std::vector<double> zeros = zeros_of(f);
    for (const double u : zeros) EXPECT_NEAR(f.value(u), 0.0, 1e-12);
    int changes = 0;
    constexpr int kSteps = 20'000;
    for (int k = 0; k < kSteps; ++k) changes += (f.value(2.0 * kPi * k / kSteps) < 0.0) != (f.value(2.0 * kPi * (k + 1) / kSteps) < 0.0);
    EXPECT_EQ(zeros.size(), static_cast<size_t>(changes));
    found += changes;
  }
  EXPECT_GT(found, 2000);
  // (1 + cos u)^2 / 2 touches 0 at pi, and -cos^2 u at two places.
  EXPECT_TRUE(positive_ranges({0.75, 1.0, 0.0, 0.25, 0.0}).ranges.size() == 1u);
  EXPECT_TRUE(positive_ranges({-0.5, 0.0, 0.0, -0.5, 0.0}).ranges.empty());
}

}  // namespace
}  // namespace limn
