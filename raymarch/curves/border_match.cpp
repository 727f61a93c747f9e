#include "raymarch/curves/border_match.h"

#include <algorithm>
#include <cmath>

#include "raymarch/curves/ill_places.h"
#include "raymarch/curves/match_candidates.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kSpacing_px = 1.0;

// Costs, in units of what a partner infinitely far off costs twice over.
constexpr double kMissing = 2.5;     ///< Of a sample without a partner.
constexpr double kEnter = 0.5;       ///< To begin or to end a stretch with partners, at the ends of a curve too,
constexpr double kEnterFar = 0.75;   ///< and so much for each px that they lie off: only what is long has a far partner.
constexpr double kJump = 8.0;        ///< To go to a curve that does not continue this one, or back along it.
constexpr double kSkipped = 0.5;     ///< Of each px of the measured curve that is left out, up to kJump.
constexpr double kBack_px = 0.3;     ///< Going back so far costs nothing: normals of a rough curve cross.
constexpr double kFarHalf_px = 2.0;  ///< A partner so far off costs half of what one infinitely far off does.

/// Viterbi goes round a closed curve and a little further at both ends, so that where its list begins does not matter.
constexpr size_t kOverlap = 32;
constexpr int kMostRounds = 6;
/// Partners of two samples nearer to each other than this are one place.
constexpr double kOnePlace_px = 0.5;
/// An end this near to another curve's beginning leads into it.
constexpr double kJoin_px = 1.0;

double enter_cost(double distance_px) { return kEnter + kEnterFar * distance_px; }
double far_cost(double distance_px) { return 2.0 * distance_px / (distance_px + kFarHalf_px); }

/// Samples first .. last - 1 of one true curve.
struct Run {
  size_t first = 0, last = 0;
  bool closed = false;
};

struct State {
  double cost = 0.0;
  size_t from = 0;
};

class Matcher {
 public:
  Matcher(const BorderCurves& truth, const BorderCurves& measured, std::optional<CurveKind> kind, const Camera& camera)
      : measured_(measured), candidates_(measured), reach_(search_reach_px(camera)) {
    for (const BorderSample& sample : resample(truth, kind, kSpacing_px)) {
      if (samples_.empty() || samples_.back().curve != sample.curve) {
        runs_.push_back({samples_.size(), samples_.size(), truth.curves[sample.curve].closed});
      }
      samples_.push_back(sample);
      runs_.back().last = samples_.size();
    }
    near_.resize(samples_.size());
    parallel_parts(samples_.size(), size_t{64}, [&](const IndexRange<size_t>& part) {
      for (size_t i = part.first; i < part.last; ++i) near_[i] = candidates_.of(samples_[i], reach_);
    });
    chosen_.assign(samples_.size(), kNone);
    run_of_.resize(samples_.size());
    for (size_t r = 0; r < runs_.size(); ++r) std::fill(run_of_.begin() + index(runs_[r].first), run_of_.begin() + index(runs_[r].last), r);
  }

  void match() {
    std::vector<char> again(runs_.size(), 1);
    for (int round = 0; round <= kMostRounds; ++round) {
      for (size_t r = 0; r < runs_.size(); ++r)
        if (again[r]) follow(runs_[r]);
      again.assign(runs_.size(), 0);
      const std::vector<size_t> losers = find_losers();
      if (losers.empty()) return;
      for (const size_t i : losers) {
        near_[i].erase(near_[i].begin() + index(chosen_[i]));
        chosen_[i] = kNone;
        again[run_of_[i]] = 1;
      }
    }
  }

  const std::vector<BorderSample>& samples() const { return samples_; }
  const MatchCandidate* partner(size_t i) const { return chosen_[i] == kNone ? nullptr : &near_[i][chosen_[i]]; }

  /// The stretches of each measured curve that are partners: from one sample's partner to the next one's, and a pixel about each.
  std::vector<std::vector<std::pair<double, double>>> claimed() const {
    std::vector<std::vector<std::pair<double, double>>> stretches(measured_.curves.size());
    const auto claim = [&](size_t curve, double from, double to) { stretches[curve].push_back({from - kSpacing_px, to + kSpacing_px}); };
    for (const Run& run : runs_) {
      for (size_t i = run.first; i < run.last; ++i) {
        const MatchCandidate* a = partner(i);
        if (a == nullptr) continue;
        claim(a->curve, a->along_px, a->along_px);
        const size_t next = i + 1 < run.last ? i + 1 : run.first;
        const MatchCandidate* b = next > i || run.closed ? partner(next) : nullptr;
        if (b == nullptr || b->curve != a->curve || next == i) continue;
        const double between = advance(*a, *b);
        const double most = 2.0 * kSpacing_px + 3.0 * std::max(a->distance_px, b->distance_px);
        if (between > 0.0 && between <= most) claim(a->curve, a->along_px, a->along_px + between);
      }
    }
    return stretches;
  }

