#include "raymarch/gbuffer/gbuffer_lanes.h"

#include <limits>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/gbuffer/gbuffer_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

// Depths are added up in double, of which a register holds half as many.
using D = hn::CappedTag<double, 8>;
using F = hn::Rebind<float, D>;
using VF = hn::Vec<F>;

static_assert(sizeof(glm::vec3) == 3 * sizeof(float));

HWY_INLINE VF dot(VF x, VF y, VF z, VF ax, VF ay, VF az) { return hn::Add(hn::Add(hn::Mul(x, ax), hn::Mul(y, ay)), hn::Mul(z, az)); }

void FillLanes(const RayBatch& rays, const SceneHits& found, const DepthAxis& axis, const GBufferLayers& wanted, LaneLayers& out) {
  const F f;
  const D d;
  const hn::RebindToSigned<F> i32;
  const VF zero = hn::Zero(f), far = hn::Set(f, std::numeric_limits<float>::infinity());
  const VF fx = hn::Set(f, axis.forward.x), fy = hn::Set(f, axis.forward.y), fz = hn::Set(f, axis.forward.z);
  const auto shift = hn::Set(d, axis.shift);
  const HitBatch& hits = found.hits;
  for (size_t i = 0; i < static_cast<size_t>(rays.count); i += hn::Lanes(f)) {
    const auto seen = hn::RebindMask(f, hn::Gt(hn::LoadU(i32, found.object + i), hn::Set(i32, -1)));
    const VF vx = hn::Load(f, rays.direction_x + i), vy = hn::Load(f, rays.direction_y + i), vz = hn::Load(f, rays.direction_z + i);
    const VF nx = hn::Load(f, hits.normal_x + i), ny = hn::Load(f, hits.normal_y + i), nz = hn::Load(f, hits.normal_z + i);
    if (wanted.depth) {
      const VF from_eye = hn::DemoteTo(f, hn::Add(shift, hn::PromoteTo(d, hn::Load(f, hits.t + i))));
      hn::Store(hn::IfThenElse(seen, hn::Mul(from_eye, dot(vx, vy, vz, fx, fy, fz)), far), f, out.depth + i);
    }
    if (wanted.normal) {
      hn::StoreInterleaved3(hn::IfThenElseZero(seen, nx), hn::IfThenElseZero(seen, ny), hn::IfThenElseZero(seen, nz), f, &out.normal[i].x);
    }
    if (wanted.n_dot_v) {
      const VF facing = hn::Min(hn::Max(hn::Neg(dot(nx, ny, nz, vx, vy, vz)), zero), hn::Set(f, 1.0f));
      hn::Store(hn::IfThenElseZero(seen, facing), f, out.n_dot_v + i);
    }
  }
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
HWY_EXPORT(FillLanes);
void lane_layers(const RayBatch& rays, const SceneHits& found, const DepthAxis& axis, const GBufferLayers& wanted, LaneLayers& out) {
  HWY_DYNAMIC_DISPATCH(FillLanes)(rays, found, axis, wanted, out);
}
}  // namespace limn
#endif
