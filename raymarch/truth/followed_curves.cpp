#include "raymarch/truth/followed_curves.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <set>
#include <shared_mutex>

#include "raymarch/truth/lattice_samples.h"
#include "raymarch/truth/marching_tetrahedra.h"
#include "sdf/parallel.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kSeedReach = 0.25;   // of the longest step, that a seed may be moved onto the curve
constexpr double kFirstStep = 0.25;   // of the longest one
constexpr double kLeastStep = 1e-5;   // of the longest one
constexpr double kSagitta = 0.2;      // of the tolerance
constexpr double kCorrection = 0.05;  // of a step, by which the prediction may be off
constexpr double kClosing = 0.15;     // of a step: so near it the start is the end
constexpr double kTurn = 0.95;        // the cosine of the angle between tangents, and between normals, along a step
constexpr double kLongest_px = 1.0;
constexpr double kPolished = 1e-4;      // of the reach of Newton's iteration, whose error is squared with each step
constexpr double kClose = 1e-3;         // of the reach of Newton's iteration, where only whether it converges is asked
constexpr double kLeastTurning = 1e-3;  // of the longest step: shorter ones are not searched for turns of the image
constexpr double kLeastLooked = 0.25;   // of the longest step: along shorter ones nobody looks
constexpr std::array<double, 3> kLookedAt = {0.5, 0.25, 0.75};
constexpr double kMostAside = 0.05;  // of a step's length, that points along it may lie off the cubic through its ends
constexpr int kFinerParts = 8;       // of a cell along each axis
constexpr size_t kMostPointsLooked = 64;
constexpr size_t kPartPoints = 64;
constexpr size_t kFirstMark = 64;                      // points
constexpr size_t kMostPoints = 2'000'000;              // of a curve
constexpr size_t kAskedEvery = 64;                     // points, whether anybody else has followed the curve
constexpr double kOnPath = 0.15, kOnPathLeast = 1e-3;  // of a step, and of the longest step

glm::dvec3 tangent_of(const CurvePoint& point) { return glm::normalize(glm::cross(point.high, point.uphill)); }

/// Segments of closed curves by the cubes that they lie in.
class PathIndex {
 public:
  explicit PathIndex(double side) : side_(side) {}

  void add(const std::vector<CurvePoint>& points) {
    const size_t first = points_.size();
    for (const CurvePoint& point : points) points_.push_back({point.p, glm::normalize(point.uphill)});
    points_.push_back(points_[first]);
    // Most segments lie in the same cube as the one before.
    glm::ivec3 cube(std::numeric_limits<int>::min());
    std::uint32_t run = kNone;
    for (size_t i = first; i + 1 < points_.size(); ++i) {
      const glm::dvec3 &a = points_[i].p, &b = points_[i + 1].p;
      const double reach = reach_of(glm::distance(a, b));
      const glm::ivec3 low = cube_of(glm::min(a, b) - reach), high = cube_of(glm::max(a, b) + reach);
      if (low == high && low == cube) {
        runs_[run].end = static_cast<std::uint32_t>(i + 1);
        continue;
      }
      for (int x = low.x; x <= high.x; ++x)
        for (int y = low.y; y <= high.y; ++y)
          for (int z = low.z; z <= high.z; ++z) run = add_to({x, y, z}, static_cast<std::uint32_t>(i));
      cube = low == high ? low : glm::ivec3(std::numeric_limits<int>::min());
    }
  }
  /// Another arm that runs close by has the higher N.V on its other side.
  bool holds(const CurvePoint& point) const {
    const std::uint32_t* const last = last_in_.find(key_of(cube_of(point.p)));
    for (std::uint32_t at = last != nullptr ? *last : kNone; at != kNone; at = runs_[at].before) {
      for (std::uint32_t i = runs_[at].begin; i < runs_[at].end; ++i) {
        const PathPoint &a = points_[i], &b = points_[i + 1];
        if (glm::dot(a.uphill + b.uphill, point.uphill) > 0.0 && distance_to_segment(point.p, a.p, b.p) < reach_of(glm::distance(a.p, b.p)))
          return true;
      }
    }
    return false;
  }