 private:
  static constexpr size_t kNone = static_cast<size_t>(-1);
  static std::ptrdiff_t index(size_t i) { return static_cast<std::ptrdiff_t>(i); }

  /// How far along its curve `b` lies beyond `a`; round a closed curve the shorter way.
  double advance(const MatchCandidate& a, const MatchCandidate& b) const {
    double between = b.along_px - a.along_px;
    const double length = candidates_.length_px(a.curve);
    if (measured_.curves[a.curve].closed) between -= length * std::round(between / length);
    return between;
  }

  /// How far `b` lies beyond `a` where its curve continues the other's.
  std::optional<double> across_ends(const MatchCandidate& a, const MatchCandidate& b) const {
    const BorderCurve &from = measured_.curves[a.curve], &to = measured_.curves[b.curve];
    if (from.closed || to.closed) return std::nullopt;
    const double left = candidates_.length_px(a.curve) - a.along_px, gap = glm::distance(from.points.back().px, to.points.front().px);
    if (gap > kJoin_px) return std::nullopt;
    return left + gap + b.along_px;
  }

  double move_cost(const MatchCandidate& a, const MatchCandidate& b, double spacing) const {
    const double jump = kJump + kEnterFar * (a.distance_px + b.distance_px);
    double between = 0.0;
    if (a.curve == b.curve) {
      between = advance(a, b);
    } else {
      const std::optional<double> across = across_ends(a, b);
      if (!across) return jump;
      between = *across;
    }
    if (between < -kBack_px) return std::min(jump, 2.0 - between);
    // Round a corner that has grown there is more of the curve.
    const double most = 2.0 * spacing + 1.5 * (a.distance_px + b.distance_px);
    return std::min(jump, kSkipped * std::max(0.0, between - most));
  }

  /// The cheapest sequence of partners along a true curve. States: its candidates, and missing.
  void follow(const Run& run) {
    const size_t n = run.last - run.first, overlap = run.closed ? std::min(n, kOverlap) : 0, count = n + 2 * overlap;
    const auto sample = [&](size_t k) { return run.first + (k + n - overlap) % n; };
    std::vector<std::vector<State>> states(count);
    for (size_t k = 0; k < count; ++k) {
      const size_t own = sample(k);
      states[k].resize(near_[own].size() + 1);
      for (size_t s = 0; s < states[k].size(); ++s) {
        const bool missing = s == near_[own].size();
        State& state = states[k][s];
        if (k > 0) state = cheapest(states[k - 1], sample(k - 1), own, s);
        if (!run.closed && !missing) state.cost += ((k == 0) + (k + 1 == count)) * enter_cost(near_[own][s].distance_px);
        state.cost += missing ? kMissing : far_cost(near_[own][s].distance_px);
      }
    }
    size_t s = 0;
    for (size_t other = 1; other < states.back().size(); ++other)
      if (states.back()[other].cost < states.back()[s].cost) s = other;
    for (size_t k = count; k-- > 0;) {
      if (k >= overlap && k < overlap + n) chosen_[sample(k)] = s == near_[sample(k)].size() ? kNone : s;
      s = states[k][s].from;
    }
  }

  State cheapest(const std::vector<State>& before, size_t from, size_t to, size_t s) const {
    const bool missing = s == near_[to].size();
    State best{std::numeric_limits<double>::infinity(), 0};
    for (size_t p = 0; p < before.size(); ++p) {
      const bool was_missing = p == near_[from].size();
      double cost = before[p].cost;
      if (missing != was_missing) cost += enter_cost((missing ? near_[from][p] : near_[to][s]).distance_px);
      if (!missing && !was_missing) cost += move_cost(near_[from][p], near_[to][s], samples_[to].weight_px);
      if (cost < best.cost) best = {cost, p};
    }
    return best;
  }

  /// True where two samples may share a place: neighbours along their curve, or where one curve leads into the next.
  bool may_share(size_t i, size_t j) const {
    const double a = partner(i)->distance_px, b = partner(j)->distance_px;
    if (run_of_[i] == run_of_[j]) {
      const Run& run = runs_[run_of_[i]];
      size_t apart = i > j ? i - j : j - i;
      if (run.closed) apart = std::min(apart, run.last - run.first - apart);
      if (static_cast<double>(apart) <= 2.0 + 2.0 * std::max(a, b) / kSpacing_px) return true;
    }
    return glm::distance(samples_[i].px, samples_[j].px) <= 1.5 * kSpacing_px && std::abs(a - b) <= 0.1 + 0.1 * std::min(a, b);
  }

