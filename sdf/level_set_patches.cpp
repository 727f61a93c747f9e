#include "sdf/level_set_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sdf/error.h"
#include "sdf/level_set_band.h"
#include "sdf/level_set_crossings.h"
#include "sdf/level_set_data.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

void values_at(const LevelSet& level_set, const GradientDescriptor& gradient, std::span<const glm::dvec3> points,
               std::span<double> values) {
  if (gradient.values)
    gradient.values(level_set.data(), points, values);
  else
    level_set_values(level_set, points, values);
}

/// Two steps of Newton's iteration to the reconstruction's own surface, half a voxel in all at most.
void settle(const LevelSet& level_set, const GradientDescriptor& gradient, std::vector<glm::dvec3>& points) {
  const double most = 0.5 * level_set.info().voxel_size;
  const std::vector<glm::dvec3> start = points;
  std::vector<double> values(points.size());
  std::vector<glm::dvec3> slopes(points.size());
  for (int step = 0; step < 2; ++step) {
    values_at(level_set, gradient, points, values);
    gradient.gradients(level_set.data(), points, slopes);
    for (size_t i = 0; i < points.size(); ++i) {
      const glm::dvec3 moved = points[i] - slopes[i] * (values[i] / std::max(glm::dot(slopes[i], slopes[i]), 1e-300));
      if (glm::distance(moved, start[i]) <= most) points[i] = moved;
    }
  }
}

/// The reconstruction's second derivatives, from its own or from differences of its gradients.
void bends_at(const LevelSet& level_set, const GradientDescriptor& gradient, std::span<const glm::dvec3> points,
              std::span<glm::dmat3> hessians) {
  const LevelSetData& data = level_set.data();
  std::fill(hessians.begin(), hessians.end(), glm::dmat3(0.0));
  if (gradient.hessians) {
    std::vector<FieldJet> jets(points.size());
    gradient.hessians(data, points, jets);
    for (size_t i = 0; i < points.size(); ++i) hessians[i] = jets[i].hessian;
    return;
  }
  if (!gradient.values) return;
  std::vector<glm::dvec3> moved(points.size()), ahead(points.size()), behind(points.size());
  const double step = 0.5 * level_set.info().voxel_size;
  for (int axis = 0; axis < 3; ++axis) {
    for (size_t i = 0; i < points.size(); ++i) (moved[i] = points[i])[axis] += step;
    gradient.gradients(data, moved, ahead);
    for (size_t i = 0; i < points.size(); ++i) (moved[i] = points[i])[axis] -= step;
    gradient.gradients(data, moved, behind);
    for (size_t i = 0; i < points.size(); ++i) hessians[i][axis] = (ahead[i] - behind[i]) / (2.0 * step);
  }
  for (glm::dmat3& hessian : hessians) hessian = 0.5 * (hessian + glm::transpose(hessian));
}

SurfacePatch patch_of(const glm::dvec3& point, const glm::dvec3& slope, const glm::dmat3& hessian, const Affine& target_from_world,
                      const glm::dmat3& world_from_target, double reach) {
  SurfacePatch patch;
  patch.position = target_from_world.point(point);
  const glm::dvec3 g = glm::transpose(world_from_target) * slope;
  const double length = glm::length(g);
  if (!(length > 0.0) || !std::isfinite(length)) return patch;
  const glm::dvec3 n = g / length;
  const glm::dmat3 across = glm::dmat3(1.0) - glm::outerProduct(n, n);
  glm::dmat3 k = across * (glm::transpose(world_from_target) * hessian * world_from_target) * across / length;
  double size = 0.0;
  for (int i = 0; i < 3; ++i) size += glm::dot(k[i], k[i]);
  size = std::sqrt(size);
  // An edge bends without bound; no patch bends by more than its cell is wide.
  if (!std::isfinite(size)) k = glm::dmat3(0.0);
  if (size * reach > 1.0) k /= size * reach;
  patch.normal = glm::vec3(n);
  patch.slope = static_cast<float>(length);
  const double bend[6] = {k[0][0], k[1][1], k[2][2], k[0][1], k[0][2], k[1][2]};
  for (int i = 0; i < 6; ++i) patch.bend[i] = static_cast<float>(bend[i]);
  return patch;
}

glm::dmat3 bend_of(const SurfacePatch& patch) {
  const auto b = [&](int i) { return static_cast<double>(patch.bend[i]); };
  return {{b(0), b(3), b(4)}, {b(3), b(1), b(5)}, {b(4), b(5), b(2)}};
}

/// The foot on the patch's parabola: (I + zK) u = t, once more with the height that u has.
PatchFoot foot_on(const SurfacePatch& patch, double reach, const glm::dvec3& point) {
  const glm::dvec3 n(patch.normal), d = point - patch.position;
  const double height = glm::dot(d, n);
  const glm::dvec3 t = d - height * n;
  const glm::dmat3 k = bend_of(patch);
  PatchFoot result;
  glm::dvec3 u = t;
  double sag = 0.0;
  for (int step = 0; step < 2; ++step) {
    const glm::dmat3 system = glm::dmat3(1.0) + (height + sag) * k;
    const double determinant = glm::determinant(system);
    u = determinant > 0.05 ? glm::inverse(system) * t : t;  // at a centre of curvature every foot is as near
    u -= glm::dot(u, n) * n;
    const double length = glm::length(u), most = 1.2 * reach;
    result.within = length <= most && determinant > 0.05;
    if (length > most) u *= most / length;
    sag = 0.5 * glm::dot(u, k * u);
  }
  result.foot = patch.position + u - sag * n;
  result.distance = std::copysign(glm::distance(point, result.foot), height + sag);
  return result;
}