 private:
  struct PathPoint {
    glm::dvec3 p{0.0}, uphill{0.0};
  };
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  /// Segments in a row that lie in a cube, from one point to the next, and the run before it in the same cube.
  struct Run {
    std::uint32_t begin = 0, end = 0, before = kNone;
  };

  /// Returns the segment's run in the cube.
  std::uint32_t add_to(const glm::ivec3& cube, std::uint32_t segment) {
    bool added = false;
    std::uint32_t& last = last_in_.at(key_of(cube), added);
    if (!added && runs_[last].end == segment) {
      ++runs_[last].end;
    } else {
      runs_.push_back({segment, segment + 1, added ? kNone : last});
      last = static_cast<std::uint32_t>(runs_.size() - 1);
    }
    return last;
  }
  double reach_of(double length) const { return kOnPath * length + kOnPathLeast * side_; }
  glm::ivec3 cube_of(const glm::dvec3& p) const { return glm::ivec3(glm::floor(p / side_)); }
  static std::uint64_t key_of(const glm::ivec3& cube) {
    const auto part = [](int v) { return static_cast<std::uint64_t>(v) & 0x1fffffu; };
    return (part(cube.x) << 42u | part(cube.y) << 21u | part(cube.z)) + 1;
  }

  double side_;
  std::vector<PathPoint> points_{};  ///< Of each curve the first one again after its last.
  std::vector<Run> runs_{};
  KeyedValues<std::uint32_t> last_in_{};  ///< Of each cube the last run.
};

/// Where a path leads: its tangent as the parabola through the last three of them.
struct Course {
  explicit Course(const glm::dvec3& from) : tangent(from) {}

  void go(const glm::dvec3& to, double length) {
    const glm::dvec3 slope = (to - tangent) / length;  // half a step ago
    bend_change = last_length > 0.0 ? (slope - last_slope) / (last_length + length) : glm::dvec3(0.0);
    bend = slope + length * bend_change;
    tangent = to, last_slope = slope, last_length = length;
  }
  glm::dvec3 way(double step) const { return step * (tangent + step * (bend / 2.0 + step / 3.0 * bend_change)); }

  glm::dvec3 tangent{0.0}, bend{0.0}, bend_change{0.0}, last_slope{0.0};
  double last_length = 0.0;  ///< 0: there was no step.
};

class Follower {
 public:
  Follower(const Field& field, const Camera& camera, const Viewer& viewer, const FollowSettings& settings, double c)
      : evaluator_(field), camera_(camera), viewer_(viewer), settings_(settings), c_(c) {}

  /// The curve's own point within `reach` longest steps of one beside it.
  std::optional<CurvePoint> seed(const CurvePoint& point, double reach = kSeedReach) {
    return polish(evaluator_, viewer_, c_, point.p, reach * settings_.longest_step, kPolished);
  }

  /// From the point around to it again; nothing where the curve is lost on the way, or `stop()`, asked now and then, is true. A step that
  /// led onto another arm may never come back: then all of it is tried in shorter steps.
  template <class Stop>
  std::optional<std::vector<CurvePoint>> around(const CurvePoint& start, const Stop& stop) {
    for (const double share : {1.0, 0.25, 0.0625}) {
      bool stopped = false;
      const auto stops = [&] { return stopped = stop(); };
      auto path = around_in_steps(start, share * settings_.longest_step, stops);
      if (path || stopped) return path;
    }
    return {};
  }

 private:
  /// The image of a way from a point, px.
  glm::dvec2 image_way(const glm::dvec3& p, const glm::dvec3& way) const {
    const double small = 1e-4 * settings_.longest_step;
    return glm::dvec2(project(camera_, p + small * way) - project(camera_, p - small * way)) / (2.0 * small);
  }

