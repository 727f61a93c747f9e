#include "raymarch/measured_border/crossings.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "raymarch/gbuffer/picture_rows.h"
#include "raymarch/measured_border/edge_node.h"
#include "raymarch/scene/threads.h"
#include "sdf/error.h"

namespace limn {
namespace {

/// A jump must persist while its bracket shrinks by this much more: a continuous sheet's step would shrink as much, a contour's by its
/// root.
constexpr double kProof = 16.0;
/// Sheets that may end between two neighbouring centres.
constexpr int kMostEnds = 4;
/// Secant steps before bisection takes over.
constexpr int kSecants = 4;

enum class Mode { jump, proof, ink };

/// A stretch of one grid edge that is being narrowed down.
struct Search {
  std::int64_t edge = 0;
  EdgeLine line{};
  EdgeNode first{}, last{};  ///< The stretch.
  EdgeNode a{}, b{};         ///< The bracket.
  Mode mode = Mode::jump;
  int ends = 0;   ///< Ends of sheets found on this edge before.
  int steps = 0;  ///< Rays spent in this mode.
  bool settled = false;
  bool end_before = false, end_after = false;  ///< The stretch begins, ends at an end of a sheet.
  int moved = 0;                               ///< Ink: which end the last ray replaced: -1 a, +1 b, 0 none.
  double step_before = 0.0;                    ///< Proof: the step of depth when it began, px.
};

/// All searches of one band of the picture, in lockstep, so that rays go out in batches.
class Band {
 public:
  Band(const SceneModel& model, const Camera& camera, const GBuffer& gbuffer, const MeasuredBorderSettings& settings)
      : model_(model), camera_(camera), gbuffer_(gbuffer), settings_(settings) {}

  void scan(int y0, int y1) {
    std::vector<double> row = rays_of_row(y0), below;
    for (int y = y0; y < y1; ++y) {
      if (y + 1 < gbuffer_.height) below = rays_of_row(y + 1);
      for (int x = 0; x < gbuffer_.width; ++x) {
        const auto at = static_cast<size_t>(x);
        if (x + 1 < gbuffer_.width) scan_edge(x, y, false, row[at], row[at + 1]);
        if (y + 1 < gbuffer_.height) scan_edge(x, y, true, row[at], below[at]);
      }
      row.swap(below);
    }
  }

  void narrow_down() {
    std::vector<glm::dvec2> points;
    std::vector<PointSample> samples;
    std::vector<double> at;
    while (!active_.empty()) {
      points.clear();
      at.clear();
      for (const Search& search : active_) {
        at.push_back(next_point(search));
        points.push_back(search.line.start_px + at.back() * search.line.along);
      }
      samples.resize(points.size());
      sample_points(model_, camera_, points, samples, PointRays::in_packets);
      rays += static_cast<std::int64_t>(points.size());
      std::vector<Search> searches;
      searches.swap(active_);
      for (size_t i = 0; i < searches.size(); ++i) advance(searches[i], node_of_sample(camera_, samples[i], searches[i].line, at[i]));
    }
    std::sort(found.begin(), found.end(), [](const BorderCrossing& a, const BorderCrossing& b) {
      return a.grid_edge != b.grid_edge ? a.grid_edge < b.grid_edge : a.t < b.t;
    });
  }

  std::vector<BorderCrossing> found{};
  std::int64_t rays = 0;

 private:
  bool inked(const EdgeNode& node) const { return node.hit() && double{node.n_dot_v} < settings_.threshold; }
  double excess(const EdgeNode& node) const { return node.hit() ? double{node.n_dot_v} - settings_.threshold : 1.0; }

  /// As ray_backwards, of the pixels that hit; each of them belongs to four edges.
  std::vector<double> rays_of_row(int y) const {
    std::vector<double> backwards(static_cast<size_t>(gbuffer_.width), 0.0);
    for (int x = 0; x < gbuffer_.width; ++x) {
      if (gbuffer_.id.at(x, y) != 0)
        backwards[static_cast<size_t>(x)] = ray_backwards(camera_, {x + gbuffer_.sample.x, y + gbuffer_.sample.y});
    }
    return backwards;
  }

