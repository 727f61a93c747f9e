#include "raymarch/picture/pixel_lanes.h"

#include <algorithm>
#include <array>

#include "raymarch/picture/srgb_bytes.h"
#include "sdf/error.h"
#include "sdf/parallel.h"
#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/picture/pixel_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using F = hn::ScalableTag<float>;
using I = hn::RebindToSigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;

static_assert(sizeof(glm::vec4) == 4 * sizeof(float) && sizeof(glm::u8vec4) == sizeof(std::int32_t));

struct Rgba {
  VF red, green, blue, alpha;
};

HWY_INLINE Rgba Load(const glm::vec4* from) {
  Rgba color;
  hn::LoadInterleaved4(F(), &from->x, color.red, color.green, color.blue, color.alpha);
  return color;
}

HWY_INLINE void Store(const Rgba& color, glm::vec4* to) {
  hn::StoreInterleaved4(color.red, color.green, color.blue, color.alpha, F(), &to->x);
}

HWY_INLINE Rgba LoadPlanes(const float* from, size_t plane) {
  const F f;
  return {hn::LoadU(f, from), hn::LoadU(f, from + plane), hn::LoadU(f, from + 2 * plane), hn::LoadU(f, from + 3 * plane)};
}

HWY_INLINE void StorePlanes(const Rgba& color, float* to, size_t plane) {
  const F f;
  hn::StoreU(color.red, f, to);
  hn::StoreU(color.green, f, to + plane);
  hn::StoreU(color.blue, f, to + 2 * plane);
  hn::StoreU(color.alpha, f, to + 3 * plane);
}

HWY_INLINE Rgba Headlight(const ColorsById& colors, const PixelRun& run, size_t i) {
  const F f;
  const VI id = hn::LoadU(I(), run.id + i);
  const VF light = hn::Add(hn::Set(f, 0.25f), hn::Mul(hn::Set(f, 0.75f), hn::LoadU(f, run.n_dot_v + i)));
  const VF alpha = hn::IfThenElseZero(hn::RebindMask(f, hn::Ne(id, hn::Zero(I()))), hn::Set(f, 1.0f));
  const std::int32_t first = run.id[i];
  if (hn::AllTrue(I(), hn::Eq(id, hn::Set(I(), first)))) {  // as within objects; gathers take longer than all the rest
    const auto of_one = [&](const std::vector<float>& channel) { return hn::Mul(hn::Set(f, channel[static_cast<size_t>(first)]), light); };
    return {of_one(colors.red), of_one(colors.green), of_one(colors.blue), alpha};
  }
  const auto of_each = [&](const std::vector<float>& channel) { return hn::Mul(hn::GatherIndex(f, channel.data(), id), light); };
  return {of_each(colors.red), of_each(colors.green), of_each(colors.blue), alpha};
}

HWY_INLINE void LayInk(const glm::vec3& ink, VF share, Rgba& color) {
  const F f;
  const VF rest = hn::Sub(hn::Set(f, 1.0f), share);
  const auto under = [&](VF below, float on_top) { return hn::Add(hn::Mul(rest, below), hn::Mul(share, hn::Set(f, on_top))); };
  color = {under(color.red, ink.x), under(color.green, ink.y), under(color.blue, ink.z), under(color.alpha, 1.0f)};
}

HWY_INLINE void FinishPixels(const Finish& finish, VF& ink, Rgba& color) {
  const F f;
  const VF share = hn::Set(f, finish.share);
  ink = hn::Mul(ink, share);
  color = {hn::Mul(color.red, share), hn::Mul(color.green, share), hn::Mul(color.blue, share), hn::Mul(color.alpha, share)};
  if (!finish.background) return;
  const VF open = hn::Sub(hn::Set(f, 1.0f), color.alpha);
  const auto over = [&](VF front, float behind) { return hn::Add(front, hn::Mul(open, hn::Set(f, behind))); };
  color = {over(color.red, finish.background->x), over(color.green, finish.background->y), over(color.blue, finish.background->z),
           over(color.alpha, 1.0f)};
}

