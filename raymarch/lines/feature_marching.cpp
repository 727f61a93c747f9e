#include "raymarch/lines/feature_marching.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr int kMostSteps = 60;
constexpr double kSettled = 1e-9;                          // of the stretch that a root is looked for on
constexpr std::array<double, 3> kAcross{0.125, 0.5, 1.0};  // of a step's length: how far from its middle zeros are looked for

double turned(const FeatureValue& value, const glm::dvec3& along) {
  return glm::dot(value.along, along) < 0.0 ? -value.value : value.value;
}

/// The root of a function on [0, 1] with different signs at its ends: false position with halved ends (Dowell and Jarratt 1971), bisection
/// where that is slow, so that a jump is found as well.
template <class Function>
double root_of(const Function& f, double f0, double f1) {
  double low = 0.0, high = 1.0, width = 1.0, last = -1.0;
  int kept = 0;
  for (int i = 0; i < kMostSteps && high - low > kSettled; ++i) {
    double x = (low * f1 - high * f0) / (f1 - f0);
    if (i % 3 == 2) {
      if (high - low > 0.25 * width) x = 0.5 * (low + high);
      width = high - low;
    }
    if (!(x > low && x < high)) x = 0.5 * (low + high);
    const double fx = f(x);
    if (fx == 0.0 || !std::isfinite(fx) || std::fabs(x - last) < kSettled) return x;
    last = x;
    if ((fx < 0.0) == (f0 < 0.0)) {
      low = x;
      f0 = fx;
      if (kept == -1) f1 *= 0.5;
      kept = -1;
    } else {
      high = x;
      f1 = fx;
      if (kept == 1) f0 *= 0.5;
      kept = 1;
    }
  }
  return 0.5 * (low + high);
}

/// A triangle's edge; from its corner `from` to the next.
struct EdgeUse {
  std::uint32_t low = 0, high = 0, triangle = 0;
  int from = 0;
};

FeaturePlace place_on(const EdgeUse& use, bool from_low, double share) {
  FeaturePlace place{use.triangle, glm::dvec3(0.0)};
  place.weights[use.from] = from_low ? 1.0 - share : share;
  place.weights[(use.from + 1) % 3] = from_low ? share : 1.0 - share;
  return place;
}

class Marcher {
 public:
  Marcher(const FeatureSurface& surface, const FeatureFunction& function) : surface_(surface), function_(function) {}

  std::vector<FeatureChain> run(const ExecutionSettings& execution) {
    look_at_nodes();
    choose_triangles();
    if (execution.cancelled && execution.cancelled()) throw Cancelled{};
    group_edges();
    parallel_for(size_t{0}, first_use_.size(), [&](size_t e) { cross(e); });
    if (execution.cancelled && execution.cancelled()) throw Cancelled{};
    return chains();
  }

 private:
  void look_at_nodes() {
    const size_t count = surface_.nodes.size();
    std::vector<char> worth(count, 0), needed(count, 0);
    parallel_for(size_t{0}, count, [&](size_t i) { worth[i] = surface_.nodes[i].valid && function_.worth_a_look(surface_.nodes[i]); });
    for (const auto& t : surface_.triangles) {
      const bool any = worth[t[0]] || worth[t[1]] || worth[t[2]];
      const bool all = surface_.nodes[t[0]].valid && surface_.nodes[t[1]].valid && surface_.nodes[t[2]].valid;
      if (!any || !all) continue;
      for (const std::uint32_t node : t) needed[node] = 1;
    }
    values_.resize(count);
    looked_at_.assign(count, 0);
    parallel_for(size_t{0}, count, [&](size_t i) {
      if (!needed[i]) return;
      values_[i] = function_.value(surface_.nodes[i]);
      looked_at_[i] = !std::isfinite(values_[i].value) ? 0 : function_.is_rounding(surface_.nodes[i], values_[i]) ? 1 : 2;
    });
  }

