// Which pixel showed the same before: several pixels of a row at a time, in double precision.

#include <algorithm>
#include <cmath>
#include <utility>

#include "raymarch/frames.h"
#include "raymarch/gbuffer/picture_rows.h"
#include "sdf/error.h"
#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/picture/pixels_before.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

constexpr double kSameNormal = 0.25;  // radians
constexpr std::int32_t kNone = -1;

/// A frame and the camera that saw it.
struct Frame {
  const GBuffer& seen;
  const Camera& camera;
};

using D = hn::ScalableTag<double>;
using F = hn::Rebind<float, D>;
using I = hn::Rebind<std::int32_t, D>;
using VD = hn::Vec<D>;
using VI = hn::Vec<I>;
using MD = hn::Mask<D>;

HWY_INLINE VD Of(double value) { return hn::Set(D(), value); }

struct Vectors {
  VD x, y, z;
};

HWY_INLINE Vectors Of(const glm::dvec3& v) { return {Of(v.x), Of(v.y), Of(v.z)}; }
HWY_INLINE Vectors Plus(const Vectors& a, const Vectors& b) { return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)}; }
HWY_INLINE Vectors Minus(const Vectors& a, const Vectors& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
HWY_INLINE Vectors Times(const Vectors& a, VD by) { return {hn::Mul(a.x, by), hn::Mul(a.y, by), hn::Mul(a.z, by)}; }
HWY_INLINE VD Dot(const Vectors& a, const Vectors& b) { return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z)); }

/// What a pixel takes at a depth, world units.
HWY_INLINE VD UnitsPerPixel(const Camera& camera, VD depth) {
  return camera.projection == Projection::orthographic ? Of(1.0 / camera.pixels_per_unit) : hn::Mul(depth, Of(1.0 / camera.focal_px));
}

/// The surface's points where pixels saw it. World positions are kept as floats; far from the origin the depth is what still has its
/// digits.
HWY_INLINE Vectors PointsAt(const Frame& frame, VD column, VD row, VD depth) {
  const Camera& camera = frame.camera;
  const glm::dmat3& axes = camera.world_from_camera;
  const VD x = hn::Sub(hn::Add(column, Of(frame.seen.sample.x)), Of(0.5 * camera.width_px)),
           y = hn::Sub(Of(0.5 * camera.height_px), hn::Add(row, Of(frame.seen.sample.y)));
  const VD units = UnitsPerPixel(camera, depth);
  const Vectors across = Plus(Times(Of(axes[0]), hn::Mul(x, units)), Times(Of(axes[1]), hn::Mul(y, units)));
  return Plus(Of(camera.eye), Minus(across, Times(Of(axes[2]), depth)));
}

HWY_INLINE VD Doubles(hn::Vec<F> v) { return hn::PromoteTo(D(), v); }

/// What the frame before has at pixels.
struct SeenBefore {
  VI id;
  VD depth;
  Vectors normal;
};

HWY_INLINE Vectors NormalsFrom(const glm::vec3* from) {
  hn::Vec<F> x, y, z;
  hn::LoadInterleaved3(F(), &from->x, x, y, z);
  return {Doubles(x), Doubles(y), Doubles(z)};
}

/// Where nothing moves by much, pixels side by side were side by side before: loads take a fraction of what gathers take.
HWY_INLINE SeenBefore SeenAt(const GBuffer& seen, VI pixel) {
  const I i32;
  const std::int32_t first = hn::GetLane(pixel);
  if (hn::AllTrue(i32, hn::Eq(pixel, hn::Iota(i32, first)))) {
    const auto at = static_cast<size_t>(first);
    return {hn::LoadU(i32, seen.id.pixels.data() + at), Doubles(hn::LoadU(F(), seen.depth.pixels.data() + at)),
            NormalsFrom(seen.normal.pixels.data() + at)};
  }
  const VI of_normal = hn::Mul(pixel, hn::Set(i32, 3));
  const auto gathered = [](const float* from, VI index) { return Doubles(hn::GatherIndex(F(), from, index)); };
  const glm::vec3* const normals = seen.normal.pixels.data();
  return {hn::GatherIndex(i32, seen.id.pixels.data(), pixel),
          gathered(seen.depth.pixels.data(), pixel),
          {gathered(&normals->x, of_normal), gathered(&normals->y, of_normal), gathered(&normals->z, of_normal)}};
}

/// Pixels side by side: of this frame, and the objects that the frame before has at the same places.
struct PixelRow {
  const std::int32_t* id;
  const float* depth;
  const glm::vec3* normal;
  const std::int32_t* id_before;
};

/// Where the camera before saw points: pixels, rounded, and the world units that one takes there.
struct ImageBefore {
  VD x, y, units;
  MD inside;
};

