// Quantitative invisibility along contours against closed forms: how many layers lie in front of each point, and so where exactly that
// changes, at cusps and at T-junctions.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "raymarch/lines.h"
#include "sdf/segment.h"
#include "sdf/shape.h"
#include "tests/random_seed.h"
#include "tests/raymarch/line_views.h"

namespace limn {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kViews = 40;

Camera random_camera(std::mt19937& random, const Box& box, bool perspective) {
  std::normal_distribution<double> normal;
  const glm::dvec3 direction = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
  return line_view(box, direction, std::uniform_real_distribution<double>(2.0, 6.0)(random), perspective);
}

/// From a point of a surface to the eye.
struct Sight {
  glm::dvec3 from{0.0}, way{0.0};  ///< Unit.
  double reach = 0.0;              ///< To the eye; infinite in parallel projection.
};
Sight sight_of(const Camera& camera, const glm::dvec3& p) {
  if (camera.projection == Projection::orthographic) return {p, camera.world_from_camera[2], std::numeric_limits<double>::infinity()};
  const glm::dvec3 to_eye = camera.eye - p;
  return {p, glm::normalize(to_eye), glm::length(to_eye)};
}

int roots_before(double a, double half_b, double c, double reach) {
  const double discriminant = half_b * half_b - a * c;
  if (discriminant <= 0.0) return 0;
  int count = 0;
  for (const double sign : {-1.0, 1.0}) {
    const double t = (-half_b + sign * std::sqrt(discriminant)) / a;
    count += t > 0.0 && t < reach;
  }
  return count;
}

/// A line, sampled densely, and how many layers lie in front of each of its points.
struct ExactLine {
  std::vector<glm::dvec3> points{};
  std::vector<int> layers{};
  bool closed = true;
  bool crease = false;  ///< Runs along a sharp edge.
};

/// About the y axis. A line of sight along a contour touches the torus: of the quartic along it two roots are 0, and two are left, the
/// layers in front of it where they are real and above 0.
struct ExactTorus {
  double major = 1.0, minor = 0.35;

  int own_layers(const Sight& sight) const {
    const double s = 2.0 * glm::dot(sight.from, sight.way), k = glm::dot(sight.from, sight.from) + major * major - minor * minor;
    const double across = sight.way.x * sight.way.x + sight.way.z * sight.way.z;
    return roots_before(1.0, s, s * s + 2.0 * k - 4.0 * major * major * across, sight.reach);
  }

  /// Two closed lines around the ring; where the eye lies beside the plane of some of the tube's circles, too near for a tangent to them,
  /// the two are joined at the ends of each run of angles.
  std::vector<std::vector<glm::dvec3>> contours(const Camera& camera, int steps) const {
    const bool perspective = camera.projection == Projection::perspective;
    std::vector<std::array<glm::dvec3, 2>> points(static_cast<size_t>(steps));
    std::vector<bool> valid(points.size(), false);
    for (size_t i = 0; i < points.size(); ++i) {
      const double turn = 2.0 * kPi * static_cast<double>(i) / steps;
      const glm::dvec3 out(std::cos(turn), 0.0, std::sin(turn)), middle = major * out;
      const glm::dvec3 e = perspective ? camera.eye - middle : camera.world_from_camera[2];
      const double a = glm::dot(e, out), b = e.y, share = (perspective ? minor : 0.0) / std::hypot(a, b);
      valid[i] = share < 1.0;
      for (const int side : {0, 1}) {
        const double angle = std::atan2(b, a) + (side == 0 ? 1.0 : -1.0) * std::acos(std::min(share, 1.0));
        points[i][static_cast<size_t>(side)] = middle + minor * (std::cos(angle) * out + std::sin(angle) * glm::dvec3(0.0, 1.0, 0.0));
      }
    }
    std::vector<std::vector<glm::dvec3>> lines;
    const auto gap = std::find(valid.begin(), valid.end(), false);
    if (gap == valid.end()) {
      lines.resize(2);
      for (const auto& both : points) {
        lines[0].push_back(both[0]);
        lines[1].push_back(both[1]);
      }
      return lines;
    }
    const auto first = static_cast<size_t>(gap - valid.begin());
    std::vector<glm::dvec3> there, back;
    for (size_t k = 1; k <= points.size(); ++k) {
      const size_t i = (first + k) % points.size();
      if (valid[i]) {
        there.push_back(points[i][0]);
        back.push_back(points[i][1]);
      } else if (!there.empty()) {
        there.insert(there.end(), back.rbegin(), back.rend());
        lines.push_back(std::move(there));
        there.clear();
        back.clear();
      }
    }
    return lines;
  }
};

struct ExactEllipsoid {
  glm::dvec3 center{0.0}, radii{1.0};