  template <class Stop>
  std::optional<std::vector<CurvePoint>> around_in_steps(const CurvePoint& start, double longest, const Stop& stop) {
    std::vector<CurvePoint> path{start};
    Course course(tangent_of(start));
    double step = kFirstStep * longest;
    size_t mark = 0;
    while (path.size() < kMostPoints) {
      if (path.size() % kAskedEvery == 0 && stop()) return {};
      const CurvePoint from = path.back();
      const std::optional<CurvePoint> next = advance(from, course, longest, step);
      if (!next) return {};
      const glm::dvec3 way = next->p - from.p;
      const double length = glm::length(way);
      if (path.size() > 2 && passes(from, *next, course.tangent, start)) {
        if (glm::dot(start.p - from.p, way) <= 0.0) path.pop_back();
        return path;
      }
      // Where it comes by a later point again it goes in circles beside its start (Brent 1980, "An improved Monte Carlo factorization
      // algorithm", has the marks).
      if (mark > 0 && path.size() > mark + 2 && passes(from, *next, course.tangent, path[mark])) return {};
      if (path.size() >= std::max(kFirstMark, 2 * mark)) mark = path.size() - 1;
      course.go(tangent_of(*next), length);
      path.push_back(*next);
    }
    return {};
  }
  /// Where chords meet, a point of the curve may lie beside the end of the one and before the beginning of the other.
  static bool passes(const CurvePoint& from, const CurvePoint& to, const glm::dvec3& tangent, const CurvePoint& point) {
    const glm::dvec3 way = to.p - from.p;
    const double length = glm::length(way), along = glm::dot(point.p - from.p, way) / length;
    return along > -kClosing * length && along <= length && distance_to_segment(point.p, from.p, to.p) < kClosing * length &&
           glm::dot(tangent, tangent_of(point)) > 0.5;
  }

  /// The image turns back and forth within a step, as at the two cusps of a swallowtail, by the parabola that its speed follows: what it is
  /// at either end and, from the chord, in the mean.
  bool turns_twice(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec2& start, const glm::dvec2& end, double step) const {
    const double speed = glm::length(start);
    if (!(speed > 0.0)) return false;
    const double last = glm::dot(end, start) / speed,
                 mean = glm::dot(glm::dvec2(project(camera_, to) - project(camera_, from)), start) / (speed * step),
                 bend = 3.0 * (speed + last) - 6.0 * mean, slope = last - speed - bend;
    return last > 0.0 && slope < 0.0 && slope > -2.0 * bend && 4.0 * bend * speed < slope * slope;
  }

  /// Somewhere along a step the curve is not where its ends and tangents lead: it goes round a fold in between.
  bool leaves_cubic(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& start, const glm::dvec3& end) {
    const double length = glm::distance(from, to);
    return std::any_of(kLookedAt.begin(), kLookedAt.end(), [&](double t) {
      const double rest = 1.0 - t;
      const glm::dvec3 between =
          rest * rest * (1.0 + 2.0 * t) * from + t * t * (1.0 + 2.0 * rest) * to + length * t * rest * (rest * start - t * end);
      return !polish(evaluator_, viewer_, c_, between, kMostAside * length, kClose);
    });
  }

