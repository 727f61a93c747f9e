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

/// Of some patches what a search reads, relative to a place near them: an array a component, so that loops over them become SIMD.
struct NearPatches {
  glm::dvec3 origin{0.0};
  std::vector<float> x{}, y{}, z{}, normal_x{}, normal_y{}, normal_z{};
  std::vector<std::uint32_t> index{};
  size_t count() const { return index.size(); }
};
void load_patches(const SurfacePatches& surface, std::span<const std::uint32_t> indices, const glm::dvec3& origin, NearPatches& near);

/// Lower bounds of the distances to patches, but for their bend: to disks of their reach. `tilt`: how much of the distance to their middles
/// is added.
void disk_distances(const NearPatches& near, double reach, const glm::dvec3& point, float tilt, std::vector<float>& distances);
/// Keeps those of `all` whose bound is at most this.
void keep_within(const NearPatches& all, std::span<const float> bounds, float most, NearPatches& kept);
/// `near` holds at least one; `scratch` is memory of the search.
PatchFoot nearest_foot(const SurfacePatches& surface, const NearPatches& near, const glm::dvec3& point, std::vector<float>& scratch);

}  // namespace limn
