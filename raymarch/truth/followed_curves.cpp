#include "raymarch/truth/followed_curves.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <shared_mutex>

#include "raymarch/truth/curve_follower.h"
#include "raymarch/truth/marching_tetrahedra.h"
#include "raymarch/truth/path_index.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr int kFinerParts = 8;  // of a cell along each axis
constexpr size_t kMostPointsLooked = 64;
constexpr size_t kPartPoints = 64;

/// With what makes it quick to add.
struct FoundPath {
  std::vector<CurvePoint> points{};
  PathIndex::Prepared prepared{};
};

/// Follows a path from each strand that no earlier strand's path passes. Where hundreds of strands are pieces of one curve, as along flat
/// walls seen edge-on, all but the first find it followed. Threads follow strands ahead of what is accepted, and paths are accepted in the
/// order of their strands: what comes out is the same for any number of threads.
class FirstPaths {
 public:
  using Accept = std::function<void(const Strand& like, FoundPath path)>;
  /// `accept` adds the path to `index`.
  FirstPaths(const std::vector<Strand>& strands, const PathIndex& index, Accept accept)
      : strands_(strands), index_(index), accept_(std::move(accept)), done_(strands.size(), 0), paths_(strands.size()) {}

  /// From any thread; false where all strands are taken.
  bool follow_next(CurveFollower& follower) {
    const size_t i = next_.fetch_add(1);
    if (i >= strands_.size()) return false;
    std::optional<FoundPath> path;
    for (const CurvePoint& point : strands_[i].points) {
      const std::optional<CurvePoint> seed = point.rough ? std::nullopt : follower.seed(point);
      if (!seed) continue;
      const auto is_passed = [&] {
        const std::shared_lock lock(mutex_);
        return index_.holds(*seed);
      };
      if (is_passed()) break;
      if (auto points = follower.around(*seed, is_passed)) {
        PathIndex::Prepared prepared = index_.prepare(*points);
        path = FoundPath{std::move(*points), std::move(prepared)};
      }
      break;
    }
    const std::lock_guard lock(mutex_);
    paths_[i] = std::move(path);
    done_[i] = 1;
    for (; accepted_ < done_.size() && done_[accepted_] != 0; ++accepted_) {
      auto& first = paths_[accepted_];
      if (first && !index_.holds(first->points.front())) accept_(strands_[accepted_], std::move(*first));
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
  std::vector<std::optional<FoundPath>> paths_;
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
        new_follower_([&] { return CurveFollower(field, camera, viewer, settings, found.front().c); }),
        follower_(new_follower_()),
        first_(settings.longest_step),
        later_(settings.longest_step) {}

  std::vector<Strand> run(const ExecutionSettings& how) {
    FirstPaths paths(found_, first_, [&](const Strand& like, FoundPath path) {
      first_.add(path.prepared);
      accept(like, std::move(path.points));
    });
    parallel_for(size_t{0}, static_cast<size_t>(tbb::this_task_arena::max_concurrency()), [&](size_t) {
      CurveFollower follower = new_follower_();
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
  void accept(const Strand& like, std::vector<CurvePoint> path) {
    result_.push_back(like);
    result_.back().points = std::move(path);
    result_.back().closed = result_.back().followed = true;
  }

  void accept_later(const Strand& like, std::vector<CurvePoint> path) {
    later_.add(later_.prepare(path));
    accept(like, std::move(path));
  }

  /// By strands.
  std::vector<std::vector<Unpassed>> find_unpassed() const {
    const std::vector<StrandPart> parts = parts_of(found_);
    std::vector<std::vector<Unpassed>> of_part(parts.size()), unpassed(found_.size());
    parallel_for(size_t{0}, parts.size(), [&](size_t k) {
      CurveFollower follower = new_follower_();
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
      accept_later(strand, std::move(*path));
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
      const std::optional<CurvePoint> seed = follower_.seed(point, CurveFollower::kSeedReach / kFinerParts);
      if (!seed) return false;
      if (first_.holds(*seed) || later_.holds(*seed)) continue;
      auto path = follower_.around(*seed, [] { return false; });
      if (!path) return false;
      accept_later(strand, std::move(*path));
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
  std::function<CurveFollower()> new_follower_;
  CurveFollower follower_;
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