/// As SrgbBytes.
HWY_INLINE VI SrgbCodes(const std::int32_t* first, const float* next, VF linear) {
  const F f;
  const I i32;
  const VF low = hn::Set(f, 0x1p-13f), one = hn::Set(f, 1.0f);
  const auto above = hn::Ge(linear, low);
  const VF within = hn::Min(hn::IfThenElse(above, linear, low), hn::Set(f, 0x1.fffffep-1f));
  constexpr int kShift = 23 - SrgbBytes::kMantissaBits;
  const VI key = hn::Sub(hn::ShiftRight<kShift>(hn::BitCast(i32, within)),
                         hn::Set(i32, std::int32_t{SrgbBytes::kFirstExponent} << SrgbBytes::kMantissaBits));
  const VI more = hn::VecFromMask(i32, hn::RebindMask(i32, hn::Ge(within, hn::GatherIndex(f, next, key))));
  const VI code = hn::Sub(hn::GatherIndex(i32, first, key), more);  // a mask is -1
  return hn::IfThenElse(hn::RebindMask(i32, hn::Ge(linear, one)), hn::Set(i32, 255), hn::IfThenElseZero(hn::RebindMask(i32, above), code));
}

/// As to_byte().
HWY_INLINE VI Codes(VF value) {
  const F f;
  const I i32;
  const VF positive = hn::IfThenElseZero(hn::Gt(value, hn::Zero(f)), value);
  const VF parts = hn::Mul(hn::Set(f, 255.0f), hn::Min(positive, hn::Set(f, 1.0f)));
  const VI whole = hn::ConvertTo(i32, parts);
  const auto up = hn::Ge(hn::Sub(parts, hn::ConvertTo(f, whole)), hn::Set(f, 0.5f));
  return hn::Sub(whole, hn::VecFromMask(i32, hn::RebindMask(i32, up)));
}

HWY_INLINE void StoreBytes(const SrgbBytes& srgb, Rgba color, glm::u8vec4* to) {
  const F f;
  const I i32;
  const VF one = hn::Set(f, 1.0f);
  if (!hn::AllTrue(f, hn::Eq(color.alpha, one))) {
    const VF by = hn::IfThenElse(hn::Gt(color.alpha, hn::Zero(f)), color.alpha, one);
    color = {hn::Div(color.red, by), hn::Div(color.green, by), hn::Div(color.blue, by), color.alpha};
  }
  const std::int32_t* const first = srgb.first().data();
  const float* const next = srgb.next().data();
  const VI red = SrgbCodes(first, next, color.red), green = SrgbCodes(first, next, color.green), blue = SrgbCodes(first, next, color.blue);
  const VI pixel = hn::Or(hn::Or(red, hn::ShiftLeft<8>(green)), hn::Or(hn::ShiftLeft<16>(blue), hn::ShiftLeft<24>(Codes(color.alpha))));
  hn::StoreU(pixel, i32, reinterpret_cast<std::int32_t*>(to));
}

/// A register of pixels, from the i-th on.
HWY_INLINE void ComposePacket(const PixelStage& stage, const SrgbBytes& srgb, const PixelRun& run, size_t i) {
  const F f;
  const VF one = hn::Set(f, 1.0f);
  Rgba color = Headlight(*stage.colors, run, i);
  VF ink = hn::Zero(f);
  for (size_t m = 0; m < stage.inks.size(); ++m) {
    const VF share = hn::LoadU(f, run.coverage[m] + i);
    ink = hn::Sub(one, hn::Mul(hn::Sub(one, ink), hn::Sub(one, share)));
    LayInk(stage.inks[m], share, color);
  }
  if (!stage.first) {
    if (run.planes != nullptr || run.composite != nullptr) {
      const Rgba sum = run.planes != nullptr ? LoadPlanes(run.planes + i, run.plane) : Load(run.composite + i);
      color = {hn::Add(sum.red, color.red), hn::Add(sum.green, color.green), hn::Add(sum.blue, color.blue),
               hn::Add(sum.alpha, color.alpha)};
    }
    if (run.border != nullptr) ink = hn::Add(hn::LoadU(f, run.border + i), ink);
  }
  if (stage.finish != nullptr) FinishPixels(*stage.finish, ink, color);
  if (run.border != nullptr) hn::StoreU(ink, f, run.border + i);
  if (run.bytes != nullptr)
    StoreBytes(srgb, color, run.bytes + i);
  else if (run.planes != nullptr)
    StorePlanes(color, run.planes + i, run.plane);
  else if (run.composite != nullptr)
    Store(color, run.composite + i);
}

constexpr size_t kMostLanes = HWY_LANES(float);