  bool signs_differ(std::uint32_t a, std::uint32_t b) const {
    return (values_[a].value < 0.0) != (turned(values_[b], values_[a].along) < 0.0);
  }
  /// Directions agree all around, and the function is more than rounding somewhere.
  bool is_usable(const std::array<std::uint32_t, 3>& t) const {
    int level = 0, against = 0;
    for (size_t i = 0; i < 3; ++i) {
      if (looked_at_[t[i]] == 0) return false;
      level = std::max(level, static_cast<int>(looked_at_[t[i]]));
      against += glm::dot(values_[t[i]].along, values_[t[(i + 1) % 3]].along) < 0.0;
    }
    return level == 2 && against % 2 == 0;
  }
  void choose_triangles() {
    for (std::uint32_t t = 0; t < surface_.triangles.size(); ++t) {
      const auto& nodes = surface_.triangles[t];
      if (!is_usable(nodes)) continue;
      if (signs_differ(nodes[0], nodes[1]) || signs_differ(nodes[1], nodes[2]) || signs_differ(nodes[2], nodes[0])) crossed_.push_back(t);
    }
  }

  void group_edges() {
    for (const std::uint32_t t : crossed_) {
      for (int from = 0; from < 3; ++from) {
        const std::uint32_t a = surface_.triangles[t][static_cast<size_t>(from)],
                            b = surface_.triangles[t][static_cast<size_t>((from + 1) % 3)];
        if (signs_differ(std::min(a, b), std::max(a, b))) uses_.push_back({std::min(a, b), std::max(a, b), t, from});
      }
    }
    std::sort(uses_.begin(), uses_.end(), [](const EdgeUse& x, const EdgeUse& y) {
      return std::tie(x.low, x.high, x.triangle, x.from) < std::tie(y.low, y.high, y.triangle, y.from);
    });
    for (size_t i = 0; i < uses_.size(); ++i) {
      if (i == 0 || uses_[i].low != uses_[i - 1].low || uses_[i].high != uses_[i - 1].high) first_use_.push_back(i);
    }
    stations_.resize(first_use_.size());
  }
  size_t end_of(size_t edge) const { return edge + 1 < first_use_.size() ? first_use_[edge + 1] : uses_.size(); }
  bool runs_from_low(const EdgeUse& use) const { return surface_.triangles[use.triangle][static_cast<size_t>(use.from)] == use.low; }

  void cross(size_t edge) {
    const EdgeUse& use = uses_[first_use_[edge]];
    const FeatureValue &low = values_[use.low], high = values_[use.high];
    const auto at = [&](double share) { return place_on(use, runs_from_low(use), share); };
    const auto value = [&](double share) {
      const FeaturePoint point = surface_.at(at(share));
      return point.valid ? turned(function_.value(point), low.along) : std::numeric_limits<double>::quiet_NaN();
    };
    FeatureStation& station = stations_[edge];
    station.place = at(root_of(value, low.value, turned(high, low.along)));
    station.point = surface_.at(station.place);
    station.along = function_.value(station.point).along;
    if (glm::dot(station.along, low.along) < 0.0) station.along = -station.along;
  }

  /// Segments of triangles, from edge to edge.
  struct Segment {
    std::uint32_t triangle = 0;
    std::array<std::uint32_t, 2> edges{kNone, kNone};
    std::array<std::uint32_t, 2> uses{kNone, kNone};
  };

  std::vector<FeatureChain> chains() {
    std::vector<Segment> segments;
    std::vector<std::uint32_t> segment_of(surface_.triangles.size(), kNone);
    for (size_t e = 0; e < first_use_.size(); ++e) {
      for (size_t u = first_use_[e]; u < end_of(e); ++u) {
        std::uint32_t& number = segment_of[uses_[u].triangle];
        if (number == kNone) {
          number = static_cast<std::uint32_t>(segments.size());
          segments.push_back({uses_[u].triangle, {static_cast<std::uint32_t>(e), kNone}, {static_cast<std::uint32_t>(u), kNone}});
        } else {
          segments[number].edges[1] = static_cast<std::uint32_t>(e);
          segments[number].uses[1] = static_cast<std::uint32_t>(u);
        }
      }
    }
    const auto other = [&](std::uint32_t segment, int end) {
      const std::uint32_t e = segments[segment].edges[static_cast<size_t>(end)];
      if (end_of(e) - first_use_[e] != 2) return kNone;
      const std::uint32_t a = segment_of[uses_[first_use_[e]].triangle], b = segment_of[uses_[first_use_[e] + 1].triangle];
      return a == segment ? b : a;
    };
    std::vector<char> used(segments.size(), 0);
    std::vector<FeatureChain> chains;
    const auto walk = [&](std::uint32_t start, int from) {
      FeatureChain chain;
      for (std::uint32_t s = start; s != kNone && !used[s];) {
        used[s] = 1;
        const int to = 1 - from;
        chain.steps.push_back({station_of(segments[s], from), station_of(segments[s], to)});
        const std::uint32_t next = other(s, to), edge = segments[s].edges[static_cast<size_t>(to)];
        chain.closed = next == start && segments[start].edges[0] == edge;
        if (next != kNone) from = segments[next].edges[0] == edge ? 0 : 1;
        s = next;
      }
      chains.push_back(std::move(chain));
    };
    for (std::uint32_t s = 0; s < segments.size(); ++s) {
      for (int end = 0; end < 2 && !used[s]; ++end) {
        if (other(s, end) == kNone) walk(s, end);
      }
    }
    for (std::uint32_t s = 0; s < segments.size(); ++s) {
      if (!used[s]) walk(s, 0);
    }
    return chains;
  }

