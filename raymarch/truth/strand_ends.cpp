// Crossings to strands, and pieces of strands to curves.

#include <algorithm>
#include <cmath>

#include "raymarch/truth/strands.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
constexpr double kFarthestPx = 0.1;  // between ends that are taken for one place

class Assembly {
 public:
  explicit Assembly(const CellCurves& cells) : cells_(cells) {
    // Crossings are large: their places are sorted, and of those with one key the first stays.
    order_.resize(cells.crossings.size());
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = {cells.crossings[i].key, i};
    parallel_sort(order_.begin(), order_.end());
    order_.erase(std::unique(order_.begin(), order_.end(), [](const auto& a, const auto& b) { return a.first == b.first; }), order_.end());
    constexpr size_t kGrain = 2048;
    std::vector<std::array<std::uint32_t, 2>> ends(cells.links.size());
    parallel_parts(ends.size(), kGrain, [&](const IndexRange<size_t>& range) {
      for (size_t i = range.begin(); i < range.end(); ++i) ends[i] = {find(cells.links[i].from), find(cells.links[i].to)};
    });
    next_.assign(order_.size(), {kNone, kNone});
    for (const auto& [from, to] : ends) {
      attach(from, to);
      attach(to, from);
    }
  }

  std::vector<Strand> strands(const Strand& like) {
    std::vector<Strand> result;
    std::vector<bool> taken(order_.size(), false);
    std::vector<std::uint32_t> way;
    for (const bool ends_only : {true, false}) {
      for (std::uint32_t i = 0; i < order_.size(); ++i) {
        if (taken[i] || (ends_only && next_[i][1] != kNone)) continue;
        way.clear();
        std::uint32_t at = i, before = kNone;
        while (at != kNone && !taken[at]) {
          taken[at] = true;
          way.push_back(at);
          const std::uint32_t go = next_[at][0] == before ? next_[at][1] : next_[at][0];
          before = at;
          at = go;
        }
        if (way.size() == 1) continue;
        Strand& strand = result.emplace_back(like);
        strand.closed = !ends_only;
        strand.points.reserve(way.size());
        for (const std::uint32_t place : way) strand.points.push_back(cells_.crossings[order_[place].second].point);
      }
    }
    return result;
  }

 private:
  std::uint32_t find(std::uint64_t key) const {
    const auto at = std::lower_bound(order_.begin(), order_.end(), key, [](const auto& a, std::uint64_t k) { return a.first < k; });
    return static_cast<std::uint32_t>(at - order_.begin());
  }
  void attach(std::uint32_t from, std::uint32_t to) {
    auto& slots = next_[from];
    (slots[0] == kNone ? slots[0] : slots[1]) = to;
  }

  const CellCurves& cells_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order_{};  ///< Keys of crossings, rising, and their places among the cells'.
  std::vector<std::array<std::uint32_t, 2>> next_;
};

/// End 2 i is where piece i begins, 2 i + 1 where it ends.
const CurvePoint& end_point(const std::vector<FieldCurve>& pieces, std::uint32_t end) {
  const auto& points = pieces[end / 2].points;
  return end % 2 == 0 ? points.front() : points.back();
}

/// Which side of a piece has the higher N.V, to who walks away from its end seen from outside: 1 the left, -1 the right, 0 unknown.
int higher_side(const std::vector<FieldCurve>& pieces, std::uint32_t end) {
  const auto& points = pieces[end / 2].points;
  const CurvePoint& at = end_point(pieces, end);
  const CurvePoint& inner = end % 2 == 0 ? points[1] : points[points.size() - 2];
  const double side = glm::dot(at.uphill, glm::cross(at.high + at.low, inner.p - at.p));
  return side > 0.0 ? 1 : side < 0.0 ? -1 : 0;
}