HWY_INLINE ImageBefore Project(const Frame& before, const Vectors& points) {
  const Camera& camera = before.camera;
  const glm::dmat3& axes = camera.world_from_camera;
  const Vectors away = Minus(points, Of(camera.eye));
  const VD z = hn::Neg(Dot(away, Of(axes[2]))), zero = Of(0.0);
  ImageBefore image;
  image.units = UnitsPerPixel(camera, z);
  const VD scale = camera.projection == Projection::orthographic ? Of(camera.pixels_per_unit) : hn::Div(Of(camera.focal_px), z);
  const auto pixel_of = [](VD place, double sample) { return hn::Floor(hn::Add(hn::Sub(place, Of(sample)), Of(0.5))); };
  image.x = pixel_of(hn::Add(Of(0.5 * camera.width_px), hn::Mul(scale, Dot(away, Of(axes[0])))), before.seen.sample.x);
  image.y = pixel_of(hn::Sub(Of(0.5 * camera.height_px), hn::Mul(scale, Dot(away, Of(axes[1])))), before.seen.sample.y);
  image.inside = hn::And(hn::And(hn::Gt(z, zero), hn::And(hn::Ge(image.x, zero), hn::Ge(image.y, zero))),
                         hn::And(hn::Lt(image.x, Of(before.seen.width)), hn::Lt(image.y, Of(before.seen.height))));
  return image;
}

/// A register of pixels, the first of which is the picture's i-th, at `column` and `row`.
HWY_INLINE VI BeforePacket(const Frame& now, const Frame& before, const PixelRow& pixels, size_t i, double column, double row) {
  const I i32;
  const VI none = hn::Set(i32, kNone), id = hn::LoadU(i32, pixels.id), was = hn::LoadU(i32, pixels.id_before);
  const auto missed = hn::Eq(id, hn::Zero(i32));
  const VI of_missed = hn::IfThenElse(hn::Eq(was, hn::Zero(i32)), hn::Iota(i32, static_cast<std::int32_t>(i)), none);
  if (hn::AllTrue(i32, missed)) return of_missed;
  const VD depth = hn::PromoteTo(D(), hn::LoadU(F(), pixels.depth));
  const Vectors points = PointsAt(now, hn::Iota(D(), column), Of(row), depth);
  const ImageBefore image = Project(before, points);
  const VD place = hn::Add(hn::Mul(image.y, Of(before.seen.width)), image.x);
  const VI there = hn::DemoteTo(i32, hn::IfThenElseZero(image.inside, place));
  const SeenBefore other = SeenAt(before.seen, there);
  const MD same_object = hn::Eq(hn::PromoteTo(D(), other.id), hn::PromoteTo(D(), id));
  const Vectors normal = NormalsFrom(pixels.normal);
  const MD turns = hn::Lt(Dot(normal, other.normal), Of(std::cos(kSameNormal)));
  // Where normals turn by less than an angle, the way between two points leaves the tangent plane by less than that. A pixel on top, for
  // ways so short that they are the depths' rounding.
  const Vectors way = Minus(PointsAt(before, image.x, image.y, other.depth), points);
  const VD length = hn::Add(hn::Sqrt(Dot(way, way)), image.units);
  const MD leaves = hn::Gt(hn::Abs(Dot(way, normal)), hn::Mul(Of(std::sin(kSameNormal)), length));
  const MD followed = hn::AndNot(hn::Or(turns, leaves), hn::And(image.inside, same_object));
  return hn::IfThenElse(missed, of_missed, hn::DemoteTo(i32, hn::IfThenElse(followed, place, Of(kNone))));
}

constexpr size_t kMostLanes = HWY_LANES(double);

/// The last pixels of a row, fewer than a register has, through memory that is large enough.
void BeforeRest(const Frame& now, const Frame& before, const PixelRow& pixels, size_t count, size_t i, double column, double row,
                std::int32_t* to) {
  std::int32_t id[kMostLanes] = {}, id_before[kMostLanes] = {}, out[kMostLanes];
  float depth[kMostLanes] = {};
  glm::vec3 normal[kMostLanes] = {};
  std::copy_n(pixels.id, count, id);
  std::copy_n(pixels.id_before, count, id_before);
  std::copy_n(pixels.depth, count, depth);
  std::copy_n(pixels.normal, count, normal);
  hn::StoreU(BeforePacket(now, before, {id, depth, normal, id_before}, i, column, row), I(), out);
  std::copy_n(out, count, to);
}

void BeforeRow(const GBuffer& seen, const Camera& camera, const GBuffer& seen_before, const Camera& camera_before, int row,
               std::int32_t* to) {
  const Frame now{seen, camera}, before{seen_before, camera_before};
  const auto width = static_cast<size_t>(now.seen.width), lanes = hn::Lanes(D());
  const size_t first = now.seen.id.index(0, row);
  for (size_t x = 0; x < width; x += lanes) {
    const size_t i = first + x;
    const PixelRow pixels{now.seen.id.pixels.data() + i, now.seen.depth.pixels.data() + i, now.seen.normal.pixels.data() + i,
                          before.seen.id.pixels.data() + i};
    const auto column = static_cast<double>(x);
    if (x + lanes <= width)
      hn::StoreU(BeforePacket(now, before, pixels, i, column, row), I(), to + x);
    else
      BeforeRest(now, before, pixels, width - x, i, column, row, to + x);
  }
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(BeforeRow);
}  // namespace

Image<std::int32_t> pixels_before(const GBuffer& now, const Camera& camera, const GBuffer& before, const Camera& camera_before,
                                  Image<std::int32_t> memory) {
  LIMN_CHECK(now.width == before.width && now.height == before.height);
  const bool fits = memory.width == now.width && memory.height == now.height;
  Image<std::int32_t> result = fits ? std::move(memory) : Image<std::int32_t>::unset(now.width, now.height);
  for_each_band(now.height, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) HWY_DYNAMIC_DISPATCH(BeforeRow)(now, camera, before, camera_before, y, &result.at(0, y));
  });
  return result;
}

}  // namespace limn
#endif