  int layers(const Sight& sight) const {
    const glm::dvec3 o = (sight.from - center) / radii, d = sight.way / radii;
    return roots_before(glm::dot(d, d), glm::dot(o, d), glm::dot(o, o) - 1.0, sight.reach);
  }
  std::vector<glm::dvec3> contour(const Camera& camera, int steps) const {
    const bool perspective = camera.projection == Projection::perspective;
    const glm::dvec3 e = (perspective ? camera.eye - center : camera.world_from_camera[2]) / radii;
    const double length = glm::length(e), height = perspective ? 1.0 / length : 0.0, radius = std::sqrt(1.0 - height * height);
    const glm::dvec3 axis = e / length;
    const glm::dvec3 x = glm::normalize(glm::cross(axis, std::fabs(axis.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0))),
                     y = glm::cross(axis, x);
    std::vector<glm::dvec3> points;
    for (int i = 0; i < steps; ++i) {
      const double turn = 2.0 * kPi * i / steps;
      points.push_back(center + radii * (height * axis + radius * (std::cos(turn) * x + std::sin(turn) * y)));
    }
    return points;
  }
};

/// Between two planes across its axis, its radius linear along it: a cylinder, a cone, or a stump of one.
struct ExactRevolution {
  glm::dvec3 center{0.0};
  glm::dmat3 axes{1.0};  ///< Columns; the second is the axis.
  double low = -1.0, high = 1.0, radius_low = 1.0, radius_high = 1.0;

  double radius_at(double y) const { return glm::mix(radius_low, radius_high, (y - low) / (high - low)); }
  double slope() const { return (radius_high - radius_low) / (high - low); }
  bool inside(const glm::dvec3& q) const { return q.y > low && q.y < high && std::hypot(q.x, q.z) < radius_at(q.y); }

  /// Of a sight that starts beside the solid or on it: sides of the solid from so far on. Between the roots of its three surfaces the
  /// middles say what lies inside.
  int layers(const Sight& sight) const {
    const glm::dmat3 inverse = glm::transpose(axes);
    const glm::dvec3 o = inverse * (sight.from - center), d = inverse * sight.way;
    const double reach = std::min(sight.reach, 100.0), k = slope(), r = radius_at(o.y);
    const double a = d.x * d.x + d.z * d.z - k * k * d.y * d.y, half_b = o.x * d.x + o.z * d.z - r * k * d.y,
                 c = o.x * o.x + o.z * o.z - r * r;
    std::vector<double> places{kStart, reach};
    const double discriminant = half_b * half_b - a * c;
    for (const double sign : {-1.0, 1.0}) {
      if (discriminant > 0.0) places.push_back((-half_b + sign * std::sqrt(discriminant)) / a);
    }
    for (const double plane : {low, high}) places.push_back((plane - o.y) / d.y);
    std::erase_if(places, [&](double t) { return !(t >= kStart && t <= reach); });
    std::sort(places.begin(), places.end());
    int count = 0;
    bool before = inside(o + 0.5 * (places[0] + places[1]) * d);
    for (size_t i = 1; i + 1 < places.size(); ++i) {
      const bool now = inside(o + 0.5 * (places[i] + places[i + 1]) * d);
      count += now != before;
      before = now;
    }
    return count;
  }