  /// A step that is shortened until it stays on the curve and on its chord, and grows for the next one.
  std::optional<CurvePoint> advance(const CurvePoint& from, const Course& course, double longest, double& step) {
    const glm::dvec3& tangent = course.tangent;
    const glm::dvec2 start = image_way(from.p, tangent);
    const double scale = pixels_per_unit_at(camera_, std::max(project(camera_, from.p).z, 1e-9));
    step = std::min({step, longest, kLongest_px / scale});
    const double most = kSagitta * settings_.tolerance_px;
    for (; step > kLeastStep * settings_.longest_step; step *= 0.5) {
      const glm::dvec3 predicted = from.p + course.way(step);
      const std::optional<CurvePoint> next = polish(evaluator_, viewer_, c_, predicted, 0.25 * step, kPolished);
      if (!next || !(glm::distance(next->p, predicted) < kCorrection * step)) continue;
      const glm::dvec3 turned = tangent_of(*next);
      if (!(glm::dot(turned, tangent) > kTurn && glm::dot(next->high, from.high) > kTurn)) continue;
      const glm::dvec2 end = image_way(next->p, turned);
      const double turn = std::fabs(std::atan2(start.x * end.y - start.y * end.x, glm::dot(start, end)));
      const double sagitta = 0.5 * (glm::length(start) + glm::length(end)) * step * turn / 8.0;
      if (sagitta > most || (step > kLeastTurning * settings_.longest_step && turns_twice(from.p, next->p, start, end, step))) continue;
      if (step > kLeastLooked * settings_.longest_step && leaves_cubic(from.p, next->p, tangent, turned)) continue;
      step *= std::clamp(0.8 * std::sqrt(most / std::max(sagitta, 1e-300)), 0.7, 2.0);
      return next;
    }
    return {};
  }

  FieldEvaluator evaluator_;
  const Camera& camera_;
  const Viewer& viewer_;
  const FollowSettings& settings_;
  double c_;
};

/// Follows a path from each strand that no earlier strand's path passes. Where hundreds of strands are pieces of one curve, as along flat
/// walls seen edge-on, all but the first find it followed. Threads follow strands ahead of what is accepted, and paths are accepted in the
/// order of their strands: what comes out is the same for any number of threads.
class FirstPaths {
 public:
  using Accept = std::function<void(const Strand& like, std::vector<CurvePoint> path)>;
  /// `accept` adds the path to `index`.
  FirstPaths(const std::vector<Strand>& strands, const PathIndex& index, Accept accept)
      : strands_(strands), index_(index), accept_(std::move(accept)), done_(strands.size(), 0), paths_(strands.size()) {}

  /// From any thread; false where all strands are taken.
  bool follow_next(Follower& follower) {
    const size_t i = next_.fetch_add(1);
    if (i >= strands_.size()) return false;
    std::optional<std::vector<CurvePoint>> path;
    for (const CurvePoint& point : strands_[i].points) {
      const std::optional<CurvePoint> seed = point.rough ? std::nullopt : follower.seed(point);
      if (!seed) continue;
      const auto is_passed = [&] {
        const std::shared_lock lock(mutex_);
        return index_.holds(*seed);
      };
      if (!is_passed()) path = follower.around(*seed, is_passed);
      break;
    }
    const std::lock_guard lock(mutex_);
    paths_[i] = std::move(path);
    done_[i] = 1;
    for (; accepted_ < done_.size() && done_[accepted_] != 0; ++accepted_) {
      auto& first = paths_[accepted_];
      if (first && !index_.holds(first->front())) accept_(strands_[accepted_], std::move(*first));
      first.reset();
    }
    return true;
  }

 private:
  const std::vector<Strand>& strands_;
  const PathIndex& index_;
  Accept accept_;
  std::atomic<size_t> next_{0};
  std::shared_mutex mutex_{};  ///< Of all below, and of the index.
  size_t accepted_ = 0;        ///< So many strands are done with.
  std::vector<char> done_;
  std::vector<std::optional<std::vector<CurvePoint>>> paths_;
};

