#include "raymarch/measured_border/join_necks.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "raymarch/curves/segment_grid.h"

namespace limn {
namespace {

constexpr size_t kNone = static_cast<size_t>(-1);
/// Between the middles of two chords that may be joined; what is thinner than a pixel crosses the grid's lines more often.
constexpr double kFarthest_px = 3.0;
/// A chord across a band turns at both ends by so much together, radians; rays decide.
constexpr double kLeastTurn = 0.7;
/// Between two chords a ray this often.
constexpr double kSpacing_px = 0.1;
/// A chord cuts something off where a ray so far beside it sees on what it bounds.
constexpr double kBeside_px = 0.05;
/// From the one chord to the other depth may change by so much, px for each px.
constexpr double kSteepest = 10.0;

/// A point of a curve with its neighbours, whatever curve they are in.
struct Node {
  BorderPoint point{};
  double other_depth = 0.0;
  size_t curve = 0;
  size_t next = kNone, previous = kNone;
};

/// A chord that may cut a band off, from a node to its next.
struct Cap {
  size_t from = 0, to = 0;
  glm::dvec2 middle{0.0}, outward{0.0};
  double length_px = 0.0;
};

struct Pair {
  size_t one = 0, other = 0;
  double distance_px = 0.0;
  bool bounded = true;  ///< The chords cut off a band of what the curves bound; else a gap in it.
};

class NeckJoiner {
 public:
  NeckJoiner(const SceneModel& model, const Camera& camera, double threshold, const ChainedCurves& chains)
      : model_(model), camera_(camera), threshold_(threshold), chains_(chains) {
    for (size_t c = 0; c < chains.border.curves.size(); ++c) {
      const BorderCurve& curve = chains.border.curves[c];
      const size_t first = nodes_.size(), count = curve.points.size();
      for (size_t i = 0; i < count; ++i) {
        nodes_.push_back({curve.points[i], chains.other_depths[c][i], c, first + i + 1, first + i - 1});
      }
      nodes_[first].previous = curve.closed ? nodes_.size() - 1 : kNone;
      nodes_.back().next = curve.closed ? first : kNone;
    }
  }

  void join() {
    find_caps();
    for (const Pair& pair : pairs()) {
      Cap &one = caps_[pair.one], &other = caps_[pair.other];
      const bool free = nodes_[one.from].next == one.to && nodes_[other.from].next == other.to;
      if (!free || !all_alike(one, other, pair.bounded)) continue;
      link(one.from, other.to);
      link(other.from, one.to);
    }
  }

  /// Open ones from their beginnings, then closed ones, each kind in the order of their first nodes.
  ChainedCurves curves() const {
    ChainedCurves result;
    std::vector<bool> used(nodes_.size(), false);
    for (const bool open : {true, false}) {
      for (size_t start = 0; start < nodes_.size(); ++start) {
        if (used[start] || (open && nodes_[start].previous != kNone)) continue;
        const BorderCurve& of = curve_of(start);
        BorderCurve curve{of.kind, of.object, !open, {}};
        std::vector<double> other_depths;
        for (size_t i = start; i != kNone && !used[i]; i = nodes_[i].next) {
          used[i] = true;
          curve.points.push_back(nodes_[i].point);
          other_depths.push_back(nodes_[i].other_depth);
        }
        if (curve.points.size() < (curve.closed ? 3u : 2u)) continue;
        result.border.curves.push_back(std::move(curve));
        result.other_depths.push_back(std::move(other_depths));
      }
    }
    return result;
  }

  std::int64_t rays = 0;

 private:
  const BorderCurve& curve_of(size_t node) const { return chains_.border.curves[nodes_[node].curve]; }
  glm::dvec2 step(size_t from) const { return nodes_[nodes_[from].next].point.px - nodes_[from].point.px; }

  void link(size_t from, size_t to) {
    nodes_[from].next = to;
    nodes_[to].previous = from;
  }

  static double turn(const glm::dvec2& a, const glm::dvec2& b) { return std::abs(std::atan2(a.x * b.y - a.y * b.x, glm::dot(a, b))); }

  void find_caps() {
    for (size_t i = 0; i < nodes_.size(); ++i) {
      const Node& node = nodes_[i];
      if (node.next == kNone || node.previous == kNone || nodes_[node.next].next == kNone) continue;
      const glm::dvec2 along = step(i);
      const double length = glm::length(along);
      if (!(length > 0.0) || turn(step(node.previous), along) + turn(along, step(node.next)) < kLeastTurn) continue;
      caps_.push_back({i, node.next, 0.5 * (node.point.px + nodes_[node.next].point.px), glm::dvec2(-along.y, along.x) / length, length});
    }
  }