  /// Rims, and the straight lines where the side turns away.
  std::vector<std::vector<glm::dvec3>> rims(int steps) const {
    std::vector<std::vector<glm::dvec3>> all;
    for (const double y : {low, high}) {
      if (radius_at(y) < 1e-6) continue;
      all.emplace_back();
      for (int i = 0; i < steps; ++i) {
        const double turn = 2.0 * kPi * i / steps;
        all.back().push_back(center + axes * glm::dvec3(radius_at(y) * std::cos(turn), y, radius_at(y) * std::sin(turn)));
      }
    }
    return all;
  }
  std::vector<std::vector<glm::dvec3>> contours(const Camera& camera, int steps) const {
    // The normal (cos u, -slope, sin u) is across the way to the eye: all along the side's line, as it lies in its tangent plane.
    const bool perspective = camera.projection == Projection::perspective;
    const glm::dvec3 e = glm::transpose(axes) * (perspective ? camera.eye - center : camera.world_from_camera[2]);
    const double wanted = perspective ? radius_at(0.0) + slope() * e.y : slope() * e.y, across = std::hypot(e.x, e.z);
    std::vector<std::vector<glm::dvec3>> all;
    if (std::fabs(wanted) >= across) return all;
    for (const double sign : {-1.0, 1.0}) {
      const double turn = std::atan2(e.z, e.x) + sign * std::acos(wanted / across);
      all.emplace_back();
      for (int i = 0; i <= steps; ++i) {
        const double y = glm::mix(low, high, static_cast<double>(i) / steps), r = radius_at(y);
        all.back().push_back(center + axes * glm::dvec3(r * std::cos(turn), y, r * std::sin(turn)));
      }
    }
    return all;
  }

 private:
  static constexpr double kStart = 1e-6;
};

struct Stats {
  std::int64_t compared = 0, changes = 0, near_changes = 0;
};

/// The place of a line of the graph that is nearest in the image among those at the same depth, of which a pixel counts as 0.05 px.
struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  double in_image_px = 0.0;
  int invisibility = -1;
};
Nearest nearest_in(const ViewGraph& graph, const Camera& camera, bool crease, const glm::dvec3& p) {
  Nearest nearest;
  const glm::dvec3 image = project(camera, p);
  const glm::dvec2 px(image);
  const double per_unit = 0.05 * pixels_per_unit_at(camera, image.z);
  const bool perspective = camera.projection == Projection::perspective;
  for (const LineEdge& edge : graph.edges) {
    if (edge.crease != crease) continue;
    const size_t n = edge.points.size();
    for (size_t i = 0; i + (edge.begin < 0 ? 0 : 1) < n; ++i) {
      const LinePoint &a = edge.points[i], &b = edge.points[(i + 1) % n];
      const glm::dvec2 along = b.px - a.px;
      const double length = glm::length(along);
      if (glm::distance(a.px, px) - length > nearest.distance) continue;
      const double t = length > 0.0 ? std::clamp(glm::dot(px - a.px, along) / (length * length), 0.0, 1.0) : 0.0;
      const double beside_px = glm::distance(px, a.px + t * along);
      const double depth = perspective ? 1.0 / glm::mix(1.0 / a.depth, 1.0 / b.depth, t) : glm::mix(a.depth, b.depth, t);
      const double distance = std::max(beside_px, per_unit * std::fabs(depth - image.z));
      if (distance < nearest.distance) nearest = {distance, beside_px, edge.invisibility};
    }
  }
  return nearest;
}