/// Crossings of finer cells about a strand; nothing where it is long.
std::optional<std::vector<CurvePoint>> finer_crossings(const Strand& strand, const Field& field, const Viewer& viewer, double cell) {
  if (strand.points.size() > kMostPointsLooked) return {};
  Box box;
  for (const CurvePoint& point : strand.points) box = include(box, point.p);
  const CellGrid grid{box.lower - 2.0 * cell, cell / kFinerParts};
  std::set<std::array<int, 3>> cubes;  // of the size of the strand's cells, in the order of their places
  for (const CurvePoint& point : strand.points) {
    const glm::ivec3 own((point.p - grid.corner) / cell);
    for (int k = 0; k < 27; ++k) cubes.insert({own.x + k / 9 - 1, own.y + k / 3 % 3 - 1, own.z + k % 3 - 1});
  }
  FieldEvaluator evaluator(field);
  LatticeSamples samples;
  CellOutput output;
  for (const auto& cube : cubes) {
    for (int k = 0; k < kFinerParts * kFinerParts * kFinerParts; ++k) {
      const glm::ivec3 part(k / (kFinerParts * kFinerParts), k / kFinerParts % kFinerParts, k % kFinerParts);
      march_cell(evaluator, viewer, grid, kFinerParts * glm::ivec3(cube[0], cube[1], cube[2]) + part, {strand.c, strand.c}, 1u, &samples,
                 output, {true});
    }
  }
  std::vector<CurvePoint> points;
  for (const Crossing& crossing : output[0].crossings) points.push_back(crossing.point);
  return points;
}

/// A point that no path passes, and what it leads to on the curve.
struct Unpassed {
  CurvePoint point{};
  std::optional<CurvePoint> seed{};
  bool is_known = false;  ///< A path passes that.
};

/// Points of a strand that one thread looks at.
struct StrandPart {
  size_t strand = 0, begin = 0, end = 0;
};
std::vector<StrandPart> parts_of(const std::vector<Strand>& strands) {
  std::vector<StrandPart> parts;
  for (size_t i = 0; i < strands.size(); ++i) {
    for (size_t begin = 0; begin < strands[i].points.size(); begin += kPartPoints)
      parts.push_back({i, begin, std::min(begin + kPartPoints, strands[i].points.size())});
  }
  return parts;
}

size_t smooth_points(const Strand& strand) {
  return static_cast<size_t>(
      std::count_if(strand.points.begin(), strand.points.end(), [](const CurvePoint& point) { return !point.rough; }));
}

class StrandFollower {
 public:
  StrandFollower(std::vector<Strand>& found, const Field& field, const Camera& camera, const Viewer& viewer, const FollowSettings& settings)
      : found_(found),
        field_(field),
        viewer_(viewer),
        settings_(settings),
        new_follower_([&] { return Follower(field, camera, viewer, settings, found.front().c); }),
        follower_(new_follower_()),
        first_(settings.longest_step),
        later_(settings.longest_step) {}

  std::vector<Strand> run(const ExecutionSettings& how) {
    FirstPaths paths(found_, first_, [&](const Strand& like, std::vector<CurvePoint> path) { accept(like, std::move(path), first_); });
    parallel_for(size_t{0}, static_cast<size_t>(tbb::this_task_arena::max_concurrency()), [&](size_t) {
      Follower follower = new_follower_();
      while (paths.follow_next(follower)) {
        if (how.cancelled && how.cancelled()) throw Cancelled{};
      }
    });
    // What no path passes: other curves through crossings that were joined to these.
    const std::vector<std::vector<Unpassed>> unpassed = find_unpassed();
    std::vector<std::optional<Crossings>> finer(found_.size());
    parallel_for(size_t{0}, found_.size(), [&](size_t i) {
      if (leads_nowhere(found_[i], unpassed[i])) finer[i] = crossings_about(found_[i]);
    });
    for (size_t i = 0; i < found_.size(); ++i) {
      if (follow_unpassed(found_[i], unpassed[i]) || found_[i].points.size() == 1) continue;
      if (!is_told_by(finer[i] ? *finer[i] : crossings_about(found_[i]), found_[i])) keep(found_[i]);
    }
    return std::move(result_);
  }

 private:
  void accept(const Strand& like, std::vector<CurvePoint> path, PathIndex& index) {
    index.add(path);
    result_.push_back(like);
    result_.back().points = std::move(path);
    result_.back().closed = result_.back().followed = true;
  }

