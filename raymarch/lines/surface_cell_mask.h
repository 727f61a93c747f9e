#pragma once
// Internal: which cells of a level set its surface may go through, and where rays go through these.

#include <array>
#include <span>
#include <vector>

#include "raymarch/truth/lattice_samples.h"
#include "sdf/level_set_reconstruction.h"

namespace limn {

/// origin + t * direction, index coordinates.
struct IndexRay {
  glm::dvec3 origin{0.0}, direction{0.0};
};
/// Of a ray.
struct RayStretch {
  double begin = 0.0, end = 0.0;
};

/// Safe to ask from many threads at once.
class SurfaceCellMask {
 public:
  SurfaceCellMask() = default;
  explicit SurfaceCellMask(std::span<const SurfaceCell> cells);

  bool holds(const glm::ivec3& node) const;
  /// Where the ray goes through cells of the mask from t = `begin` to `end`, in order, but for corners of cells that it is in for less than
  /// a billionth of a voxel. Replaces what is in `stretches`.
  void find_stretches(const IndexRay& ray, double begin, double end, std::vector<RayStretch>& stretches) const;

 private:
  static constexpr int kSide = 8;  // of a block of cells
  using Block = std::array<std::uint64_t, kSide>;

  static std::uint64_t key_of(const glm::ivec3& block);
  static bool holds(const Block& block, const glm::ivec3& place) {
    return (block[static_cast<size_t>(place.x)] >> (place.y * kSide + place.z) & 1u) != 0;
  }

  KeyedValues<Block> blocks_{};
};

}  // namespace limn