  /// Caps of one object and kind that look at each other, the nearest pair first.
  std::vector<Pair> pairs() const {
    std::vector<SegmentEnds> ends;
    ends.reserve(caps_.size());
    for (const Cap& cap : caps_) ends.push_back({cap.middle, cap.middle});
    const SegmentGrid grid = segment_grid(ends);
    std::vector<Pair> result;
    for (size_t i = 0; i < caps_.size(); ++i) {
      const glm::dvec2 at = caps_[i].middle;
      for (int row = grid.row_of(at.y - kFarthest_px); row <= grid.row_of(at.y + kFarthest_px); ++row) {
        for (int column = grid.column_of(at.x - kFarthest_px); column <= grid.column_of(at.x + kFarthest_px); ++column) {
          for (const std::uint32_t k : grid.in_cell(column, row))
            if (k > i && may_join(caps_[i], caps_[k]))
              result.push_back({i, k, glm::distance(at, caps_[k].middle), is_ahead(caps_[i], caps_[k])});
        }
      }
    }
    std::sort(result.begin(), result.end(), [](const Pair& a, const Pair& b) {
      return std::tie(a.distance_px, a.one, a.other) < std::tie(b.distance_px, b.one, b.other);
    });
    return result;
  }

  static bool is_ahead(const Cap& one, const Cap& other) { return glm::dot(other.middle - one.middle, one.outward) > 0.0; }

  /// Each lies before the other, or each behind the other.
  bool may_join(const Cap& one, const Cap& other) const {
    const BorderCurve &a = curve_of(one.from), &b = curve_of(other.from);
    if (a.kind != b.kind || a.object != b.object || one.from == other.to || other.from == one.to) return false;
    const double distance = glm::distance(one.middle, other.middle);
    if (distance > kFarthest_px || is_ahead(one, other) != is_ahead(other, one)) return false;
    const double step = std::abs(depth_of(one) - depth_of(other)) * pixels_per_unit_at(camera_, std::min(depth_of(one), depth_of(other)));
    return step <= 1.0 + kSteepest * distance;
  }

  double depth_of(const Cap& cap) const { return 0.5 * (nodes_[cap.from].point.depth + nodes_[cap.to].point.depth); }
  double other_depth_of(const Cap& cap) const { return 0.5 * (nodes_[cap.from].other_depth + nodes_[cap.to].other_depth); }

  /// Rays from middle to middle, and one right beside each: a chord that runs along the border has its sides as they should be.
  bool all_alike(const Cap& one, const Cap& other, bool bounded) {
    const auto count = static_cast<size_t>(std::ceil(glm::distance(one.middle, other.middle) / kSpacing_px)) + 1;
    const double beside_px = bounded ? kBeside_px : -kBeside_px;
    std::vector<glm::dvec2> points{one.middle + beside_px * one.outward, other.middle + beside_px * other.outward};
    std::vector<double> shares{0.0, 1.0};
    for (size_t k = 0; k < count; ++k) {
      shares.push_back((static_cast<double>(k) + 0.5) / static_cast<double>(count));
      points.push_back(glm::mix(one.middle, other.middle, shares.back()));
    }
    std::vector<PointSample> samples(points.size());
    sample_points(model_, camera_, points, samples, PointRays::in_packets);
    rays += static_cast<std::int64_t>(points.size());
    for (size_t k = 0; k < points.size(); ++k)
      if (!is_like(samples[k], one, other, shares[k], bounded)) return false;
    return true;
  }

  /// Whether a point on the way from the one chord to the other is bounded, or not, as asked; of an inner border on the same sheet.
  bool is_like(const PointSample& sample, const Cap& one, const Cap& other, double share, bool bounded) const {
    const BorderCurve& curve = curve_of(one.from);
    const bool hit = sample.status == HitStatus::hit, inner = curve.kind == CurveKind::inner;
    if (!hit) return !bounded && !inner;
    const double depth = -glm::dot(sample.position - camera_.eye, camera_.world_from_camera[2]);
    const double own = glm::mix(depth_of(one), depth_of(other), share), beyond = std::min(other_depth_of(one), other_depth_of(other));
    const bool on_sheet = std::abs(depth - own) * pixels_per_unit_at(camera_, own) <= 1.0 + kSteepest * kFarthest_px;
    if (inner) return on_sheet && sample.id == curve.object && (double{sample.n_dot_v} < threshold_) == bounded;
    const bool nearer = on_sheet && sample.id == curve.object && std::abs(depth - own) < std::abs(depth - beyond);
    return nearer == bounded;
  }

  const SceneModel& model_;
  const Camera& camera_;
  double threshold_;
  const ChainedCurves& chains_;
  std::vector<Node> nodes_{};
  std::vector<Cap> caps_{};
};

}  // namespace

ChainedCurves join_necks(const SceneModel& model, const Camera& camera, double threshold, const ChainedCurves& chains, std::int64_t& rays) {
  NeckJoiner joiner(model, camera, threshold, chains);
  joiner.join();
  rays += joiner.rays;
  return joiner.curves();
}

}  // namespace limn