  /// By strands.
  std::vector<std::vector<Unpassed>> find_unpassed() const {
    const std::vector<StrandPart> parts = parts_of(found_);
    std::vector<std::vector<Unpassed>> of_part(parts.size()), unpassed(found_.size());
    parallel_for(size_t{0}, parts.size(), [&](size_t k) {
      Follower follower = new_follower_();
      for (size_t i = parts[k].begin; i < parts[k].end; ++i) {
        const CurvePoint& point = found_[parts[k].strand].points[i];
        if (point.rough || first_.holds(point)) continue;
        const std::optional<CurvePoint> seed = follower.seed(point);
        of_part[k].push_back({point, seed, seed && first_.holds(*seed)});
      }
    });
    for (size_t k = 0; k < parts.size(); ++k) {
      std::vector<Unpassed>& all = unpassed[parts[k].strand];
      all.insert(all.end(), of_part[k].begin(), of_part[k].end());
    }
    return unpassed;
  }

  /// True where a path passes any of the strand's points.
  bool follow_unpassed(const Strand& strand, const std::vector<Unpassed>& unpassed) {
    bool any = unpassed.size() < smooth_points(strand), lost = false;
    for (const auto& [point, seed, is_known] : unpassed) {
      if (is_known || later_.holds(point) || (seed && later_.holds(*seed))) {
        any = true;
        continue;
      }
      if (!seed || lost) continue;
      auto path = follower_.around(*seed, [] { return false; });
      lost = !path;
      if (!path) continue;
      accept(strand, std::move(*path), later_);
      any = true;
    }
    return any;
  }

  /// Of finer cells; nothing where the strand is too long for that.
  using Crossings = std::optional<std::vector<CurvePoint>>;
  Crossings crossings_about(const Strand& strand) const { return finer_crossings(strand, field_, viewer_, settings_.longest_step); }

  /// Whatever is followed later.
  static bool leads_nowhere(const Strand& strand, const std::vector<Unpassed>& unpassed) {
    return strand.points.size() > 1 && unpassed.size() == smooth_points(strand) &&
           std::none_of(unpassed.begin(), unpassed.end(), [](const Unpassed& one) { return one.seed.has_value(); });
  }
  /// Cells take two sheets that come close to each other for one, and a curve that goes on past them for two: where all crossings of finer
  /// cells are followed, these curves are what is there.
  bool is_told_by(const Crossings& crossings, const Strand& strand) {
    if (!crossings) return false;
    for (const CurvePoint& point : *crossings) {
      const std::optional<CurvePoint> seed = follower_.seed(point, kSeedReach / kFinerParts);
      if (!seed) return false;
      if (first_.holds(*seed) || later_.holds(*seed)) continue;
      auto path = follower_.around(*seed, [] { return false; });
      if (!path) return false;
      accept(strand, std::move(*path), later_);
    }
    return true;
  }

  void keep(Strand& strand) {
    for (CurvePoint& point : strand.points) {
      if (const std::optional<CurvePoint> seed = follower_.seed(point)) {
        point = *seed;
      } else {
        point.rough = true;
      }
    }
    result_.push_back(std::move(strand));
  }

  std::vector<Strand>& found_;
  const Field& field_;
  const Viewer& viewer_;
  const FollowSettings& settings_;
  std::function<Follower()> new_follower_;
  Follower follower_;
  PathIndex first_, later_;  ///< Paths that all threads know, and those that came after these.
  std::vector<Strand> result_{};
};

}  // namespace

std::vector<Strand> follow_strands(std::vector<Strand> found, const Field& field, const Camera& camera, const Viewer& viewer,
                                   const FollowSettings& settings, const ExecutionSettings& how) {
  if (found.empty()) return found;
  return StrandFollower(found, field, camera, viewer, settings).run(how);
}

}  // namespace limn