  FeatureStation station_of(const Segment& segment, int end) const {
    const EdgeUse& use = uses_[segment.uses[static_cast<size_t>(end)]];
    const EdgeUse& first = uses_[first_use_[segment.edges[static_cast<size_t>(end)]]];
    FeatureStation station = stations_[segment.edges[static_cast<size_t>(end)]];
    const int low_corner = runs_from_low(first) ? first.from : (first.from + 1) % 3;
    station.place = place_on(use, runs_from_low(use), 1.0 - station.place.weights[low_corner]);
    return station;
  }

  const FeatureSurface& surface_;
  const FeatureFunction& function_;
  std::vector<FeatureValue> values_{};
  std::vector<char> looked_at_{};  ///< 0: no value; 1: rounding; 2: a value.
  std::vector<std::uint32_t> crossed_{};
  std::vector<EdgeUse> uses_{};
  std::vector<size_t> first_use_{};  ///< Of each edge.
  std::vector<FeatureStation> stations_{};
};

}  // namespace

std::vector<FeatureChain> march_features(const FeatureSurface& surface, const FeatureFunction& function,
                                         const ExecutionSettings& execution) {
  return Marcher(surface, function).run(execution);
}

std::optional<FeatureStation> middle_of(const FeatureSurface& surface, const FeatureFunction& function, const FeatureStep& step) {
  const auto& nodes = surface.triangles[step.from.place.triangle];
  const glm::dvec3 &a = surface.nodes[nodes[0]].p, u = surface.nodes[nodes[1]].p - a, v = surface.nodes[nodes[2]].p - a;
  const glm::dvec3 facet = glm::cross(u, v), change = step.to.place.weights - step.from.place.weights;
  const double squared = glm::dot(facet, facet);
  if (!(squared > 0.0)) return {};
  // Across the step in the triangle's plane, as long as the step.
  const glm::dvec3 across = glm::cross(facet / std::sqrt(squared), change.y * u + change.z * v);
  const double y = glm::dot(glm::cross(across, v), facet) / squared, z = glm::dot(glm::cross(u, across), facet) / squared;
  const glm::dvec3 middle = 0.5 * (step.from.place.weights + step.to.place.weights), aside(-y - z, y, z);
  const auto at = [&](double x) { return FeaturePlace{step.from.place.triangle, middle + x * aside}; };
  const auto value = [&](double x) {
    const FeaturePoint point = surface.at(at(x));
    return point.valid ? turned(function.value(point), step.from.along) : std::numeric_limits<double>::quiet_NaN();
  };
  for (const double reach : kAcross) {
    const double before = value(-reach), after = value(reach);
    if (!std::isfinite(before) || !std::isfinite(after) || (before < 0.0) == (after < 0.0)) continue;
    FeatureStation station;
    station.place = at(reach * (2.0 * root_of([&](double x) { return value(reach * (2.0 * x - 1.0)); }, before, after) - 1.0));
    station.point = surface.at(station.place);
    if (!station.point.valid) return {};
    station.along = function.value(station.point).along;
    if (glm::dot(station.along, step.from.along) < 0.0) station.along = -station.along;
    return station;
  }
  return {};
}

}  // namespace limn