/// Farther than 0.05 px from every exact change the invisibility is the exact one.
void compare(const ViewGraph& graph, const Camera& camera, const std::vector<ExactLine>& lines, const std::string& what, Stats& stats) {
  for (const ExactLine& line : lines) {
    const size_t n = line.points.size();
    std::vector<glm::dvec2> px;
    for (const glm::dvec3& p : line.points) px.emplace_back(project(camera, p));
    std::vector<size_t> changes;
    for (size_t i = 0; i + (line.closed ? 0 : 1) < n; ++i) {
      if (line.layers[i] != line.layers[(i + 1) % n]) changes.push_back(i);
    }
    stats.changes += static_cast<std::int64_t>(changes.size());
    // Every 97th point, and those about each change.
    std::vector<size_t> asked;
    for (size_t i = 0; i < n; i += 97) asked.push_back(i);
    for (const size_t change : changes) {
      for (size_t k = 0; k < 160; ++k) {
        if (line.closed || (change + k >= 80 && change + k < n + 80)) asked.push_back((change + n - 80 + k) % n);
      }
    }
    for (const size_t i : asked) {
      const bool beside_change = std::any_of(changes.begin(), changes.end(), [&](size_t change) {
        return distance_to_segment(px[i], px[change], px[(change + 1) % n]) <= 0.05;
      });
      if (beside_change) {
        ++stats.near_changes;
        continue;
      }
      const Nearest found = nearest_in(graph, camera, line.crease, line.points[i]);
      ++stats.compared;
      // Depths between the points of an edge are known to some pixels only where it is seen end on.
      ASSERT_LT(found.distance, 0.25) << what;
      ASSERT_LT(found.in_image_px, 0.05) << what;
      ASSERT_EQ(found.invisibility, line.layers[i]) << what << fmt::format(" at {:.3f}, {:.3f}", px[i].x, px[i].y);
    }
  }
}

constexpr int kSteps = 20000;

TEST(LinesVisibility, ATorusChangesAtItsExactCuspsAndTJunctions) {
  std::mt19937 random(random_seed());
  Stats stats;
  for (int view = 0; view < kViews; ++view) {
    for (const bool perspective : {true, false}) {
      const ExactTorus torus{1.0, view % 2 == 0 ? 0.35 : 0.15 + 0.5 * std::uniform_real_distribution<double>()(random)};
      Scene scene;
      scene.objects.push_back({.name = "torus", .source = make_shape("torus", {{"major", {torus.major}}, {"minor", {torus.minor}}})});
      const Camera camera = random_camera(random, bounds(scene), perspective);
      std::vector<ExactLine> lines;
      for (const std::vector<glm::dvec3>& points : torus.contours(camera, kSteps)) {
        ExactLine line{points};
        for (const glm::dvec3& p : points) line.layers.push_back(torus.own_layers(sight_of(camera, p)));
        lines.push_back(std::move(line));
      }
      ASSERT_FALSE(lines.empty());
      const std::string what = fmt::format("view {}, {}, minor {}", view, perspective ? "perspective" : "orthographic", torus.minor);
      for (const bool closed_forms : {true, false}) {
        LineSettings settings;
        settings.closed_forms = closed_forms;
        ASSERT_NO_FATAL_FAILURE(compare(solve_lines(scene, camera, settings, {}), camera, lines, what, stats));
      }
    }
  }
  fmt::print("{} points compared, {} changes, {} points within 0.05 px of one\n", stats.compared, stats.changes, stats.near_changes);
  EXPECT_GT(stats.changes, 100);
  EXPECT_GT(stats.compared, stats.near_changes);
}

TEST(LinesVisibility, EllipsoidsHideEachOtherAtTheExactTJunctions) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> any(0.0, 1.0);
  Stats stats;
  for (int view = 0; view < kViews; ++view) {
    for (const bool perspective : {true, false}) {
      // Apart from each other, beside each other, at the corners of a cube.
      std::vector<ExactEllipsoid> shapes;
      Scene scene;
      for (int i = 0; i < 5; ++i) {
        const glm::dvec3 corner((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1);
        shapes.push_back({corner + 0.1 * glm::dvec3(any(random), any(random), any(random)),
                          0.35 + 0.5 * glm::dvec3(any(random), any(random), any(random))});
        const glm::dvec3& radii = shapes.back().radii;
        scene.objects.push_back(
            {.name = fmt::format("ellipsoid {}", i),
             .source = translate(make_shape("ellipsoid", {{"radii", {radii.x, radii.y, radii.z}}}), shapes.back().center)});
      }
      const Camera camera = random_camera(random, bounds(scene), perspective);
      std::vector<ExactLine> lines;
      for (size_t own = 0; own < shapes.size(); ++own) {
        ExactLine line{shapes[own].contour(camera, kSteps)};
        for (const glm::dvec3& p : line.points) {
          int layers = 0;
          for (size_t other = 0; other < shapes.size(); ++other) {
            if (other != own) layers += shapes[other].layers(sight_of(camera, p));
          }
          line.layers.push_back(layers);
        }
        lines.push_back(std::move(line));
      }
      const std::string what = fmt::format("view {}, {}", view, perspective ? "perspective" : "orthographic");
      ASSERT_NO_FATAL_FAILURE(compare(solve_lines(scene, camera, {}, {}), camera, lines, what, stats));
    }
  }
  fmt::print("{} points compared, {} changes, {} points within 0.05 px of one\n", stats.compared, stats.changes, stats.near_changes);
  EXPECT_GT(stats.changes, 100);
  EXPECT_GT(stats.compared, stats.near_changes);
}

