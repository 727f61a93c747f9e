#include "raymarch/measured_border/chain.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

/// A crossing on a cell's rim: how far clockwise from the top left corner, in px, and whether its curve enters the cell there.
struct RimCrossing {
  size_t crossing = 0;
  double along = 0.0;
  bool enters = false;
};

/// A cell whose two ways to join four crossings are equally good until the ray through its middle is known.
struct OpenCell {
  std::vector<RimCrossing> rim;
};

class Chainer {
 public:
  Chainer(const SceneModel& model, const Camera& camera, const GBuffer& gbuffer, double threshold,
          const std::vector<BorderCrossing>& crossings)
      : model_(model), camera_(camera), gbuffer_(gbuffer), threshold_(threshold), crossings_(crossings) {
    next_.assign(crossings.size(), kNone);
    previous_.assign(crossings.size(), kNone);
  }

  std::int64_t join() {
    for (const glm::ivec2& cell : crossed_cells()) join_cell(cell.x, cell.y);
    return decide_open_cells();
  }

  ChainedCurves curves() const {
    ChainedCurves result;
    std::vector<bool> used(crossings_.size(), false);
    // Open ones from their beginnings; what is left runs in circles.
    for (const bool open : {true, false}) {
      for (size_t start = 0; start < crossings_.size(); ++start) {
        if (used[start] || (open && previous_[start] != kNone)) continue;
        BorderCurve curve{crossings_[start].kind, crossings_[start].object, !open, {}};
        std::vector<double> other_depths;
        for (size_t i = start; i != kNone && !used[i]; i = next_[i]) {
          used[i] = true;
          curve.points.push_back(point_of(crossings_[i]));
          other_depths.push_back(crossings_[i].other_depth);
        }
        if (curve.points.size() < 2) continue;
        result.border.curves.push_back(std::move(curve));
        result.other_depths.push_back(std::move(other_depths));
      }
    }
    return result;
  }

 private:
  static constexpr size_t kNone = static_cast<size_t>(-1);

  /// Those with a crossing on their rims, row by row: few of a picture's.
  std::vector<glm::ivec2> crossed_cells() const {
    const std::int64_t width = gbuffer_.width, height = gbuffer_.height;
    std::vector<std::int64_t> cells;
    for (const BorderCrossing& crossing : crossings_) {
      const std::int64_t pixel = crossing.grid_edge / 2, x = pixel % width, y = pixel / width;
      // On either side of the edge, where the picture has not ended.
      const bool down = crossing.grid_edge % 2 == 1;
      const std::int64_t before = pixel - (down ? 1 : width);
      if (down ? x > 0 : y > 0) cells.push_back(before);
      if (x + 1 < width && y + 1 < height) cells.push_back(pixel);
    }
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    std::vector<glm::ivec2> places;
    places.reserve(cells.size());
    for (const std::int64_t cell : cells) places.emplace_back(static_cast<int>(cell % width), static_cast<int>(cell / width));
    return places;
  }

  BorderPoint point_of(const BorderCrossing& crossing) const {
    const auto pixel = static_cast<size_t>(crossing.grid_edge / 2);
    const auto width = static_cast<size_t>(gbuffer_.width);
    const size_t column = pixel % width, row = pixel / width;
    const glm::dvec2 start(static_cast<double>(column) + gbuffer_.sample.x, static_cast<double>(row) + gbuffer_.sample.y);
    BorderPoint point;
    point.px = start + crossing.t * (crossing.grid_edge % 2 ? glm::dvec2(0.0, 1.0) : glm::dvec2(1.0, 0.0));
    point.depth = crossing.depth;
    return point;
  }

  void add_rim(int x, int y, bool down, int side, CurveKind kind, std::vector<RimCrossing>& rim) const {
    const auto edge = static_cast<std::int64_t>(2 * gbuffer_.id.index(x, y) + (down ? 1 : 0));
    const auto first = std::lower_bound(crossings_.begin(), crossings_.end(), edge,
                                        [](const BorderCrossing& crossing, std::int64_t of) { return crossing.grid_edge < of; });
    for (size_t i = static_cast<size_t>(first - crossings_.begin()); i < crossings_.size() && crossings_[i].grid_edge == edge; ++i) {
      const BorderCrossing& crossing = crossings_[i];
      if (crossing.kind != kind) continue;
      // Clockwise, the top and the right side run with their grid edge, the others against it. A curve that enters has what it bounds,
      // its left, clockwise after it.
      const bool with = side < 2;
      rim.push_back({i, side + (with ? crossing.t : 1.0 - crossing.t), with != crossing.bounded_first});
    }
  }

