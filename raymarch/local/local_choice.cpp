#include "raymarch/local/local_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "raymarch/level_set/brick_layout.h"
#include "raymarch/local/brick_demand.h"
#include "sdf/memory_text.h"
#include "sdf/parallel.h"
#include "sdf/size_error.h"

namespace limn {
namespace {

/// What a brick costs while it is built and after: nodes, a leaf, 16-bit values and layers.
constexpr std::int64_t kBrickBytes = 10'000;

/// Bricks that the surface passes by this much are there, too: where larger voxels round it off, it may still pass them.
constexpr double kPassed_voxels = 0.5;

/// Nothing where the surface does not pass there. `parent`: asks the part of the brick that holds it.
std::optional<LocalBrick> brick_at(PartEvaluator& parent, const LocalChoice& lattice, size_t level, const glm::ivec3& place) {
  const Box box = lattice.box_of(level, place);
  const double h = lattice.voxel_of(level);
  if (!parent.may_hold_surface(dilate(box, kPassed_voxels * h))) return std::nullopt;
  // Its nodes are at most eight voxels away from a node that asks for the part, which asks as far as the band reaches.
  return LocalBrick{place, 0, parent.restricted(dilate(box, 16.0 * h))};
}

/// The smaller bricks in `brick` that pictures ask for: where its voxels do not do.
class Demand {
 public:
  Demand(const LocalBrick& brick, size_t level, const LocalChoice& lattice, const LocalBrickSettings& settings)
      : evaluator_(brick.part), level_(level), lattice_(lattice), settings_(settings) {
    if (needs(lattice.box_of(level, brick.place))) look_at_parts(brick.place, lattice.step(level - 1));
  }
  std::vector<LocalBrick> bricks{};

 private:
  bool needs(const Box& box) {
    return evaluator_.needs_smaller_voxels(box, lattice_.voxel_of(level_), lattice_.voxel_of(level_ - 1), settings_);
  }

  /// Of a cube that is 2^steps times as large as the smaller bricks: first its octants, then the parts of those that ask for it.
  void look_at_parts(const glm::ivec3& cube, int steps) {
    const double h = lattice_.voxel_of(level_ - 1), side = 8.0 * h * (1 << (steps - 1));
    for (int octant = 0; octant < 8; ++octant) {
      const glm::ivec3 place = 2 * cube + glm::ivec3(octant & 1, octant >> 1 & 1, octant >> 2);
      Box box{lattice_.origin + side * glm::dvec3(place), {}};
      box.upper = box.lower + side;
      if (!evaluator_.may_hold_surface(dilate(box, kPassed_voxels * h)) || !needs(box)) continue;
      if (steps > 1)
        look_at_parts(place, steps - 1);
      else if (std::optional<LocalBrick> found = brick_at(evaluator_, lattice_, level_ - 1, place))
        bricks.push_back(std::move(*found));
    }
  }

  PartEvaluator evaluator_;
  size_t level_;
  const LocalChoice& lattice_;
  const LocalBrickSettings& settings_;
};

/// Bricks of all sizes, those in which smaller ones are among them.
class BrickTree {
 public:
  BrickTree(LocalChoice& choice, std::int64_t max_bytes) : choice_(choice), at_(choice.levels.size()), max_bytes_(max_bytes) {}

  void add(size_t level, LocalBrick brick) {
    const glm::ivec3 place = brick.place;
    const bool is_new = at_[level].emplace(key_of(8 * place), choice_.levels[level].size()).second;
    if (!is_new) return;
    choice_.levels[level].push_back(std::move(brick));
    if (++count_ * kBrickBytes > max_bytes_) refuse();
    if (level + 1 == at_.size()) return;
    // What lies beside it is at most one size larger.
    const int step = choice_.step(level);
    for (int k = 0; k < 27; ++k) require(level + 1, (place + glm::ivec3(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1)) >> step);
    LocalBrick& larger = choice_.levels[level + 1][at_[level + 1].at(key_of(8 * (place >> step)))];
    larger.covered |= covered_by(place & ((1 << step) - 1), step);
  }

 private:
  static constexpr size_t kEmpty = ~size_t{0};  ///< The surface does not pass there.

  void require(size_t level, const glm::ivec3& place) {
    const std::uint64_t key = key_of(8 * place);
    if (level + 1 == at_.size() || at_[level].contains(key)) return;
    const glm::ivec3 larger = place >> choice_.step(level);
    require(level + 1, larger);
    const auto parent = at_[level + 1].find(key_of(8 * larger));
    std::optional<LocalBrick> brick;
    if (parent != at_[level + 1].end() && parent->second != kEmpty) {
      PartEvaluator evaluator(choice_.levels[level + 1][parent->second].part);
      brick = brick_at(evaluator, choice_, level, place);
    }
    if (brick)
      add(level, std::move(*brick));
    else
      at_[level].emplace(key, kEmpty);
  }

