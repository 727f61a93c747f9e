#pragma once
// Internal: the surface that a level set's reconstruction has, as small curved patches, one in each cell that it crosses; and the nearest
// of them to a point.

#include <cstdint>
#include <span>
#include <vector>

#include "sdf/level_set.h"

namespace limn {

/// z = -u'Ku/2 over the tangent plane at a point of the surface, z along the normal: right to second order, as far as the cell reaches.
struct SurfacePatch {
  glm::dvec3 position{0.0};
  glm::vec3 normal{0.0f};  ///< Unit, outwards.
  float bend[6] = {};      ///< K: xx, yy, zz, xy, xz, yz.
  float slope = 1.0f;      ///< Of the reconstruction along the normal.
};

struct SurfacePatches {
  std::vector<SurfacePatch> patches{};
  double reach = 0.0;  ///< Half the diagonal of a cell: how far a patch may be from what it stands for.
};

/// `target_from_world` (of any linear part that can be inverted) says where the patches are to lie. Their order does not depend on threads.
SurfacePatches surface_patches(const LevelSet& level_set, const GradientDescriptor& gradient, const Affine& target_from_world);

/// The gradient of the highest order whose stencils the level set's band has room for.
const GradientDescriptor& best_gradient_of(const LevelSet& level_set);

/// Patches by cubes of space.
class PatchBins {
 public:
  PatchBins(const SurfacePatches& surface, double bin_size);
  const SurfacePatches& surface() const { return *surface_; }
  size_t count() const { return firsts_.size() - 1; }
  /// Patches of one cube.
  std::span<const std::uint32_t> of(size_t bin) const { return std::span(order_).subspan(firsts_[bin], firsts_[bin + 1] - firsts_[bin]); }
  Box box_of(size_t bin) const;
  /// Those of all cubes that meet the box (and some around it).
  void gather(const Box& box, std::vector<std::uint32_t>& found) const;

 private:
  glm::ivec3 cube_of(const glm::dvec3& point) const;
  const SurfacePatches* surface_;
  double size_;
  glm::dvec3 lower_{0.0};
  std::vector<std::uint64_t> keys_{};  ///< Of the cubes that hold any, rising.
  std::vector<size_t> firsts_{};       ///< Into order_; one more than keys_.
  std::vector<std::uint32_t> order_{};
};

/// Where a point's nearest patch has its foot.
struct PatchFoot {
  glm::dvec3 foot{0.0};
  double distance = 0.0;  ///< Signed, to the patch.
  std::uint32_t patch = 0;
  bool within = false;  ///< False where the foot would lie beyond the patch: the side is not to be trusted.
};

/// A lower bound of the distance to a patch, but for its bend: to a disk of its reach.
double disk_distance(const SurfacePatch& patch, double reach, const glm::dvec3& point);
PatchFoot nearest_foot(const SurfacePatches& surface, std::span<const std::uint32_t> among, const glm::dvec3& point);

}  // namespace limn
