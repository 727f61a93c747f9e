#include "raymarch/metric/solved_shift.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace limn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Image points of a line at which the model is asked, the true border's own among them.
constexpr size_t kProbes = 5;
/// No first step is larger, and none of the others is larger than so many times the way so far, until the threshold was passed.
constexpr double kFirst_px = 2.0, kGrowth = 3.0;
/// A model's profile is no flatter and no steeper than the true one by more than this, where nothing else is known.
constexpr double kSlopeRatio = 4.0;
/// A place farther off than so many times the first order's, than this, and than a voxel, within which normals may jump, is another
/// feature's.
constexpr double kFar = 4.0, kFar_px = 2.0;
/// Where the threshold was not passed no larger share of the way is extrapolated.
constexpr double kLeft = 0.25;
/// A model's point farther from the true one is of another sheet.
constexpr double kSheet_px = 8.0;
/// Probes nearer to each other say nothing of a slope that floats could tell.
constexpr double kSame_px = 1e-3;
/// The uncertainty is no less than this share of the shift, and no less than this.
constexpr double kBetween = 0.25, kPrecision_px = 0.002;

/// `over`: the square of N.V, with its sign, less that of the threshold. It is what is interpolated: along a line over a sphere it is a
/// parabola, and at the silhouette it has a slope, where N.V itself has none.
struct Probe {
  double along_px = 0.0, over = 0.0;
};

/// What is known of a line.
struct Profile {
  std::vector<Probe> probes{};                                   ///< By place.
  double slope = 0.0;                                            ///< Of the true surface at its border, 1 / px.
  double inner_wall_px = -kInfinity, outer_wall_px = kInfinity;  ///< The nearest places where the object was not seen.
  Probe last{};
  double asked_px = 0.0;  ///< Where it is asked next, or was last.
};

double square(double n_dot_v) { return n_dot_v * std::abs(n_dot_v); }
double angle(double n_dot_v) { return std::acos(std::clamp(n_dot_v, -1.0, 1.0)); }

void add(Profile& profile, const Probe& probe) {
  const auto at = std::lower_bound(profile.probes.begin(), profile.probes.end(), probe,
                                   [](const Probe& a, const Probe& b) { return a.along_px < b.along_px; });
  profile.probes.insert(at, probe);
  profile.last = probe;
}

/// The first of the two neighbours that have the threshold between them, N.V rising: those nearest to the true border.
std::optional<size_t> crossing(const Profile& profile) {
  const std::vector<Probe>& probes = profile.probes;
  std::optional<size_t> found;
  const auto distance = [&](size_t i) { return std::abs(probes[i].along_px + probes[i + 1].along_px); };
  for (size_t i = 0; i + 1 < probes.size(); ++i) {
    if (probes[i].over < 0.0 && probes[i + 1].over >= 0.0 && (!found || distance(i) < distance(*found))) found = i;
  }
  return found;
}

double slope_between(const Probe& a, const Probe& b) { return (b.over - a.over) / (b.along_px - a.along_px); }
double by_secant(const Probe& a, const Probe& b) { return a.along_px - a.over / slope_between(a, b); }

/// Where the parabola through three meets the threshold between `a` and `b`, which have it between them.
double by_parabola(const Probe& a, const Probe& b, const Probe& third) {
  if (std::abs(third.along_px - a.along_px) < kSame_px || std::abs(third.along_px - b.along_px) < kSame_px) return by_secant(a, b);
  const double slope = slope_between(a, b), bend = (slope_between(b, third) - slope) / (third.along_px - a.along_px);
  const double at_a = slope - bend * (b.along_px - a.along_px), root = std::sqrt(std::max(0.0, at_a * at_a - 4.0 * bend * a.over));
  // The rising one of both roots, without a difference of equal numbers.
  const double step = at_a + root > 0.0 ? -2.0 * a.over / (at_a + root) : (root - at_a) / (2.0 * bend);
  return step >= 0.0 && step <= b.along_px - a.along_px ? a.along_px + step : by_secant(a, b);
}

double within_crossing(const std::vector<Probe>& probes, size_t i) {
  const Probe &a = probes[i], &b = probes[i + 1];
  if (b.along_px - a.along_px < kSame_px || probes.size() == 2) return by_secant(a, b);
  const bool has_before = i > 0, has_after = i + 2 < probes.size();
  const bool takes_after = has_after && (!has_before || probes[i + 2].along_px - b.along_px < a.along_px - probes[i - 1].along_px);
  return by_parabola(a, b, probes[takes_after ? i + 2 : i - 1]);
}

