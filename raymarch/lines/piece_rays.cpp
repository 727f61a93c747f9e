#include "raymarch/lines/piece_rays.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr double kClear_px = 0.3, kLeastClear_px = 0.12;
constexpr double kExactShare = 0.01;  // of these beside straight edges, whose rays start on them

}  // namespace

PieceRays::PieceRays(const SurfaceCurve& of, std::uint32_t its_number, const CurveWalk& its_walk, const Camera& seen_from,
                     const NearerFolds& nearer_folds, const std::vector<CurveEvent>& its_events)
    : curve(of),
      number(its_number),
      walk(its_walk),
      camera(seen_from),
      folds(nearer_folds),
      events(its_events),
      clear_px(kClear_px * (of.straight ? kExactShare : 1.0)),
      least_clear_px(kLeastClear_px * (of.straight ? kExactShare : 1.0)) {}

double PieceRays::ray_at(const CurvePiece& piece, double share) const {
  const double begin = walk.length_to(piece.from), wanted = begin + share * piece.length_px,
               room = std::min(kNearEnd_px, 0.2 * piece.length_px);
  double from = std::floor(piece.from) + (curve.straight ? 0.5 : 1.0);
  if (from <= piece.from) from += 1.0;
  const auto place_of = [&](std::ptrdiff_t k) { return from + static_cast<double>(k); };
  const auto length_at = [&](std::ptrdiff_t k) { return walk.length_to(place_of(k)); };
  // Lengths rise along the piece: the first sample of those from `low` to `high` for which something holds from there on.
  const auto first_with = [](std::ptrdiff_t low, std::ptrdiff_t high, const auto& holds) {
    while (low < high) {
      const std::ptrdiff_t middle = low + (high - low) / 2;
      if (holds(middle))
        high = middle;
      else
        low = middle + 1;
    }
    return low;
  };
  const auto count = static_cast<std::ptrdiff_t>(std::max(0.0, std::ceil(piece.to - from)));
  const std::ptrdiff_t first = first_with(0, count, [&](std::ptrdiff_t k) { return length_at(k) - begin >= room; }),
                       end = first_with(first, count, [&](std::ptrdiff_t k) { return begin + piece.length_px - length_at(k) < room; });
  if (first == end) return glm::mix(piece.from, piece.to, share);
  const std::ptrdiff_t after = first_with(first, end, [&](std::ptrdiff_t k) { return length_at(k) >= wanted; });
  if (after == first) return place_of(first);
  const double before = length_at(after - 1);
  if (after < end && length_at(after) - wanted < wanted - before) return place_of(after);
  // The first of those as far along.
  return place_of(first_with(first, after, [&](std::ptrdiff_t k) { return length_at(k) >= before; }));
}

std::optional<double> PieceRays::telling_ray_at(const CurvePiece& piece, double share) const {
  if (const auto clear = clear_ray_at(piece, share)) return clear;
  const double place = ray_at(piece, share), here = walk.length_to(place);
  const bool tells =
      here >= walk.length_to(piece.from) + unclear_at(piece.begin) && here <= walk.length_to(piece.to) - unclear_at(piece.end);
  return tells ? std::optional<double>(place) : std::nullopt;
}

bool PieceRays::told_by_lines(const CurvePiece& piece) const {
  if (piece.begin < 0 || piece.end < 0) return false;
  const CurveEvent &begin = events[static_cast<size_t>(piece.begin)], &end = events[static_cast<size_t>(piece.end)];
  if (begin.kind != VertexKind::crossing || end.kind != VertexKind::crossing || begin.nearer != end.nearer) return false;
  double most = 0.0;
  for (const double share : {0.5, 0.38, 0.62, 0.26, 0.74}) {
    if (clear_ray_at(piece, share)) return false;
    const double place = ray_at(piece, share);
    const CurveSample sample = sample_at(curve, place, camera);
    const auto nearer = folds.nearest(sample, number, place, clear_px);
    if (!nearer || nearer->curve != begin.nearer) return false;
    most = std::max(most, folds.clearance_px(sample, number, place, clear_px));
  }
  return most > 2.0 * curve.apart_px;
}

double PieceRays::unclear_at(int event) const { return event < 0 ? 0.0 : events[static_cast<size_t>(event)].unclear_px; }

std::optional<double> PieceRays::clear_ray_at(const CurvePiece& piece, double share) const {
  double best = 0.0, most = least_clear_px;
  const double begin = walk.length_to(piece.from) + unclear_at(piece.begin), end = walk.length_to(piece.to) - unclear_at(piece.end);
  for (const double off : {0.0, 0.12, -0.12, 0.24, -0.24, 0.36, -0.36, 0.45, -0.45}) {
    if (!(share + off > 0.0 && share + off < 1.0)) continue;
    const double place = ray_at(piece, share + off);
    if (const double here = walk.length_to(place); here < begin || here > end) continue;
    const double clear = folds.clearance_px(sample_at(curve, place, camera), number, place, clear_px, most);
    if (clear >= clear_px) return place;
    if (clear > most) best = place, most = clear;
  }
  return most > least_clear_px ? std::optional<double>(best) : std::nullopt;
}

}  // namespace limn
