#include "samples/plan/climb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sdf/error.h"

namespace limn {
namespace {

// What a lone measurement and theory promise together is missed by about this much; better one candidate too many than one that narrowly
// fails.
constexpr double kTrust = 1.3;
// Times of single runs differ by this much from one to the next.
constexpr double kTimeNoise = 1.25;
// The part of building that grows with resolution is at least this share of it.
constexpr double kLeastGrowing = 0.1;
// Orders outside are those of chance.
constexpr double kLowestOrder = 0.0, kHighestOrder = 4.0;

double size_of(const Climb& climb, int rung) { return climb.ladder->size_at(static_cast<size_t>(rung)); }

double theory_of(const Climb& climb, int rung) { return climb.theory_px[static_cast<size_t>(rung)]; }

/// error ~ size^order through two rungs; empty where one is infinite or nothing.
std::optional<double> order_between(const Climb& climb, const ClimbedRung& coarse, const ClimbedRung& fine) {
  if (!std::isfinite(coarse.error_px) || !(fine.error_px > 0.0) || !std::isfinite(fine.error_px)) return {};
  const double order = std::log(coarse.error_px / fine.error_px) / std::log(size_of(climb, coarse.rung) / size_of(climb, fine.rung));
  return std::clamp(order, kLowestOrder, kHighestOrder);
}

/// The order that the failing rungs show, from the coarsest to the finest that can be measured; where they grow worse: 0.
std::optional<double> failing_order(const Climb& climb, double tolerance_px) {
  const ClimbedRung *coarse = nullptr, *fine = nullptr;
  for (const ClimbedRung& rung : climb.climbed) {
    if (!std::isfinite(rung.error_px) || rung.error_px <= tolerance_px) continue;
    (coarse == nullptr ? coarse : fine) = &rung;
  }
  return fine == nullptr ? std::nullopt : order_between(climb, *coarse, *fine);
}

double by_order(const Climb& climb, const ClimbedRung& from, int rung, double order) {
  return from.error_px * std::pow(size_of(climb, rung) / size_of(climb, from.rung), order);
}

double by_theory(const Climb& climb, const ClimbedRung& from, int rung) {
  const double here = theory_of(climb, rung), there = theory_of(climb, from.rung);
  if (here > 0.0 && there > 0.0 && std::isfinite(here) && std::isfinite(there)) return from.error_px * here / there;
  return by_order(climb, from, rung, 1.0);  // of a crease
}

int failing_rung(const Climb& climb, double tolerance_px) {
  const ClimbedRung* fails = climb.finest_failing(tolerance_px);
  return fails == nullptr ? -1 : fails->rung;
}

int meeting_rung(const Climb& climb, double tolerance_px) {
  const ClimbedRung* meets = climb.coarsest_meeting(tolerance_px);
  return meets == nullptr ? climb.limit : meets->rung;
}

/// The finest rung of at least a size; the coarsest where none is.
int rung_of_size(const Climb& climb, double size) {
  int rung = 0;
  while (rung + 1 < climb.limit && size_of(climb, rung + 1) >= 0.99 * size) ++rung;
  return rung;
}

/// Not even the finest rung is expected to come near the tolerance.
bool shrinks_too_slowly(const Climb& climb, double tolerance_px) {
  return expected_error(climb, climb.limit - 1, tolerance_px) > 1.5 * tolerance_px;
}

std::string off_words(const ClimbedRung& rung) {
  return std::isfinite(rung.error_px) ? fmt::format("still {:.2g} px off", rung.error_px) : "still farther off than can be measured";
}

}  // namespace

void Climb::add(const ClimbedRung& rung) {
  climbed.insert(
      std::upper_bound(climbed.begin(), climbed.end(), rung, [](const ClimbedRung& a, const ClimbedRung& b) { return a.rung < b.rung; }),
      rung);
}

const ClimbedRung* Climb::coarsest_meeting(double tolerance_px) const {
  for (const ClimbedRung& rung : climbed) {
    if (rung.error_px <= tolerance_px) return &rung;
  }
  return nullptr;
}

const ClimbedRung* Climb::finest_failing(double tolerance_px) const {
  const ClimbedRung* found = nullptr;
  for (const ClimbedRung& rung : climbed) {
    if (rung.error_px <= tolerance_px) break;
    found = &rung;
  }
  return found;
}

bool Climb::settled(double tolerance_px) const {
  return closed || meeting_rung(*this, tolerance_px) - failing_rung(*this, tolerance_px) <= 1;
}

double expected_error(const Climb& climb, int rung, double tolerance_px) {
  const ClimbedRung *fails = climb.finest_failing(tolerance_px), *meets = climb.coarsest_meeting(tolerance_px);
  if (fails != nullptr && !std::isfinite(fails->error_px)) fails = nullptr;
  if (fails != nullptr && meets != nullptr) {
    if (const auto order = order_between(climb, *fails, *meets)) return by_order(climb, *fails, rung, *order);
  }
  if (meets != nullptr) return by_theory(climb, *meets, rung);
  if (fails == nullptr) return theory_of(climb, rung);
  if (const auto order = failing_order(climb, tolerance_px)) return by_order(climb, *fails, rung, *order);
  return kTrust * by_theory(climb, *fails, rung);
}

double expected_ms(const Climb& climb, int rung) {
  const ClimbedRung* nearest = nullptr;
  for (const ClimbedRung& known : climb.climbed) {
    if (nearest == nullptr || std::abs(known.rung - rung) < std::abs(nearest->rung - rung)) nearest = &known;
  }
  const double from = size_of(climb, nearest == nullptr ? 0 : nearest->rung);
  const double growth = std::pow(from / size_of(climb, rung), climb.ladder->growth);
  const double build_ms = nearest == nullptr ? climb.guess_ms : nearest->build_ms;
  // Times of single runs: what is left of one may be no more than their noise.
  const double growing_ms = std::max(build_ms - climb.ladder->fixed_ms, kLeastGrowing * build_ms);
  // A picture of a mesh passes all triangles in view: one level finer it took 1.9 to 3.8 times as long in nine scenes, 3.3 in the median.
  // Of few triangles the pixels take most of the time.
  const double trace_growth = climb.ladder->by_level ? std::max(1.0, std::pow(growth, 0.75)) : 1.0;
  const double trace_ms = nearest == nullptr ? 0.0 : nearest->trace_ms * trace_growth;
  return build_ms - growing_ms + growing_ms * growth + trace_ms;
}

int next_rung(const Climb& climb, double tolerance_px) {
  LIMN_CHECK(!climb.settled(tolerance_px));
  const int fails = failing_rung(climb, tolerance_px), meets = meeting_rung(climb, tolerance_px);
  int farthest = meets - 1;
  if (fails >= 0) {
    // A factor of two in size beyond a lone measurement, four where an order was seen: too far up costs more than once too often. But
    // where that order leads nowhere, two more are enough to be sure of it.
    const double reach = failing_order(climb, tolerance_px) && !shrinks_too_slowly(climb, tolerance_px) ? 0.24 : 0.49;
    while (farthest > fails + 1 && size_of(climb, farthest) < reach * size_of(climb, fails)) --farthest;
  } else if (meets == climb.limit) {
    farthest = std::min(farthest, (static_cast<int>(climb.ladder->rungs.size()) - 1) / 2);
  }
  for (int rung = fails + 1; rung < farthest; ++rung) {
    if (expected_error(climb, rung, tolerance_px) <= tolerance_px) return rung;
  }
  return farthest;
}

std::string reason_to_stop(const Climb& climb, double tolerance_px, std::optional<double> best_ms) {
  if (climb.climbed.empty()) {
    // Theory may ask for edges four times too short, and a guess of the time be wrong by as much.
    const int least = rung_of_size(climb, 4.0 * size_of(climb, next_rung(climb, tolerance_px)));
    return best_ms && expected_ms(climb, least) > 4.0 * *best_ms ? "what theory asks for is far slower than what meets the tolerance" : "";
  }
  // Where a start takes nearly all of the time, no other tolerance makes a local mesh faster by more than times of single runs differ.
  if (best_ms && climb.ladder->local && kTimeNoise * climb.ladder->fixed_ms > *best_ms)
    return "its coarse mesh alone takes about as long as what meets the tolerance";
  const ClimbedRung* fails = climb.finest_failing(tolerance_px);
  const std::string off = fails == nullptr ? "" : fmt::format(" ({})", off_words(*fails));
  // Nothing that is left can be cheaper than the next above what fails.
  if (best_ms && expected_ms(climb, failing_rung(climb, tolerance_px) + 1) > kTimeNoise * *best_ms)
    return "anything finer is slower than what meets the tolerance" + off;
  const std::optional<double> order = failing_order(climb, tolerance_px);
  if (climb.coarsest_meeting(tolerance_px) != nullptr || !order) return {};
  // Two neighbouring rungs may differ by chance: an order is believed once three rungs span a factor of two in size.
  const double spanned = size_of(climb, climb.climbed.front().rung) / size_of(climb, fails->rung);
  if (climb.climbed.size() >= 3 && spanned > 1.9 && shrinks_too_slowly(climb, tolerance_px))
    return *order < 0.05
               ? fmt::format("its error, {:.2g} px, does not shrink", fails->error_px)
               : fmt::format("its error, {:.2g} px, shrinks too slowly (with the power {:.1f} of the size)", fails->error_px, *order);
  const int next = next_rung(climb, tolerance_px);
  // Where even that is not expected to meet the tolerance, what does is finer and costs more.
  const double patience = expected_error(climb, next, tolerance_px) > tolerance_px ? kTimeNoise : 2.0 * kTimeNoise;
  if (best_ms && expected_ms(climb, next) > patience * *best_ms)
    return "what would meet the tolerance is expected to be slower than what does" + off;
  return {};
}

}  // namespace limn