/// std::max(0, x), which the compiler would make a branch of, and no SIMD.
float positive_part(float x) { return 0.5f * (x + std::abs(x)); }

template <class Patches>
auto arrays_of(Patches& near) {
  return std::array{&near.x, &near.y, &near.z, &near.normal_x, &near.normal_y, &near.normal_z};
}

}  // namespace

const GradientDescriptor& best_gradient_of(const LevelSet& level_set) {
  const GradientDescriptor* best = &find_gradient("cell");
  for (const GradientDescriptor& gradient : gradients())
    if (level_set.info().half_width_voxels >= gradient.half_width_voxels - 1e-3 && gradient.order > best->order) best = &gradient;
  return *best;
}

SurfacePatches surface_patches(const LevelSet& level_set, const GradientDescriptor& gradient, const Affine& target_from_world) {
  const LevelSetData& data = level_set.data();
  const std::vector<nanovdb::Coord> blocks = blocks_with_cells(*data.grid);
  const glm::dmat3 target_from_index = target_from_world.linear * level_set.info().world_from_index.linear;
  SurfacePatches result;
  for (int corner = 0; corner < 4; ++corner) {
    const glm::dvec3 diagonal(1.0, corner & 1 ? -1.0 : 1.0, corner & 2 ? -1.0 : 1.0);
    result.reach = std::max(result.reach, 0.5 * glm::length(target_from_index * diagonal));
  }
  const glm::dmat3 world_from_target = glm::inverse(target_from_world.linear);
  std::vector<std::vector<SurfacePatch>> parts(blocks.size());
  parallel_for(size_t{0}, blocks.size(), [&](size_t i) {
    std::vector<glm::dvec3> points = crossings_in_block(data, blocks[i]);
    if (points.empty()) return;
    for (glm::dvec3& point : points) point = level_set.info().world_from_index.point(point);
    settle(level_set, gradient, points);
    std::vector<glm::dvec3> slopes(points.size());
    std::vector<glm::dmat3> hessians(points.size());
    gradient.gradients(data, points, slopes);
    bends_at(level_set, gradient, points, hessians);
    for (size_t k = 0; k < points.size(); ++k) {
      const SurfacePatch patch = patch_of(points[k], slopes[k], hessians[k], target_from_world, world_from_target, result.reach);
      // Where surfaces touch, slopes cancel: without a normal there is no patch, and its neighbours stand for it.
      if (patch.normal != glm::vec3(0.0f)) parts[i].push_back(patch);
    }
  });
  for (const std::vector<SurfacePatch>& part : parts) result.patches.insert(result.patches.end(), part.begin(), part.end());
  return result;
}

PatchBins::PatchBins(const SurfacePatches& surface, double bin_size) : surface_(&surface), size_(bin_size) {
  Box box;
  for (const SurfacePatch& patch : surface.patches) box = include(box, patch.position);
  if (!surface.patches.empty()) lower_ = box.lower;
  // Twenty-one bits an axis.
  if (!surface.patches.empty()) size_ = std::max(size_, box.longest_side() / double{1 << 20});
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed(surface.patches.size());
  for (size_t i = 0; i < keyed.size(); ++i) {
    const glm::ivec3 cube = cube_of(surface.patches[i].position);
    keyed[i] = {static_cast<std::uint64_t>(cube.x) << 42 | static_cast<std::uint64_t>(cube.y) << 21 | static_cast<std::uint64_t>(cube.z),
                static_cast<std::uint32_t>(i)};
  }
  std::sort(keyed.begin(), keyed.end());
  order_.reserve(keyed.size());
  for (const auto& [key, index] : keyed) {
    if (keys_.empty() || keys_.back() != key) {
      keys_.push_back(key);
      firsts_.push_back(order_.size());
    }
    order_.push_back(index);
  }
  firsts_.push_back(order_.size());
}

glm::ivec3 PatchBins::cube_of(const glm::dvec3& point) const {
  return glm::ivec3(glm::clamp(glm::floor((point - lower_) / size_), glm::dvec3(0.0), glm::dvec3((1 << 21) - 1)));
}

Box PatchBins::box_of(size_t bin) const {
  Box box;
  for (const std::uint32_t i : of(bin)) box = include(box, surface_->patches[i].position);
  return box;
}