  /// What it costs a sample to give its partner away: to its next candidate, or to none.
  double regret(size_t i) const {
    double other = kMissing;
    for (size_t s = 0; s < near_[i].size(); ++s) {
      if (s != chosen_[i]) other = std::min(other, far_cost(near_[i][s].distance_px));
    }
    return other - far_cost(partner(i)->distance_px);
  }

  /// Of samples that claim one place those that lose least by giving it away: as in an optimal assignment of two to two.
  std::vector<size_t> find_losers() const {
    std::vector<size_t> order;
    for (size_t i = 0; i < samples_.size(); ++i)
      if (partner(i) != nullptr) order.push_back(i);
    std::sort(order.begin(), order.end(), [&](size_t i, size_t j) {
      const MatchCandidate &a = *partner(i), &b = *partner(j);
      return a.curve != b.curve ? a.curve < b.curve : a.along_px != b.along_px ? a.along_px < b.along_px : i < j;
    });
    std::vector<size_t> losers;
    for (size_t k = 0; k < order.size(); ++k) {
      for (size_t l = k + 1; l < order.size(); ++l) {
        const MatchCandidate &a = *partner(order[k]), &b = *partner(order[l]);
        if (a.curve != b.curve || b.along_px - a.along_px >= kOnePlace_px) break;
        if (!may_share(order[k], order[l])) losers.push_back(regret(order[k]) >= regret(order[l]) ? order[l] : order[k]);
      }
    }
    std::sort(losers.begin(), losers.end());
    losers.erase(std::unique(losers.begin(), losers.end()), losers.end());
    return losers;
  }

  const BorderCurves& measured_;
  MatchCandidates candidates_;
  double reach_;
  std::vector<BorderSample> samples_{};
  std::vector<std::vector<MatchCandidate>> near_{};
  std::vector<Run> runs_{};
  std::vector<size_t> run_of_{}, chosen_{};
};

/// Sorted and merged.
void merge(std::vector<std::pair<double, double>>& stretches) {
  std::sort(stretches.begin(), stretches.end());
  size_t kept = 0;
  for (const auto& [from, to] : stretches) {
    if (kept > 0 && from <= stretches[kept - 1].second) {
      stretches[kept - 1].second = std::max(stretches[kept - 1].second, to);
    } else {
      stretches[kept++] = {from, to};
    }
  }
  stretches.resize(kept);
}

bool holds(const std::vector<std::pair<double, double>>& stretches, double along) {
  const auto after = std::upper_bound(stretches.begin(), stretches.end(), along, [](double s, const auto& one) { return s < one.first; });
  return after != stretches.begin() && along <= std::prev(after)->second;
}

std::vector<MeasuredSample> measured_samples(const Matcher& matcher, const BorderCurves& measured, std::optional<CurveKind> kind,
                                             const Camera& camera) {
  auto stretches = matcher.claimed();
  for (auto& of_curve : stretches) merge(of_curve);
  std::vector<MeasuredSample> result;
  double along = 0.0, round = 0.0;
  for (const BorderSample& sample : resample(measured, kind, kSpacing_px)) {
    const BorderCurve& curve = measured.curves[sample.curve];
    if (result.empty() || result.back().at.curve != sample.curve) {
      along = -0.5 * sample.weight_px;
      round = curve.closed ? length_px(curve) : 0.0;
    }
    along += sample.weight_px;
    const auto& of_curve = stretches[sample.curve];
    const bool matched = holds(of_curve, along) || (curve.closed && (holds(of_curve, along + round) || holds(of_curve, along - round)));
    result.push_back({sample, is_within_picture(sample.px, camera), matched});
  }
  return result;
}

}  // namespace

BorderMatch match_borders(const BorderCurves& truth, const BorderCurves& measured, std::optional<CurveKind> kind, const Camera& camera) {
  Matcher matcher(truth, measured, kind, camera);
  matcher.match();
  BorderMatch match;
  const std::vector<IllReason> ill = ill_places(truth, matcher.samples(), camera);
  for (size_t i = 0; i < matcher.samples().size(); ++i) {
    MatchedSample sample{matcher.samples()[i], is_within_picture(matcher.samples()[i].px, camera), {}, 0, 0.0, ill[i]};
    if (const MatchCandidate* partner = matcher.partner(i)) {
      sample.displacement_px = partner->displacement_px;
      sample.curve = partner->curve;
      sample.along_px = partner->along_px;
    }
    match.truth.push_back(sample);
  }
  match.measured = measured_samples(matcher, measured, kind, camera);
  return match;
}

}  // namespace limn