  [[noreturn]] void refuse() const {
    throw SizeError({{},
                     "voxel size",
                     fmt::format("{:.4g}", choice_.voxel_size),
                     "building the local level set needs more than the limit of " + memory_text(static_cast<double>(max_bytes_)),
                     "larger voxels or a larger tolerance"});
  }

  LocalChoice& choice_;
  std::vector<std::unordered_map<std::uint64_t, size_t>> at_;
  std::int64_t max_bytes_, count_ = 0;
};

/// The smaller bricks that pictures ask for in bricks of one size: all are looked for at once, then added one after the other.
void refine(size_t level, const LocalBrickSettings& settings, LocalChoice& choice, BrickTree& tree) {
  const std::vector<LocalBrick>& bricks = choice.levels[level];
  std::vector<std::vector<LocalBrick>> demanded(bricks.size());
  parallel_for(size_t{0}, bricks.size(), [&](size_t i) { demanded[i] = Demand(bricks[i], level, choice, settings).bricks; });
  for (std::vector<LocalBrick>& of_one : demanded)
    for (LocalBrick& brick : of_one) tree.add(level - 1, std::move(brick));
}

/// Sizes that are four times the one before as long as they are small in the pictures: what lies between would serve as a step only. From
/// where creases need them on each is twice the one before, so that no part is much finer than it has to be.
std::vector<int> doublings_for(const Box& bounds, const LocalBrickSettings& settings) {
  double pixels_per_unit = 0.0;
  for (const Camera& camera : settings.local.cameras) {
    const double depth = std::max(project(camera, bounds.center()).z, 0.5 * bounds.longest_side());
    pixels_per_unit = std::max(pixels_per_unit, pixels_per_unit_at(camera, depth));
  }
  std::vector<int> doublings{0};
  // The largest bricks are half as large as the surface.
  while (doublings.back() < 20) {
    const double voxel = settings.voxel_size * std::exp2(doublings.back());
    if (16.0 * voxel >= bounds.longest_side()) break;
    doublings.push_back(doublings.back() + (4.0 * voxel * pixels_per_unit <= kFolded_px ? 2 : 1));
  }
  return doublings;
}

/// By x, y and z.
std::vector<LocalBrick> in_order(std::vector<LocalBrick> bricks) {
  std::vector<std::pair<std::uint64_t, size_t>> order(bricks.size());
  for (size_t i = 0; i < bricks.size(); ++i) order[i] = {key_of(8 * bricks[i].place), i};
  std::sort(order.begin(), order.end());
  std::vector<LocalBrick> sorted;
  sorted.reserve(bricks.size());
  for (const auto& [key, i] : order) sorted.push_back(std::move(bricks[i]));
  return sorted;
}

}  // namespace

LocalChoice choose_bricks(const SurfacePart& whole, const LocalBrickSettings& settings) {
  const Box bounds = bounds_of(whole);
  LocalChoice choice;
  choice.voxel_size = settings.voxel_size;
  choice.doublings = doublings_for(bounds, settings);
  const size_t top = choice.doublings.size() - 1;
  choice.levels.resize(top + 1);
  const double step = 8.0 * choice.voxel_of(top);
  choice.origin = glm::round(bounds.center() / step) * step;
  const glm::ivec3 lower(glm::floor((bounds.lower - choice.origin) / step)), upper(glm::ceil((bounds.upper - choice.origin) / step));
  BrickTree tree(choice, settings.max_bytes);
  PartEvaluator evaluator(whole);
  // Faces of the bounds may lie on faces of bricks: one more to each side.
  for (int x = lower.x - 1; x <= upper.x; ++x)
    for (int y = lower.y - 1; y <= upper.y; ++y)
      for (int z = lower.z - 1; z <= upper.z; ++z)
        if (evaluator.may_come_near(choice.box_of(top, {x, y, z}))) tree.add(top, {{x, y, z}, 0, whole});
  // A brick may ask for larger ones beside it. Those are not looked at again: what asks for smaller voxels in them has been found.
  for (size_t level = top; level > 0; --level) refine(level, settings, choice, tree);
  for (std::vector<LocalBrick>& bricks : choice.levels) bricks = in_order(std::move(bricks));
  return choice;
}

}  // namespace limn