/// The last pixels of a run, fewer than a register has, through memory that is large enough.
void ComposeRest(const PixelStage& stage, const SrgbBytes& srgb, const PixelRun& run, size_t i) {
  const size_t count = run.count - i;
  float n_dot_v[kMostLanes] = {}, border[kMostLanes] = {};
  std::int32_t id[kMostLanes] = {};
  glm::vec4 composite[kMostLanes] = {};
  float planes[4 * kMostLanes] = {};
  glm::u8vec4 bytes[kMostLanes] = {};
  std::vector<std::array<float, kMostLanes>> coverage(run.coverage.size());
  std::vector<const float*> inks;
  for (size_t m = 0; m < coverage.size(); ++m) {
    coverage[m].fill(0.0f);
    std::copy_n(run.coverage[m] + i, count, coverage[m].begin());
    inks.push_back(coverage[m].data());
  }
  std::copy_n(run.n_dot_v + i, count, n_dot_v);
  std::copy_n(run.id + i, count, id);
  if (!stage.first && run.composite != nullptr) std::copy_n(run.composite + i, count, composite);
  const auto each_plane = [&](const auto& visit) {
    for (size_t k = 0; run.planes != nullptr && k < 4; ++k) visit(run.planes + k * run.plane + i, planes + k * kMostLanes);
  };
  if (!stage.first) each_plane([&](const float* from, float* to) { std::copy_n(from, count, to); });
  if (!stage.first && run.border != nullptr) std::copy_n(run.border + i, count, border);
  ComposePacket(stage, srgb,
                {kMostLanes, n_dot_v, id, inks, run.border != nullptr ? border : nullptr, composite,
                 run.planes != nullptr ? planes : nullptr, kMostLanes, run.bytes != nullptr ? bytes : nullptr},
                0);
  if (run.border != nullptr) std::copy_n(border, count, run.border + i);
  if (run.bytes != nullptr)
    std::copy_n(bytes, count, run.bytes + i);
  else if (run.planes != nullptr)
    each_plane([&](float* to, const float* from) { std::copy_n(from, count, to); });
  else if (run.composite != nullptr)
    std::copy_n(composite, count, run.composite + i);
}

void Compose(const PixelStage& stage, const SrgbBytes& srgb, const PixelRun& run) {
  const size_t lanes = hn::Lanes(F());
  size_t i = 0;
  for (; i + lanes <= run.count; i += lanes) ComposePacket(stage, srgb, run, i);
  if (i < run.count) ComposeRest(stage, srgb, run, i);
}

/// All pixels are as this one.
HWY_INLINE bool AllAre(const Rgba& colors, const glm::vec4& one) {
  const F f;
  const auto are = [&](VF values, float value) { return hn::Eq(values, hn::Set(f, value)); };
  return hn::AllTrue(
      f, hn::And(hn::And(are(colors.red, one.x), are(colors.green, one.y)), hn::And(are(colors.blue, one.z), are(colors.alpha, one.w))));
}

void Encode(const SrgbBytes& srgb, const glm::vec4* colors, glm::u8vec4* bytes, size_t count) {
  const size_t lanes = hn::Lanes(F());
  size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const Rgba color = Load(colors + i);
    // As most of a background is.
    if (i > 0 && AllAre(color, colors[i - 1]))
      std::fill_n(bytes + i, lanes, bytes[i - 1]);
    else
      StoreBytes(srgb, color, bytes + i);
  }
  if (i == count) return;
  glm::vec4 rest[kMostLanes] = {};
  glm::u8vec4 coded[kMostLanes];
  std::copy(colors + i, colors + count, rest);
  StoreBytes(srgb, Load(rest), coded);
  std::copy_n(coded, count - i, bytes + i);
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(Compose);
HWY_EXPORT(Encode);
}  // namespace

ColorsById colors_by_id(std::span<const glm::vec3> colors) {
  ColorsById all{{0.0f}, {0.0f}, {0.0f}};
  for (const glm::vec3& color : colors) {
    all.red.push_back(color.x);
    all.green.push_back(color.y);
    all.blue.push_back(color.z);
  }
  return all;
}

void compose_pixels(const PixelStage& stage, const PixelRun& run) {
  LIMN_CHECK(run.coverage.size() == stage.inks.size());
  HWY_DYNAMIC_DISPATCH(Compose)(stage, srgb_bytes(), run);
}

void encode_pixels(std::span<const glm::vec4> colors, std::span<glm::u8vec4> bytes) {
  LIMN_CHECK(colors.size() == bytes.size());
  HWY_DYNAMIC_DISPATCH(Encode)(srgb_bytes(), colors.data(), bytes.data(), colors.size());
}

Image<glm::u8vec4> encoded(const Image<glm::vec4>& picture) {
  auto bytes = Image<glm::u8vec4>::unset(picture.width, picture.height);
  parallel_parts(picture.size(), size_t{1} << 13, [&](const IndexRange<size_t>& part) {
    const size_t count = part.last - part.first;
    encode_pixels(std::span(picture.pixels).subspan(part.first, count), std::span(bytes.pixels).subspan(part.first, count));
  });
  return bytes;
}

}  // namespace limn
#endif