  void scan_edge(int x, int y, bool down, double backwards_first, double backwards_last) {
    const size_t p = gbuffer_.id.index(x, y), q = down ? p + static_cast<size_t>(gbuffer_.width) : p + 1;
    if (gbuffer_.id.pixels[p] == 0 && gbuffer_.id.pixels[q] == 0) return;
    const EdgeLine line{{x + gbuffer_.sample.x, y + gbuffer_.sample.y}, down ? glm::dvec2(0.0, 1.0) : glm::dvec2(1.0, 0.0)};
    const EdgeNode first = node_of_pixel(camera_, gbuffer_, p, line, 0.0, backwards_first);
    const EdgeNode last = node_of_pixel(camera_, gbuffer_, q, line, 1.0, backwards_last);
    // Most edges hold nothing, and a search is large.
    if (inked(first) == inked(last) && !may_hold_jump(camera_, first, last, false)) return;
    Search search;
    search.edge = 2 * static_cast<std::int64_t>(p) + (down ? 1 : 0);
    search.line = line;
    search.first = first;
    search.last = last;
    begin(search);
  }

  void begin(Search search) {
    search.a = search.first;
    search.b = search.last;
    search.steps = 0;
    search.moved = 0;
    if (search.b.t - search.a.t < 0.1 * settings_.precision_px) return;
    if (search.ends < kMostEnds && may_hold_jump(camera_, search.a, search.b, search.settled)) {
      search.mode = Mode::jump;
      active_.push_back(search);
    } else {
      begin_ink(search);
    }
  }

  void begin_ink(Search search) {
    if (!search.first.hit() || !search.last.hit() || inked(search.first) == inked(search.last)) return;
    search.a = search.first;
    search.b = search.last;
    search.mode = Mode::ink;
    search.steps = 0;
    search.moved = 0;
    if (search.b.t - search.a.t <= settings_.precision_px) {
      take_ink(search);
    } else {
      active_.push_back(search);
    }
  }

  double next_point(const Search& search) const {
    const double a = search.a.t, b = search.b.t, middle = 0.5 * (a + b);
    if (search.mode != Mode::ink || search.steps >= kSecants) return middle;
    const double at_a = excess(search.a), at_b = excess(search.b);
    // A little beyond the root, so that the next ray falls on its other side and closes the bracket.
    const double root = a + (b - a) * at_a / (at_a - at_b) - 0.4 * settings_.precision_px * search.moved;
    const double margin = std::min(0.3 * settings_.precision_px, 0.25 * (b - a));
    return std::isfinite(root) ? std::clamp(root, a + margin, b - margin) : middle;
  }

  void advance(Search& search, const EdgeNode& node) {
    ++search.steps;
    if (search.mode == Mode::ink) {
      advance_ink(search, node);
    } else {
      advance_jump(search, node);
    }
  }

  void advance_ink(Search& search, const EdgeNode& node) {
    if (inked(node) == inked(search.a)) {
      search.a = node;
      search.moved = -1;
    } else {
      search.b = node;
      search.moved = 1;
    }
    if (search.b.t - search.a.t <= settings_.precision_px) {
      take_ink(search);
    } else {
      active_.push_back(search);
    }
  }

  /// How much speaks for an end of a sheet between the two.
  double evidence(const EdgeNode& a, const EdgeNode& b, bool proof) const {
    if (!a.hit() && !b.hit()) return -1.0;
    if (a.hit() != b.hit()) return 1e12;
    if (proof) return std::abs(depth_step_px(camera_, a, b));
    const double turn = 1.0 - glm::dot(glm::dvec3(a.normal), glm::dvec3(b.normal));
    return 10.0 * excess_step_px(camera_, a, b) + turn + (a.id != b.id ? 1.0 : 0.0);
  }