void PatchBins::gather(const Box& box, std::vector<std::uint32_t>& found) const {
  found.clear();
  const glm::ivec3 first = cube_of(box.lower), last = cube_of(box.upper);
  const auto key = [](int x, int y, int z) {
    return static_cast<std::uint64_t>(x) << 42 | static_cast<std::uint64_t>(y) << 21 | static_cast<std::uint64_t>(z);
  };
  const auto take = [&](size_t bin) {
    const std::span<const std::uint32_t> all = of(bin);
    found.insert(found.end(), all.begin(), all.end());
  };
  const glm::dvec3 cubes = glm::dvec3(last - first + 1);
  if (cubes.x * cubes.y > static_cast<double>(keys_.size())) {
    for (size_t bin = 0; bin < count(); ++bin) {
      const glm::ivec3 at(keys_[bin] >> 42, keys_[bin] >> 21 & ((1 << 21) - 1), keys_[bin] & ((1 << 21) - 1));
      if (glm::all(glm::greaterThanEqual(at, first)) && glm::all(glm::lessThanEqual(at, last))) take(bin);
    }
    return;
  }
  for (int x = first.x; x <= last.x; ++x)
    for (int y = first.y; y <= last.y; ++y) {
      auto at = std::lower_bound(keys_.begin(), keys_.end(), key(x, y, first.z));
      for (; at != keys_.end() && *at <= key(x, y, last.z); ++at) take(static_cast<size_t>(at - keys_.begin()));
    }
}

void load_patches(const SurfacePatches& surface, std::span<const std::uint32_t> indices, const glm::dvec3& origin, NearPatches& near) {
  near.origin = origin;
  near.index.assign(indices.begin(), indices.end());
  for (std::vector<float>* array : arrays_of(near)) array->resize(indices.size());
  for (size_t i = 0; i < indices.size(); ++i) {
    const SurfacePatch& patch = surface.patches[indices[i]];
    const glm::vec3 at(patch.position - origin);
    near.x[i] = at.x, near.y[i] = at.y, near.z[i] = at.z;
    near.normal_x[i] = patch.normal.x, near.normal_y[i] = patch.normal.y, near.normal_z[i] = patch.normal.z;
  }
}

void disk_distances(const NearPatches& near, double reach, const glm::dvec3& point, float tilt, std::vector<float>& distances) {
  const size_t count = near.count();
  distances.resize(count);
  const glm::vec3 p(point - near.origin);
  const float radius = static_cast<float>(reach);
  const float *const x = near.x.data(), *const y = near.y.data(), *const z = near.z.data();
  const float *const nx = near.normal_x.data(), *const ny = near.normal_y.data(), *const nz = near.normal_z.data();
  float* const to = distances.data();
  for (size_t i = 0; i < count; ++i) {
    const float dx = p.x - x[i], dy = p.y - y[i], dz = p.z - z[i];
    const float height = dx * nx[i] + dy * ny[i] + dz * nz[i], squared = dx * dx + dy * dy + dz * dz;
    const float aside = positive_part(std::sqrt(positive_part(squared - height * height)) - radius);
    to[i] = std::sqrt(height * height + aside * aside) + tilt * std::sqrt(squared);
  }
}

void keep_within(const NearPatches& all, std::span<const float> bounds, float most, NearPatches& kept) {
  kept.origin = all.origin;
  kept.index.resize(all.count());
  size_t count = 0;
  // Numbers first, without a branch that would be guessed wrong.
  for (size_t i = 0; i < bounds.size(); ++i) {
    kept.index[count] = static_cast<std::uint32_t>(i);
    count += bounds[i] <= most ? 1 : 0;
  }
  kept.index.resize(count);
  const auto from = arrays_of(all);
  const auto to = arrays_of(kept);
  for (size_t array = 0; array < from.size(); ++array) {
    to[array]->resize(count);
    for (size_t i = 0; i < count; ++i) (*to[array])[i] = (*from[array])[kept.index[i]];
  }
  for (std::uint32_t& index : kept.index) index = all.index[index];
}

PatchFoot nearest_foot(const SurfacePatches& surface, const NearPatches& near, const glm::dvec3& point, std::vector<float>& scratch) {
  LIMN_CHECK(near.count() > 0);
  // Of two disks that hold the point above them, the nearer one's middle tells which is meant.
  disk_distances(near, surface.reach, point, 1e-3f, scratch);
  constexpr size_t kTried = 4;
  std::array<std::pair<float, std::uint32_t>, kTried> nearest;
  nearest.fill({std::numeric_limits<float>::infinity(), near.index.front()});
  for (size_t i = 0; i < scratch.size(); ++i) {
    if (scratch[i] >= nearest.back().first) continue;
    size_t at = kTried - 1;
    for (; at > 0 && nearest[at - 1].first > scratch[i]; --at) nearest[at] = nearest[at - 1];
    nearest[at] = {scratch[i], near.index[i]};
  }
  PatchFoot best;
  best.distance = std::numeric_limits<double>::infinity();
  for (const auto& [bound, i] : nearest) {
    if (!std::isfinite(bound)) break;
    PatchFoot foot = foot_on(surface.patches[i], surface.reach, point);
    foot.patch = i;
    const bool nearer = std::abs(foot.distance) < std::abs(best.distance);
    if (nearer) best = foot;
  }
  return best;
}

}  // namespace limn
