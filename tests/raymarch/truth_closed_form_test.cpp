// The solved border against closed forms, both ways: no point of it is away from the closed form, nothing of the closed form is missing.

#include <fmt/core.h>

#include "tests/raymarch/border_distance.h"
#include "tests/raymarch/truth_shapes.h"

namespace limn::test {
namespace {

constexpr double kThreshold = 0.4;
constexpr int kViews = 20;

double facing(const Camera& camera, const glm::dvec3& normal, const glm::dvec3& p) { return glm::dot(normal, view_vector(camera, p)); }
double facing(const Camera& camera, const Sheet& sheet, const glm::dvec2& q) { return facing(camera, sheet.normal(q), sheet.point(q)); }
glm::dvec2 image(const Camera& camera, const glm::dvec3& p) { return glm::dvec2(project(camera, p)); }

/// The root of facing - c between two parameters of different signs.
glm::dvec2 root(const Camera& camera, const Sheet& sheet, double c, glm::dvec2 a, glm::dvec2 b) {
  const bool a_below = facing(camera, sheet, a) < c;
  for (int i = 0; i < 60; ++i) {
    const glm::dvec2 middle = 0.5 * (a + b);
    ((facing(camera, sheet, middle) < c) == a_below ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

/// The curve's parameters nearest to q along one of the two.
std::optional<glm::dvec2> beside(const Camera& camera, const Sheet& sheet, double c, const glm::dvec2& q, int axis) {
  for (double reach = 1e-7; reach < 0.2; reach *= 2.0) {
    glm::dvec2 a = q, b = q;
    a[axis] -= reach;
    b[axis] += reach;
    if (axis == 0) {
      a = glm::clamp(a, sheet.low, sheet.high);
      b = glm::clamp(b, sheet.low, sheet.high);
    }
    if ((facing(camera, sheet, a) < c) != (facing(camera, sheet, b) < c)) return root(camera, sheet, c, a, b);
  }
  return {};
}

/// How far (px) `px` is from the closed form's curve between the points a and b (on or near it; both may be the same): from a polyline of
/// 13 points of the curve, found along whichever parameter is nearer.
double distance_on_sheet(const Camera& camera, const Sheet& sheet, double c, const glm::dvec3& a, const glm::dvec3& b,
                         const glm::dvec2& px) {
  const glm::dvec2 qa = sheet.parameters(a);
  glm::dvec2 qb = sheet.parameters(b);
  for (int axis = 0; axis < 2; ++axis) {
    if (std::fabs(qb[axis] - qa[axis]) > kPi) qb[axis] += qb[axis] < qa[axis] ? 2.0 * kPi : -2.0 * kPi;
  }
  const int steps = a == b ? 0 : 12;
  double best = 1e9;
  std::optional<glm::dvec2> last;
  for (int i = 0; i <= steps; ++i) {
    const glm::dvec2 q = glm::mix(qa, qb, steps > 0 ? static_cast<double>(i) / steps : 0.0);
    const auto first = beside(camera, sheet, c, q, 0), second = beside(camera, sheet, c, q, 1);
    if (!first && !second) continue;
    const bool use_first = first && (!second || glm::distance(*first, q) < glm::distance(*second, q));
    const glm::dvec2 here = image(camera, sheet.point(use_first ? *first : *second));
    best = std::min(best, test::segment_distance(px, last ? *last : here, here));
    last = here;
  }
  return best;
}

bool on_crease(const Camera& camera, const CreaseCircle& crease, double angle, double c) {
  const glm::dvec3 p = crease.point(angle);
  const double a = facing(camera, crease.side(angle), p), b = facing(camera, crease.cap(angle), p);
  return (a < c) != (b < c) && (c == 0.0 || std::min(a, b) > 0.0);
}

double distance_on_crease(const Camera& camera, const CreaseCircle& crease, double c, const glm::dvec3& p, const glm::dvec2& px) {
  double best = 1e9, angle = angle_of(p);
  for (double step = 0.05; step > 1e-9; step *= 0.5) {
    double at = angle;
    for (const double tried : {angle - step, angle, angle + step}) {
      const double distance = glm::distance(px, image(camera, crease.point(tried)));
      const bool belongs =
          on_crease(camera, crease, tried, c) || on_crease(camera, crease, tried - 1e-4, c) || on_crease(camera, crease, tried + 1e-4, c);
      if (!belongs || distance >= best) continue;
      best = distance;
      at = tried;
    }
    angle = at;
  }
  return best;
}

double distance_to_closed_form(const Camera& camera, const KnownShape& shape, double c, const BorderPoint& a, const BorderPoint& b) {
  const glm::dvec2 px = 0.5 * (a.px + b.px);
  double best = 1e9;
  for (const Sheet& sheet : shape.sheets) best = std::min(best, distance_on_sheet(camera, sheet, c, a.position, b.position, px));
  if (best < 1e-4) return best;
  for (const CreaseCircle& crease : shape.creases) {
    best = std::min(best, distance_on_crease(camera, crease, c, 0.5 * (a.position + b.position), px));
  }
  return best;
}

/// A ray from the torus's point, lifted off by `lift`, leaves it: sphere tracing of the textbook's distance.
bool leaves_torus(const KnownShape& shape, const Camera& camera, const glm::dvec3& p, const glm::dvec3& normal, double lift) {
  const glm::dvec3 direction = view_vector(camera, p);
  double t = 0.0;
  for (int i = 0; t < 4.0 * (shape.major + shape.minor); ++i) {
    const glm::dvec3 q = p + lift * normal + t * direction;
    const double f = std::hypot(std::hypot(q.x, q.z) - shape.major, q.y) - shape.minor;
    if (f < 1e-9 || i > 3000) return false;
    t += f;
  }
  return true;
}

struct Worst {
  double value = 0.0;
  std::string where{};
  void add(double distance, const std::string& place) {
    if (distance <= value) return;
    value = distance;
    where = place;
  }
};

std::string place_of(const char* what, const glm::dvec2& px) { return fmt::format("{} at ({:.3f}, {:.3f})", what, px.x, px.y); }

/// Every seventh point and middle of a step of the solved border. Returns how many of the points are hidden.
int check_accuracy(const Camera& camera, const KnownShape& shape, const BorderTruth& truth, Worst& worst) {
  int hidden = 0;
  for (const BorderCurve& curve : truth.curves.curves) {
    const double c = curve.kind == CurveKind::silhouette ? 0.0 : kThreshold;
    const size_t n = curve.points.size();
    for (size_t i = 0; i + (curve.closed ? 0 : 1) < n; i += 7) {
      const BorderPoint &a = curve.points[i], &b = curve.points[(i + 1) % n];
      worst.add(distance_to_closed_form(camera, shape, c, a, a), place_of("a point", a.px));
      worst.add(distance_to_closed_form(camera, shape, c, a, b), place_of("a step's middle", 0.5 * (a.px + b.px)));
      // A lifted ray says nothing beside the place where a curve passes behind another.
      const double from_end = std::min(glm::distance(a.px, curve.points[0].px), glm::distance(a.px, curve.points[n - 1].px));
      if (!shape.convex && (curve.closed || from_end > 0.2)) hidden += !leaves_torus(shape, camera, a.position, a.normal, 1e-5);
    }
  }
  return hidden;
}

void check_sheet_complete(const Camera& camera, const KnownShape& shape, const Sheet& sheet, double c, const BorderTruth& truth,
                          Worst& worst) {
  constexpr int kLines = 20, kSteps = 200;
  const CurveKind kind = c == 0.0 ? CurveKind::silhouette : CurveKind::inner;
  for (int axis = 0; axis < 2; ++axis) {
    for (int line = 0; line < kLines; ++line) {
      const auto at = [&](int step) {
        glm::dvec2 share((line + 0.37) / kLines);
        share[axis] = (step + 1e-6) / (kSteps + 2e-6);
        return glm::mix(sheet.low, sheet.high, share);
      };
      for (int step = 0; step < kSteps; ++step) {
        if ((facing(camera, sheet, at(step)) < c) == (facing(camera, sheet, at(step + 1)) < c)) continue;
        const glm::dvec2 q = root(camera, sheet, c, at(step), at(step + 1));
        if (!shape.convex && !leaves_torus(shape, camera, sheet.point(q), sheet.normal(q), 1e-5)) continue;
        const glm::dvec2 px = image(camera, sheet.point(q));
        worst.add(distance_to(truth.curves, kind, px), place_of(c == 0.0 ? "a missing silhouette" : "a missing level curve", px));
      }
    }
  }
}

void check_complete(const Camera& camera, const KnownShape& shape, const BorderTruth& truth, Worst& worst) {
  for (const double c : {0.0, kThreshold}) {
    for (const Sheet& sheet : shape.sheets) check_sheet_complete(camera, shape, sheet, c, truth, worst);
    for (const CreaseCircle& crease : shape.creases) {
      for (int i = 0; i < 360; ++i) {
        const double angle = (i + 0.21) * kPi / 180.0;
        if (!on_crease(camera, crease, angle, c)) continue;
        const glm::dvec2 px = image(camera, crease.point(angle));
        worst.add(distance_to(truth.curves, c == 0.0 ? CurveKind::silhouette : CurveKind::inner, px), place_of("a missing crease", px));
      }
    }
  }
}

Camera random_camera(const KnownShape& shape, Projection projection, std::mt19937& random) {
  std::normal_distribution<double> normal;
  CameraSettings settings = view(320, 240, projection);
  settings.direction = glm::dvec3(normal(random), normal(random), normal(random));
  settings.up = glm::dvec3(normal(random), normal(random), normal(random));
  settings.vertical_fov = std::uniform_real_distribution<double>(0.3, 1.1)(random);
  return framing(scene_of({object_of(shape.field)}), settings);
}

struct Counts {
  int generators = 0, levels = 0;
};
/// Closed curves where the closed form knows their number: one of each on what is convex and smooth; a torus has two of each wherever the
/// circle N.V = c on the Gauss sphere keeps off the axis, which is certain in parallel projection only.
Counts known_counts(const KnownShape& shape, Projection projection) {
  if (shape.convex) return {1, shape.creases.empty() ? 1 : 0};
  return {projection == Projection::orthographic ? 2 : 0, projection == Projection::orthographic ? 2 : 0};
}

/// Of all views in one projection.
struct Findings {
  Worst off, missing;
  double bound_px = 0.0;  ///< Stated by the truth.
  std::string faults{};   ///< Wrong counts, hidden points, borders not called exact.
};

Findings look_at(const KnownShape& shape, Projection projection, std::mt19937& random) {
  Findings found;
  for (int i = 0; i < kViews; ++i) {
    const Camera camera = random_camera(shape, projection, random);
    TruthSettings settings;
    settings.threshold = kThreshold;
    const BorderTruth truth = solve_truth(scene_of({object_of(shape.field)}), camera, settings, {});
    const int hidden = check_accuracy(camera, shape, truth, found.off);
    check_complete(camera, shape, truth, found.missing);
    found.bound_px = std::max(found.bound_px, truth.bound_px);
    const Counts counts = known_counts(shape, projection);
    if (hidden > 0) found.faults += fmt::format("view {}: {} points are hidden; ", i, hidden);
    if (counts.generators > 0 && truth.contour_generators != counts.generators)
      found.faults += fmt::format("view {}: {} contour generators, not {}; ", i, truth.contour_generators, counts.generators);
    if (counts.levels > 0 && truth.level_curves != counts.levels)
      found.faults += fmt::format("view {}: {} level curves, not {}; ", i, truth.level_curves, counts.levels);
    if (!truth.exact) found.faults += fmt::format("view {}: not exact; ", i);
  }
  return found;
}

testing::AssertionResult within_a_hundredth_of_a_pixel(const KnownShape& shape) {
  constexpr unsigned seed = 20240;
  std::mt19937 random(seed);
  std::string faults;
  for (const Projection projection : {Projection::orthographic, Projection::perspective}) {
    const Findings found = look_at(shape, projection, random);
    const std::string name = fmt::format("{}, {}", shape.name, projection == Projection::perspective ? "perspective" : "parallel");
    fmt::print("{:28} worst: off {:.5f} px, missing {:.5f} px, stated bound {:.4f} px\n", name, found.off.value, found.missing.value,
               found.bound_px);
    if (!(found.off.value < std::min(0.01, found.bound_px))) faults += fmt::format("{}: off at {}; ", name, found.off.where);
    if (!(found.missing.value < 0.01)) faults += fmt::format("{}: {}; ", name, found.missing.where);
    if (!found.faults.empty()) faults += name + ": " + found.faults;
  }
  if (faults.empty()) return testing::AssertionSuccess();
  return testing::AssertionFailure() << faults << "seed " << seed;
}

TEST(TruthClosedForm, SphereIsWithinAHundredthOfAPixel) {
  EXPECT_TRUE(
      within_a_hundredth_of_a_pixel(known_superellipsoid("sphere", make_shape("sphere", {{"radius", {0.8}}}), glm::dvec3(0.8), 1.0, 1.0)));
}
TEST(TruthClosedForm, EllipsoidIsWithinAHundredthOfAPixel) {
  EXPECT_TRUE(within_a_hundredth_of_a_pixel(
      known_superellipsoid("ellipsoid", make_shape("ellipsoid", {{"radii", {1.0, 0.7, 0.5}}}), {1.0, 0.7, 0.5}, 1.0, 1.0)));
}
TEST(TruthClosedForm, SuperellipsoidIsWithinAHundredthOfAPixel) {
  const Field field = make_shape("superellipsoid", {{"radii", {1.0, 0.75, 0.85}}, {"exponents", {0.6, 0.7}}});
  EXPECT_TRUE(within_a_hundredth_of_a_pixel(known_superellipsoid("superellipsoid", field, {1.0, 0.75, 0.85}, 0.6, 0.7)));
}
TEST(TruthClosedForm, ThinTorusIsWithinAHundredthOfAPixel) {
  EXPECT_TRUE(within_a_hundredth_of_a_pixel(known_torus("thin torus", 1.0, 0.2)));
}
TEST(TruthClosedForm, ThickTorusIsWithinAHundredthOfAPixel) {
  EXPECT_TRUE(within_a_hundredth_of_a_pixel(known_torus("thick torus", 1.0, 0.6)));
}
TEST(TruthClosedForm, CylinderIsWithinAHundredthOfAPixel) { EXPECT_TRUE(within_a_hundredth_of_a_pixel(known_cylinder(0.6, 0.8))); }
TEST(TruthClosedForm, ConeIsWithinAHundredthOfAPixel) { EXPECT_TRUE(within_a_hundredth_of_a_pixel(known_cone(25.0 * kPi / 180.0, 1.6))); }
TEST(TruthClosedForm, KnifeEdgedLensIsWithinAHundredthOfAPixel) {
  EXPECT_TRUE(within_a_hundredth_of_a_pixel(known_lens(0.9, 3.0 * kPi / 180.0)));
}

}  // namespace
}  // namespace limn::test