  void advance_jump(Search& search, const EdgeNode& node) {
    const bool proof = search.mode == Mode::proof;
    const double left = evidence(search.a, node, proof), right = evidence(node, search.b, proof);
    const bool take_left = left != right ? left > right : search.a.depth < search.b.depth;
    (take_left ? search.b : search.a) = node;
    if (!proof && !may_hold_jump(camera_, search.a, search.b, search.settled)) return begin_ink(search);
    const double length = search.b.t - search.a.t;
    if (search.a.hit() != search.b.hit()) {
      if (length <= settings_.precision_px) return take_end(search);
    } else if (!proof && length <= settings_.precision_px) {
      search.mode = Mode::proof;
      search.step_before = std::abs(depth_step_px(camera_, search.a, search.b));
    } else if (proof && length <= settings_.precision_px / kProof) {
      const double step = std::abs(depth_step_px(camera_, search.a, search.b));
      if (step > 0.02 && step > 2.0 * search.step_before / kProof) return take_end(search);
      return begin_ink(search);
    }
    active_.push_back(search);
  }

  void take_end(const Search& search) {
    // What ends within an epsilon of an end is the same end: within it a grazing sheet may fall into facets.
    const double epsilon = 5.0 * settings_.precision_px;
    if ((search.end_before && search.a.t - search.first.t < epsilon) || (search.end_after && search.last.t - search.b.t < epsilon)) {
      return begin_ink(search);
    }
    const bool first_nearer = search.a.depth < search.b.depth;
    const EdgeNode& nearer = first_nearer ? search.a : search.b;
    found.push_back({CurveKind::silhouette, nearer.id, search.edge, 0.5 * (search.a.t + search.b.t), first_nearer, nearer.depth,
                     (first_nearer ? search.b : search.a).depth});
    for (const bool before : {true, false}) {
      Search rest = search;
      rest.ends = search.ends + 1;
      rest.settled = true;
      (before ? rest.last : rest.first) = before ? search.a : search.b;
      (before ? rest.end_after : rest.end_before) = true;
      begin(rest);
    }
  }

  void take_ink(const Search& search) {
    const EdgeNode &a = search.a, &b = search.b;
    const bool ink_first = inked(a), both = a.hit() && b.hit();
    const double length = b.t - a.t, at_a = excess(a), at_b = excess(b);
    const double t = both ? a.t + length * at_a / (at_a - at_b) : 0.5 * (a.t + b.t);
    const EdgeNode& ink = ink_first ? a : b;
    const double limit = 0.05 + 20.0 * length * (1.0 + std::min(std::abs(a.slope), std::abs(b.slope)));
    if (!both || std::abs(depth_step_px(camera_, a, b)) > limit) {
      const bool first_nearer = a.depth < b.depth;
      const EdgeNode& nearer = first_nearer ? a : b;
      found.push_back({CurveKind::silhouette, nearer.id, search.edge, t, first_nearer, nearer.depth, (first_nearer ? b : a).depth});
      return;
    }
    found.push_back({CurveKind::inner, ink.id, search.edge, t, ink_first, ink.depth, (ink_first ? b : a).depth});
  }

  const SceneModel& model_;
  const Camera& camera_;
  const GBuffer& gbuffer_;
  const MeasuredBorderSettings& settings_;
  std::vector<Search> active_{};
};

}  // namespace

BorderCrossings find_crossings(const SceneModel& model, const Camera& camera, const GBuffer& gbuffer,
                               const MeasuredBorderSettings& settings, const ExecutionSettings& how) {
  const int bands = (gbuffer.height + kBandRows - 1) / kBandRows;
  std::vector<Band> work(static_cast<size_t>(bands), Band(model, camera, gbuffer, settings));
  ThreadArena arena(how.threads);
  arena.execute([&] {
    for_each_band(gbuffer.height, [&](int y0, int y1) {
      if (how.cancelled && how.cancelled()) throw Cancelled{};
      Band& band = work[static_cast<size_t>(y0 / kBandRows)];
      band.scan(y0, y1);
      band.narrow_down();
    });
  });
  BorderCrossings all;
  for (const Band& band : work) {
    all.crossings.insert(all.crossings.end(), band.found.begin(), band.found.end());
    all.rays += band.rays;
  }
  return all;
}

}  // namespace limn
