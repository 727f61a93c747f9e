// The offset of a level set: the same marcher, on values from which the width is taken; the band must hold them.

#include <fmt/format.h>

#include <cmath>
#include <mutex>

#include "raymarch/surface/offset.h"
#include "sdf/error.h"

namespace limn {
namespace {

// Every cell on the offset surface lies within the square root of 3 of it; the gradient's side of it needs no more.
constexpr double kCellReach = 1.8;

struct Maker {
  explicit Maker(LevelSetOffsetSource from) : source(std::move(from)), widest(source.level_set), reach(widest.info().half_width_voxels) {}
  LevelSetOffsetSource source;
  mutable std::mutex mutex;
  mutable LevelSet widest;  ///< With the widest band asked for up to now: each view and sample asks again.
  mutable double reach;     ///< Of that band as asked for; a thin object has none as wide inside, nor needs it.
};

double scale_of(const Affine& world_from_object) { return std::cbrt(std::abs(glm::determinant(world_from_object.linear))); }

/// Largest width on the offset surface, in voxels.
double largest_width_voxels(const LevelSetOffsetSource& source, const OffsetWidth& width) {
  const LevelSetInfo& info = source.level_set.info();
  const Box world = transform(source.world_from_object, info.bounds);
  if (world.empty()) return 0.0;
  const Box box{world.lower - source.render_origin, world.upper - source.render_origin};
  const double reach = glm::length(width.eye - box.center()) + box.radius();
  const double largest = width.world + width.per_depth * reach / std::max(0.1, 1.0 - width.slope_bound());
  return largest / (info.voxel_size * scale_of(source.world_from_object));
}

/// Makers of level sets complain of voxels and bands that nobody asked for here.
LevelSet widened(const Maker& maker, double half_width_voxels) {
  try {
    return maker.source.widen(half_width_voxels);
  } catch (const InputError& error) {
    throw InputError({maker.source.file, "width", fmt::format("{:.0f} voxels", half_width_voxels),
                      "the outline stands farther off than a level set can reach: " + error.fault().problem,
                      "a narrower outline or larger voxels"});
  }
}

LevelSet wide_enough(const Maker& maker, double needed) {
  const std::lock_guard lock(maker.mutex);
  if (maker.reach >= needed) return maker.widest;
  if (!maker.source.widen) {
    throw InputError({maker.source.file, "grid", fmt::format("{:.2f} voxels", maker.widest.info().half_width_voxels),
                      "the band is too narrow for an offset this wide",
                      fmt::format("a half width of {:.2f} voxels, or a narrower outline", needed)});
  }
  // A little more than asked for, so that a camera that moves back slightly finds it still wide enough.
  const double wider = std::ceil(1.1 * needed);
  maker.widest = widened(maker, wider);
  maker.reach = wider;
  return maker.widest;
}

Surface make(const void* opaque, const OffsetWidth& width) {
  const Maker& maker = *static_cast<const Maker*>(opaque);
  const double largest = largest_width_voxels(maker.source, width);
  const LevelSet level_set = wide_enough(maker, largest + kCellReach);
  return level_set_marcher(level_set, maker.source.world_from_object, find_gradient("cell"), maker.source.render_origin,
                           maker.source.max_steps, {width, largest});
}

}  // namespace

SurfaceOffset level_set_offset(LevelSetOffsetSource source) { return {std::make_shared<const Maker>(std::move(source)), make}; }

}  // namespace limn