/// Between an end that leads nowhere and the nearest other one, in the image: so much of a curve is missing there.
double widest_left(const std::vector<FieldCurve>& pieces, const std::vector<std::uint32_t>& partner, const Camera& camera) {
  std::vector<std::uint32_t> left;
  for (std::uint32_t end = 0; end < partner.size(); ++end) {
    if (partner[end] == kNone && !pieces[end / 2].closed) left.push_back(end);
  }
  double widest = 0.0;
  for (const std::uint32_t a : left) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::uint32_t b : left) {
      if (a == b || pieces[a / 2].c != pieces[b / 2].c) continue;
      const glm::dvec2 p(project(camera, end_point(pieces, a).p)), q(project(camera, end_point(pieces, b).p));
      nearest = std::min(nearest, glm::distance(p, q));
    }
    if (std::isfinite(nearest)) widest = std::max(widest, nearest);
  }
  return widest;
}

/// Of each end the one it goes on at, or none.
std::vector<std::uint32_t> partners_of(const std::vector<FieldCurve>& pieces, const Camera& camera, double& worst_gap_px) {
  struct Pair {
    bool turned;  ///< What is on the left of the one would be on the right of the other.
    double distance_px;
    std::uint32_t a, b;
  };
  std::vector<Pair> pairs;
  std::vector<std::uint32_t> partner(2 * pieces.size(), kNone);
  for (std::uint32_t a = 0; a < partner.size(); ++a) {
    if (pieces[a / 2].closed) continue;
    const glm::dvec3& p = end_point(pieces, a).p;
    const double scale = pixels_per_unit_at(camera, std::max(project(camera, p).z, 1e-9));
    for (std::uint32_t b = 0; b < a; ++b) {
      if (pieces[b / 2].closed || pieces[b / 2].c != pieces[a / 2].c) continue;
      const double distance_px = scale * glm::distance(p, end_point(pieces, b).p);
      if (distance_px >= kFarthestPx) continue;
      pairs.push_back({higher_side(pieces, a) * higher_side(pieces, b) > 0, distance_px, a, b});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& x, const Pair& y) { return x.turned != y.turned ? y.turned : x.distance_px < y.distance_px; });
  for (const Pair& pair : pairs) {
    if (partner[pair.a] != kNone || partner[pair.b] != kNone) continue;
    partner[pair.a] = pair.b;
    partner[pair.b] = pair.a;
    worst_gap_px = std::max(worst_gap_px, pair.distance_px);
  }
  worst_gap_px = std::max(worst_gap_px, widest_left(pieces, partner, camera));
  return partner;
}

}  // namespace

std::vector<Strand> assemble(const CellCurves& cells, int first, int second, double c) {
  return Assembly(cells).strands({first, second, c, false, {}});
}

std::vector<FieldCurve> join_ends(std::vector<FieldCurve> pieces, const Camera& camera, double& worst_gap_px) {
  const std::vector<std::uint32_t> partner = partners_of(pieces, camera, worst_gap_px);
  std::vector<FieldCurve> result;
  std::vector<bool> taken(pieces.size(), false);
  const auto walk = [&](std::uint32_t start) {
    FieldCurve curve{pieces[start / 2].c};
    std::uint32_t end = start;
    while (end != kNone && !taken[end / 2]) {
      taken[end / 2] = true;
      auto& points = pieces[end / 2].points;
      if (end % 2 == 1) std::reverse(points.begin(), points.end());
      curve.points.insert(curve.points.end(), points.begin(), points.end());
      end = partner[end ^ 1u];
    }
    curve.closed = end == start;
    result.push_back(std::move(curve));
  };
  for (std::uint32_t i = 0; i < pieces.size(); ++i) {
    if (!pieces[i].closed) continue;
    taken[i] = true;
    result.push_back(std::move(pieces[i]));
  }
  for (std::uint32_t end = 0; end < partner.size(); ++end) {
    if (!taken[end / 2] && partner[end] == kNone) walk(end);
  }
  for (std::uint32_t i = 0; i < pieces.size(); ++i) {
    if (!taken[i]) walk(2 * i);
  }
  return result;
}

}  // namespace limn