/// A cylinder, a cone, and a stump of one as a turned polygon, which is searched for in cells.
std::pair<ExactRevolution, Field> random_revolution(int kind, std::mt19937& random) {
  std::uniform_real_distribution<double> any(0.0, 1.0);
  const double half = 0.35 + 0.4 * any(random), radius = 0.3 + 0.4 * any(random);
  ExactRevolution solid;
  solid.low = -half;
  solid.high = half;
  solid.radius_low = radius;
  solid.radius_high = kind == 0 ? radius : kind == 1 ? 0.0 : 0.4 * radius;
  Field field = kind == 0   ? make_shape("cylinder", {{"radius", {radius}}, {"half_height", {half}}})
                : kind == 1 ? make_shape("cone", {{"angle_deg", {std::atan2(radius, 2.0 * half) * 180.0 / kPi}}, {"height", {2.0 * half}}})
                            : make_shape("revolution", {{"profile", {0.0, -half, radius, -half, 0.4 * radius, half, 0.0, half}}});
  std::normal_distribution<double> normal;
  const glm::dvec3 about = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
  const double turn = 2.0 * kPi * any(random);
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 e(0.0);
    e[axis] = 1.0;
    // Rodrigues' formula.
    solid.axes[axis] = std::cos(turn) * e + std::sin(turn) * glm::cross(about, e) + (1.0 - std::cos(turn)) * glm::dot(about, e) * about;
  }
  return {solid, rotate(field, about, turn)};
}

TEST(LinesVisibility, CylindersConesAndTurnedPolygonsHideThemselvesAndEachOther) {
  std::mt19937 random(random_seed());
  Stats stats;
  for (int view = 0; view < kViews; ++view) {
    for (const bool perspective : {true, false}) {
      std::vector<ExactRevolution> solids;
      Scene scene;
      for (int i = 0; i < 3; ++i) {
        auto [solid, field] = random_revolution(i, random);
        solid.center = 1.1 * glm::dvec3((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, 0.0);
        scene.objects.push_back({.name = fmt::format("solid {}", i), .source = translate(field, solid.center)});
        solids.push_back(solid);
      }
      const Camera camera = random_camera(random, bounds(scene), perspective);
      std::vector<ExactLine> lines;
      for (const ExactRevolution& own : solids) {
        const size_t first = lines.size();
        for (auto& rim : own.rims(kSteps)) lines.push_back({std::move(rim), {}, true, true});
        for (auto& contour : own.contours(camera, kSteps)) lines.push_back({std::move(contour), {}, false, false});
        for (size_t l = first; l < lines.size(); ++l) {
          // Along a contour the sight touches the side that it starts on.
          for (const glm::dvec3& p : lines[l].points) {
            int layers = 0;
            for (const ExactRevolution& solid : solids) {
              if (&solid != &own || lines[l].closed) layers += solid.layers(sight_of(camera, p));
            }
            lines[l].layers.push_back(layers);
          }
        }
      }
      const std::string what = fmt::format("view {}, {}", view, perspective ? "perspective" : "orthographic");
      ASSERT_NO_FATAL_FAILURE(compare(solve_lines(scene, camera, {}, {}), camera, lines, what, stats));
    }
  }
  fmt::print("{} points compared, {} changes, {} points within 0.05 px of one\n", stats.compared, stats.changes, stats.near_changes);
  EXPECT_GT(stats.changes, 100);
  EXPECT_GT(stats.compared, stats.near_changes);
}

}  // namespace
}  // namespace limn