/// From the last probe on, by the slope that the model showed as far as the true surface's allows.
double beyond_probes(const Profile& profile) {
  const Probe& last = profile.last;
  if (last.along_px == 0.0) return std::clamp(-last.over / profile.slope, -kFirst_px, kFirst_px);
  const auto first = std::find_if(profile.probes.begin(), profile.probes.end(), [](const Probe& one) { return one.along_px == 0.0; });
  const double slope = std::clamp(slope_between(*first, last), profile.slope / kSlopeRatio, profile.slope * kSlopeRatio);
  const double most_px = kGrowth * std::abs(last.along_px);
  return last.along_px + std::clamp(-last.over / slope, -most_px, most_px);
}

double estimate(const Profile& profile) {
  const std::optional<size_t> found = crossing(profile);
  return found ? within_crossing(profile.probes, *found) : beyond_probes(profile);
}

/// The place to ask next; halfway back where the object was not seen before that.
double next_place(const Profile& profile, double reach_px) {
  const double place = std::clamp(estimate(profile), -reach_px, reach_px);
  if (place >= profile.outer_wall_px) return 0.5 * (profile.last.along_px + profile.outer_wall_px);
  if (place <= profile.inner_wall_px) return 0.5 * (profile.last.along_px + profile.inner_wall_px);
  return place;
}

/// False where the model does not show the border's sheet there.
bool begin(const ShiftLine& line, const PointSample& seen, Profile& profile, SolvedShift& solved) {
  if (!(glm::distance(seen.position, line.position) * line.px_per_unit <= kSheet_px)) return false;
  const double c = line.n_dot_v, slope = 2.0 * c * std::sqrt(1.0 - c * c) / line.px_per_radian;
  // Where the true surface is flat rounding decides the slope's sign.
  profile.slope = std::max(slope, std::numeric_limits<double>::min());
  solved.normal_error = angle(double{seen.n_dot_v}) - angle(c);
  solved.first_order_px = solved.normal_error * line.px_per_radian;
  return true;
}

void take(const ShiftLine& line, const PointSample& seen, Profile& profile) {
  if (seen.status == HitStatus::hit && seen.id == line.object) {
    add(profile, {profile.asked_px, square(double{seen.n_dot_v}) - square(line.n_dot_v)});
  } else {
    double& wall = profile.asked_px > 0.0 ? profile.outer_wall_px : profile.inner_wall_px;
    wall = profile.asked_px;
  }
}

/// `voxel_px`: of the model; 0 without voxels.
void finish(const Profile& profile, double voxel_px, double reach_px, SolvedShift& solved) {
  const double place = estimate(profile), left_px = std::abs(place - profile.last.along_px);
  solved.shift_px = std::clamp(place, std::max(-reach_px, profile.inner_wall_px), std::min(reach_px, profile.outer_wall_px));
  solved.uncertainty_px = std::max(std::abs(place - profile.asked_px) + kBetween * std::abs(solved.shift_px), kPrecision_px);
  const double far_px = std::min(reach_px, std::max({kFar_px, kFar * std::abs(solved.first_order_px), voxel_px}));
  const bool extrapolated = !crossing(profile) && left_px > std::max(kSame_px, kLeft * std::abs(place));
  if (place <= profile.inner_wall_px || place >= profile.outer_wall_px) {
    solved.fault = ShiftFault::covered;
  } else if (std::abs(place) > far_px || extrapolated) {
    solved.fault = ShiftFault::turns_back;
  }
}

}  // namespace

std::vector<SolvedShift> solve_shifts(const SceneModel& model, const Camera& camera, std::span<const ShiftLine> lines, double reach_px) {
  std::vector<Profile> profiles(lines.size());
  std::vector<SolvedShift> solved(lines.size());
  std::vector<glm::dvec2> points(lines.size());
  std::vector<PointSample> seen(lines.size());
  std::vector<char> begun(lines.size(), 0);
  for (size_t probe = 0; probe < kProbes; ++probe) {
    for (size_t i = 0; i < lines.size(); ++i) {
      if (begun[i]) profiles[i].asked_px = next_place(profiles[i], reach_px);
      points[i] = lines[i].px + profiles[i].asked_px * lines[i].outward;
    }
    sample_points(model, camera, points, seen);
    for (size_t i = 0; i < lines.size(); ++i) {
      if (probe == 0) begun[i] = seen[i].id == lines[i].object && begin(lines[i], seen[i], profiles[i], solved[i]);
      if (begun[i]) take(lines[i], seen[i], profiles[i]);
    }
  }
  for (size_t i = 0; i < lines.size(); ++i) {
    if (!begun[i]) {
      solved[i].fault = ShiftFault::outside;
      continue;
    }
    const double voxel = model.surfaces[static_cast<size_t>(lines[i].object - 1)].info.voxel_size;
    finish(profiles[i], voxel * lines[i].px_per_unit, reach_px, solved[i]);
  }
  return solved;
}

}  // namespace limn
