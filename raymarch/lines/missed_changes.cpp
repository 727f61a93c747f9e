#include "raymarch/lines/missed_changes.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr double kPlace_px = 1e-3;  // to which the place is found

/// The place so far along the curve from another.
double place_at(const CurveWalk& walk, double from, double to, double share) {
  const double wanted = glm::mix(walk.length_to(from), walk.length_to(to), share);
  double low = from, high = to;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (walk.length_to(middle) < wanted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

std::optional<MissedChange> find_missed(const ChangeSearch& search, double from, double to) {
  LayersSeen before = search.unexplained(from), after = search.unexplained(to);
  double low = from, high = to;
  while (search.walk.length_to(high) - search.walk.length_to(low) > kPlace_px) {
    double middle = place_at(search.walk, low, high, 0.5);
    if (!(middle > low && middle < high)) break;
    LayersSeen here = search.unexplained(middle);
    // A lone ray that agrees with neither side, as between lines that lie on each other, says nothing where rays beside it do.
    for (const double share : {0.4, 0.6, 0.3, 0.7}) {
      if (here.count == before.count || here.count == after.count) break;
      const double beside = place_at(search.walk, low, high, share);
      const LayersSeen seen = search.unexplained(beside);
      if (seen.count == before.count || seen.count == after.count) middle = beside, here = seen;
    }
    if (here.count == before.count) {
      low = middle;
    } else {
      high = middle;
      after = here;
    }
  }
  const int layers = after.count - before.count;
  if (layers == 0) return {};
  MissedChange found{0.5 * (low + high), layers, false, layers > 0 ? high : low};
  // On the side with more layers the sheet that the line goes through comes in from in front: twice as far along the line it is twice as
  // far along the ray.
  const double total = search.walk.length_to(to) - search.walk.length_to(from),
               here = search.walk.length_to(low) - search.walk.length_to(from);
  const double room = layers > 0 ? total - here : here;
  if (!(room > 0.0)) return found;
  const auto at = [&](double px) {
    const double share = layers > 0 ? (here + px) / total : (here - px) / total;
    const double place = place_at(search.walk, from, to, std::clamp(share, 0.0, 1.0));
    return search.unexplained(place).nearest * search.unit_px(place);
  };
  // Rays start off the surface by something: where that hides it the sheet is looked for farther on.
  for (const double most : {0.25, 1.0, 3.0}) {
    const double step = std::min(most, 0.5 * room);
    const double near = at(0.25 * step), far = at(step);
    found.piercing = near < 0.6 * far;
    if (found.piercing || step < most) break;
  }
  return found;
}

}  // namespace limn
