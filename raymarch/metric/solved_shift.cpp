#include "raymarch/metric/solved_shift.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace limn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Image points of a line at which the model is asked, the true border's own among them.
constexpr size_t kProbes = 5;
/// And so far from the true border on either side, px: whether N.V meets the threshold more than once.
constexpr std::array<double, 6> kLooks_px = {-0.35, 0.35, -0.9, 0.9, -2.0, 2.0};
/// Between places that N.V meets the threshold at: a pixel from one line to the next costs as much as so many pixels from the true border.
constexpr double kJump = 2.0;
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
    double &outer = profile.outer_wall_px, &inner = profile.inner_wall_px;
    if (profile.asked_px > 0.0)
      outer = std::min(outer, profile.asked_px);
    else
      inner = std::max(inner, profile.asked_px);
  }
}

/// A place where the border may be, and how well it is known.
struct Candidate {
  double place_px = 0.0, uncertainty_px = 0.0;
};

/// What five probes led to, and wherever else N.V rises through the threshold between neighbours on the surface.
std::vector<Candidate> candidates_of(const Profile& profile, const Candidate& solved) {
  std::vector<Candidate> result{solved};
  const std::vector<Probe>& probes = profile.probes;
  for (size_t i = 0; i + 1 < probes.size(); ++i) {
    const Probe &a = probes[i], &b = probes[i + 1];
    const bool own = a.along_px <= solved.place_px && solved.place_px <= b.along_px;
    if (own || a.over >= 0.0 || b.over < 0.0 || a.along_px < profile.inner_wall_px || b.along_px > profile.outer_wall_px) continue;
    const double place = within_crossing(probes, i);
    result.push_back({place, std::min(place - a.along_px, b.along_px - place)});
  }
  return result;
}

/// Of each line the candidate that makes places nearest to the true border and to their neighbours' along it, together (Viterbi 1967).
std::vector<size_t> choose(const std::vector<std::vector<Candidate>>& candidates, std::span<const ShiftLine> lines) {
  const size_t count = lines.size();
  std::vector<size_t> chosen(count, 0);
  std::vector<std::vector<double>> cost(count);
  std::vector<std::vector<size_t>> from(count);
  for (size_t i = 0; i < count; ++i) {
    const bool follows = i > 0 && lines[i].curve == lines[i - 1].curve;
    for (const Candidate& one : candidates[i]) {
      double least = follows ? kInfinity : 0.0;
      size_t best = 0;
      for (size_t k = 0; follows && k < candidates[i - 1].size(); ++k) {
        const double sum = cost[i - 1][k] + kJump * std::abs(one.place_px - candidates[i - 1][k].place_px);
        if (sum < least) least = sum, best = k;
      }
      cost[i].push_back(least + std::abs(one.place_px));
      from[i].push_back(best);
    }
  }
  for (size_t i = count; i-- > 0;) {
    const bool last = i + 1 == count || lines[i + 1].curve != lines[i].curve;
    if (last)
      chosen[i] = static_cast<size_t>(std::min_element(cost[i].begin(), cost[i].end()) - cost[i].begin());
    else
      chosen[i] = from[i + 1][chosen[i + 1]];
  }
  return chosen;
}

double distance_to_nearest(const std::vector<Candidate>& candidates, size_t chosen) {
  double nearest = kInfinity;
  for (size_t k = 0; k < candidates.size(); ++k) {
    if (k != chosen) nearest = std::min(nearest, std::abs(candidates[k].place_px - candidates[chosen].place_px));
  }
  return nearest;
}

/// What the first probes led to. `voxel_px`: of the model; 0 without voxels.
void finish(const Profile& profile, double voxel_px, double reach_px, SolvedShift& solved) {
  const double place = estimate(profile), left_px = std::abs(place - profile.last.along_px);
  solved.shift_px = std::clamp(place, std::max(-reach_px, profile.inner_wall_px), std::min(reach_px, profile.outer_wall_px));
  solved.uncertainty_px = std::abs(place - profile.asked_px);
  const double far_px = std::min(reach_px, std::max({kFar_px, kFar * std::abs(solved.first_order_px), voxel_px}));
  const bool extrapolated = !crossing(profile) && left_px > std::max(kSame_px, kLeft * std::abs(place));
  if (place <= profile.inner_wall_px || place >= profile.outer_wall_px) {
    solved.fault = ShiftFault::covered;
  } else if (std::abs(place) > far_px || extrapolated) {
    solved.fault = ShiftFault::turns_back;
  }
}

/// The lines' image points, each at its profile's `asked_px`, asked of the model together.
void ask(const SceneModel& model, const Camera& camera, std::span<const ShiftLine> lines, const std::vector<Profile>& profiles,
         std::vector<PointSample>& seen) {
  std::vector<glm::dvec2> points(lines.size());
  for (size_t i = 0; i < lines.size(); ++i) points[i] = lines[i].px + profiles[i].asked_px * lines[i].outward;
  sample_points(model, camera, points, seen, PointRays::in_packets);
}

/// Where N.V meets the threshold elsewhere, too, and which of the places is the border's.
void look_around(const SceneModel& model, const Camera& camera, std::span<const ShiftLine> lines, std::vector<Profile>& profiles,
                 const std::vector<char>& begun, std::vector<SolvedShift>& solved) {
  std::vector<PointSample> seen(lines.size());
  for (const double look_px : kLooks_px) {
    for (Profile& profile : profiles) profile.asked_px = look_px;
    ask(model, camera, lines, profiles, seen);
    for (size_t i = 0; i < lines.size(); ++i) {
      if (begun[i]) take(lines[i], seen[i], profiles[i]);
    }
  }
  std::vector<std::vector<Candidate>> candidates(lines.size());
  for (size_t i = 0; i < lines.size(); ++i) {
    const Candidate own{solved[i].shift_px, solved[i].uncertainty_px};
    candidates[i] = begun[i] ? candidates_of(profiles[i], own) : std::vector<Candidate>{own};
  }
  const std::vector<size_t> chosen = choose(candidates, lines);
  for (size_t i = 0; i < lines.size(); ++i) {
    const Candidate& one = candidates[i][chosen[i]];
    if (chosen[i] > 0) solved[i].fault = ShiftFault::none;
    solved[i].shift_px = one.place_px;
    const double other_px = distance_to_nearest(candidates[i], chosen[i]);
    solved[i].uncertainty_px = std::max(one.uncertainty_px + kBetween * std::abs(one.place_px), kPrecision_px);
    if (std::isfinite(other_px)) solved[i].uncertainty_px = std::max(solved[i].uncertainty_px, other_px);
  }
}

}  // namespace

std::vector<SolvedShift> solve_shifts(const SceneModel& model, const Camera& camera, std::span<const ShiftLine> lines, double reach_px) {
  std::vector<Profile> profiles(lines.size());
  std::vector<SolvedShift> solved(lines.size());
  std::vector<PointSample> seen(lines.size());
  std::vector<char> begun(lines.size(), 0);
  for (size_t probe = 0; probe < kProbes; ++probe) {
    for (size_t i = 0; i < lines.size(); ++i) {
      if (begun[i]) profiles[i].asked_px = next_place(profiles[i], reach_px);
    }
    ask(model, camera, lines, profiles, seen);
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
  look_around(model, camera, lines, profiles, begun, solved);
  return solved;
}

}  // namespace limn