  void join_cell(int x, int y) {
    for (const CurveKind kind : {CurveKind::silhouette, CurveKind::inner}) {
      rim_.clear();
      add_rim(x, y, false, 0, kind, rim_);
      add_rim(x + 1, y, true, 1, kind, rim_);
      add_rim(x, y + 1, false, 2, kind, rim_);
      add_rim(x, y, true, 3, kind, rim_);
      if (rim_.size() < 2) continue;
      std::sort(rim_.begin(), rim_.end(), [](const RimCrossing& a, const RimCrossing& b) { return a.along < b.along; });
      join_rim(x, y);
    }
  }

  double cost(size_t from, size_t to) const {
    const BorderCrossing &a = crossings_[from], &b = crossings_[to];
    if (a.object != b.object) return kForbidden;
    return std::abs(a.depth - b.depth) * pixels_per_unit_at(camera_, std::min(a.depth, b.depth));
  }

  bool ambiguous(const std::vector<RimCrossing>& rim) const {
    if (rim.size() != 4) return false;
    for (size_t i = 0; i < 4; ++i) {
      if (rim[i].enters == rim[(i + 1) % 4].enters) return false;
    }
    const double one = cost(rim[0].crossing, rim[1].crossing) + cost(rim[2].crossing, rim[3].crossing);
    const double other = cost(rim[1].crossing, rim[2].crossing) + cost(rim[3].crossing, rim[0].crossing);
    return one < kForbidden && other < kForbidden && std::abs(one - other) < 2.0 + 0.5 * std::max(one, other);
  }

  void join_rim(int x, int y) {
    if (ambiguous(rim_)) {
      open_.push_back({rim_});
      middles_.emplace_back(x + gbuffer_.sample.x + 0.5, y + gbuffer_.sample.y + 0.5);
      return;
    }
    // The cheapest pair first: with three crossings or more, sheets at different depths share the cell.
    for (;;) {
      double best = kForbidden;
      size_t from = kNone, to = kNone;
      for (const RimCrossing& in : rim_) {
        if (!in.enters || next_[in.crossing] != kNone) continue;
        for (const RimCrossing& out : rim_) {
          if (out.enters || previous_[out.crossing] != kNone) continue;
          const double candidate = cost(in.crossing, out.crossing);
          if (candidate < best) best = candidate, from = in.crossing, to = out.crossing;
        }
      }
      if (from == kNone) return;
      next_[from] = to;
      previous_[to] = from;
    }
  }

  bool bounded(const BorderCrossing& crossing, const PointSample& sample) const {
    if (sample.status != HitStatus::hit) return false;
    if (crossing.kind == CurveKind::inner) return double{sample.n_dot_v} < threshold_;
    const double depth = -glm::dot(sample.position - camera_.eye, camera_.world_from_camera[2]);
    return std::abs(depth - crossing.depth) < std::abs(depth - crossing.other_depth);
  }

  std::int64_t decide_open_cells() {
    std::vector<PointSample> samples(middles_.size());
    sample_points(model_, camera_, middles_, samples, PointRays::in_packets);
    for (size_t k = 0; k < open_.size(); ++k) {
      const std::vector<RimCrossing>& rim = open_[k].rim;
      const bool inside = bounded(crossings_[rim[0].crossing], samples[k]);
      for (size_t i = 0; i < 4; ++i) {
        if (!rim[i].enters) continue;
        // What is bounded lies clockwise after the entry; a bounded middle leaves the corners that are not cut off.
        const size_t to = rim[(i + (inside ? 3 : 1)) % 4].crossing;
        next_[rim[i].crossing] = to;
        previous_[to] = rim[i].crossing;
      }
    }
    return static_cast<std::int64_t>(middles_.size());
  }

  static constexpr double kForbidden = 1e100;
  const SceneModel& model_;
  const Camera& camera_;
  const GBuffer& gbuffer_;
  double threshold_;
  const std::vector<BorderCrossing>& crossings_;
  std::vector<size_t> next_{}, previous_{};
  std::vector<RimCrossing> rim_{};
  std::vector<OpenCell> open_{};
  std::vector<glm::dvec2> middles_{};
};

}  // namespace

ChainedCurves chain_crossings(const SceneModel& model, const Camera& camera, const GBuffer& gbuffer, double threshold,
                              const std::vector<BorderCrossing>& crossings, std::int64_t& rays) {
  Chainer chainer(model, camera, gbuffer, threshold, crossings);
  rays += chainer.join();
  return chainer.curves();
}

}  // namespace limn
