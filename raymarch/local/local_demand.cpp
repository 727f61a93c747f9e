#include "raymarch/local/local_demand.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raymarch/local/local_mesh.h"

namespace limn {
namespace {

/// Three edges whose chords stand off by the same amount leave the triangle's middle off by 4/3 of it.
constexpr double kMiddleFactor = 4.0 / 3.0;
/// Of the tolerance, what the chords of a silhouette may take.
constexpr double kSilhouetteShare = 0.8;
/// Of the tolerance, what may be expected of an inner border: slopes are known at a few points only.
constexpr double kInnerShare = 0.8;
/// Of the distance from the silhouette, what a chord may take: it must not reach over it.
constexpr double kReach = 0.5;
/// What is hidden stays so when the border moves by the tolerance, and by this much.
constexpr double kHiddenMargin_px = 2.0;
/// How far what lies beside the picture may reach into it, px.
constexpr double kAside_px = 4.0;
/// Normals that turn by more along an edge (45 degrees) may hide a border between them.
const double kMostTurnCosine = std::cos(0.785398163397448);
/// An edge shorter than this hides nothing, px.
constexpr double kSmall_px = 2.0;
/// A folded facet whose sides are shorter than this shows its back to no ray, px.
constexpr double kFoldSide_px = 0.1;

size_t next(size_t k) { return (k + 1) % 3; }

/// A triangle as one picture shows it.
struct Seen {
  std::array<glm::dvec3, 6> px{};           ///< Corners, then middles.
  std::array<double, 6> facing{};           ///< N.V there.
  std::array<double, 3> off_px{}, wrong{};  ///< Of each edge: how far the chord stands off, and by how much its interpolated N.V is wrong.
  std::array<double, 3> length_px{};
  std::array<double, 3> beyond{};  ///< N.V at the middles on the other side of each edge.
  double low = 0.0, high = 0.0;    ///< Bounds of N.V, taken as quadratic.
  double slope = 0.0, bend = 0.0;  ///< Of N.V by pixels: its gradient, and its second difference.
  double units_per_px = 0.0;
};

bool in_picture(const Camera& camera, const TriangleSample& triangle, Seen& seen) {
  glm::dvec2 low(1e300), high(-1e300);
  for (size_t k = 0; k < 3; ++k) {
    seen.px[k] = project(camera, triangle.corners[k]);
    seen.px[3 + k] = project(camera, triangle.middles[k]);
    for (const glm::dvec3& p : {seen.px[k], seen.px[3 + k]}) {
      if (camera.projection == Projection::perspective && !(p.z > 0.0)) return false;
      low = glm::min(low, glm::dvec2(p)), high = glm::max(high, glm::dvec2(p));
    }
  }
  return high.x >= -kAside_px && high.y >= -kAside_px && low.x <= camera.width_px + kAside_px && low.y <= camera.height_px + kAside_px;
}

/// |grad N.V| by pixels, of the plane through three of the points; infinite where they are seen edge on.
double slope_of(const Seen& seen, const std::array<size_t, 3>& at) {
  const glm::dvec2 a(seen.px[at[1]] - seen.px[at[0]]), b(seen.px[at[2]] - seen.px[at[0]]);
  const double area = a.x * b.y - a.y * b.x;
  const double fa = seen.facing[at[1]] - seen.facing[at[0]], fb = seen.facing[at[2]] - seen.facing[at[0]];
  return glm::length(glm::dvec2(fa * b.y - fb * a.y, fb * a.x - fa * b.x)) / std::abs(area);
}

/// The least slope of the quarters in which N.V may pass `level`, by at most `wrong`: N.V bends, and the border goes where it is flat.
double slope_at(const Seen& seen, double level, double wrong) {
  constexpr std::array<std::array<size_t, 3>, 4> kQuarters{{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
  double least = std::numeric_limits<double>::infinity();
  for (const std::array<size_t, 3>& at : kQuarters) {
    const auto [low, high] = std::minmax({seen.facing[at[0]], seen.facing[at[1]], seen.facing[at[2]]});
    if (low - wrong <= level && high + wrong >= level) least = std::min(least, slope_of(seen, at));
  }
  return std::isfinite(least) ? std::min(least, seen.slope) : seen.slope;
}

bool look(const Camera& camera, const TriangleSample& triangle, Seen& seen) {
  if (!in_picture(camera, triangle, seen)) return false;
  const double nearest = std::min({seen.px[0].z, seen.px[1].z, seen.px[2].z, seen.px[3].z, seen.px[4].z, seen.px[5].z});
  const double scale = pixels_per_unit_at(camera, nearest);
  seen.units_per_px = 1.0 / scale;
  for (size_t k = 0; k < 3; ++k) {
    seen.facing[k] = glm::dot(triangle.corner_normals[k], view_vector(camera, triangle.corners[k]));
    seen.facing[3 + k] = glm::dot(triangle.middle_normals[k], view_vector(camera, triangle.middles[k]));
    seen.beyond[k] = glm::dot(triangle.beyond[k], view_vector(camera, triangle.middles[k]));
  }
  seen.low = seen.high = seen.facing[0];
  for (size_t k = 0; k < 3; ++k) {
    const glm::dvec3 chord = 0.5 * (triangle.corners[k] + triangle.corners[next(k)]), off = triangle.middles[k] - chord;
    seen.off_px[k] = scale * (triangle.crease[k] ? glm::length(off) : std::abs(glm::dot(off, triangle.middle_normals[k])));
    const glm::dvec3 normal = triangle.corner_normals[k] + triangle.corner_normals[next(k)];
    const double length = glm::length(normal);
    const double traced = length > 0.0 ? glm::dot(normal, view_vector(camera, chord)) / length : 0.0;
    seen.wrong[k] = std::abs(traced - seen.facing[3 + k]);
    seen.length_px[k] = scale * glm::distance(triangle.corners[k], triangle.corners[next(k)]);
    const double straight = 0.5 * (seen.facing[k] + seen.facing[next(k)]);
    const double control = 2.0 * seen.facing[3 + k] - straight;
    seen.low = std::min({seen.low, seen.facing[k], control}), seen.high = std::max({seen.high, seen.facing[k], control});
    const glm::dvec2 across(seen.px[next(k)] - seen.px[k]);
    seen.bend = std::max(seen.bend, 8.0 * std::abs(straight - seen.facing[3 + k]) / std::max(glm::dot(across, across), 1e-12));
  }
  seen.slope = slope_of(seen, {0, 1, 2});
  return true;
}

/// How far the triangle lies inside the silhouette at least, px: N.V / (2 |grad N.V|), as near a circle, and no farther than the sharpest
/// turn near by lets it be: beside a fillet a wall seen edge on ends sooner than its own bend tells.
double inside_px(const Seen& seen, double turn) {
  if (seen.low <= 0.0 && seen.high >= 0.0) return 0.0;
  if (!std::isfinite(seen.slope)) return 0.0;
  const double facing = std::min(std::abs(seen.low), std::abs(seen.high));
  const double by_turn = facing * facing / std::max(turn * seen.units_per_px, 1e-9);
  return std::min(facing / (2.0 * std::max(seen.slope, 1e-9)), by_turn);
}

/// How far the inner border moves for an N.V that is wrong by `wrong`, px: to first order, or to second where the slope is small.
double shift_px(const Seen& seen, double wrong, double slope) {
  const double first = wrong / std::max(slope, 1e-12);
  return seen.bend > 0.0 ? std::min(first, std::sqrt(2.0 * wrong / seen.bend)) : first;
}

bool parts(double a, double b, double level) { return (a < level) != (b < level); }

/// Of the edges of a triangle in which N.V may pass the threshold, those that move the inner border too far.
bool moves_inner(const Seen& seen, size_t k, double threshold, double tolerance_px) {
  const double worst = std::max({seen.wrong[0], seen.wrong[1], seen.wrong[2]});
  if (seen.low - worst > threshold || seen.high + worst < threshold) return false;
  const double sine = std::sqrt(std::max(0.0, 1.0 - threshold * threshold));
  return kMiddleFactor / kInnerShare * (shift_px(seen, seen.wrong[k], slope_at(seen, threshold, worst)) + sine * seen.off_px[k]) >
         tolerance_px;
}

unsigned border_demand(const Seen& seen, const TriangleSample& triangle, double turn, const LocalSettings& settings) {
  unsigned split = 0;
  const double tolerance_px = settings.tolerance_px;
  const double inside = settings.everywhere ? 0.0 : inside_px(seen, turn);
  const double silhouette_px = std::min(kSilhouetteShare / kMiddleFactor * tolerance_px + kReach * inside, triangle.coarse_px);
  for (size_t k = 0; k < 3; ++k) {
    if (seen.length_px[k] < tolerance_px) continue;
    bool needed = seen.off_px[k] > silhouette_px;
    // A border along a crease.
    bool along = triangle.crease[k] && parts(seen.facing[3 + k], seen.beyond[k], 0.0);
    for (const double threshold : settings.thresholds) {
      needed = needed || moves_inner(seen, k, threshold, tolerance_px);
      along = along || (triangle.crease[k] && parts(seen.facing[3 + k], seen.beyond[k], threshold));
    }
    needed = needed || (along && seen.off_px[k] > kSilhouetteShare * tolerance_px);
    if (needed) split |= 1u << k;
  }
  return split;
}

unsigned coarse_demand(const Seen& seen, const TriangleSample& triangle, const LocalSettings& settings) {
  unsigned split = 0;
  for (size_t k = 0; k < 3; ++k) {
    if (seen.length_px[k] < settings.tolerance_px) continue;
    const bool turns =
        seen.length_px[k] > kSmall_px && glm::dot(triangle.corner_normals[k], triangle.corner_normals[next(k)]) < kMostTurnCosine;
    if (seen.off_px[k] > triangle.coarse_px || turns || triangle.crosses[k]) split |= 1u << k;
  }
  return split;
}

/// The longest edge of a facet that is turned against the normal at one of its corners: beside a tight bend a chord may reach past the
/// other side of it, and what is folded there shows its back.
unsigned fold_demand(const Seen& seen, const TriangleSample& triangle) {
  const glm::dvec3 facet = glm::cross(triangle.corners[1] - triangle.corners[0], triangle.corners[2] - triangle.corners[0]);
  bool against = false;
  for (const glm::dvec3& normal : triangle.corner_normals) against = against || glm::dot(facet, normal) < 0.0;
  if (!against) return 0;
  size_t longest = 3;
  double most = 0.0;
  for (size_t k = 0; k < 3; ++k) {
    const double length = glm::distance(triangle.corners[k], triangle.corners[next(k)]);
    if (triangle.halves[k] && seen.length_px[k] >= kFoldSide_px && length > most) longest = k, most = length;
  }
  return longest < 3 ? 1u << longest : 0u;
}

double turn_at(const LocalView& view, const TriangleSample& triangle) {
  double turn = 0.0;
  for (const std::uint32_t v : triangle.vertices) turn = std::max(turn, view.turns[v]);
  return turn;
}

}  // namespace

unsigned edges_to_split(const TriangleSample& triangle, std::span<const LocalView> views, const LocalSettings& settings, bool only_coarse) {
  unsigned split = 0;
  for (const LocalView& view : views) {
    Seen seen;
    if (!look(view.camera, triangle, seen)) continue;
    split |= coarse_demand(seen, triangle, settings);
    if (only_coarse) continue;
    const double margin_px = kHiddenMargin_px + settings.tolerance_px;
    if (!settings.everywhere && is_hidden(view.hidden, seen.px, margin_px, margin_px * seen.units_per_px)) continue;
    split |= border_demand(seen, triangle, turn_at(view, triangle), settings);
    if (triangle.unfolds) split |= fold_demand(seen, triangle);
  }
  for (size_t k = 0; k < 3; ++k)
    if (!triangle.halves[k] || (triangle.stays && !triangle.crosses[k])) split &= ~(1u << k);
  return split;
}

}  // namespace limn
