#include "sdf/band_slopes.h"

#include <bit>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sdf/band_slopes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sdf/lane_real-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {

// Rows of a block are eight nodes long.
using RowTag = hn::CappedTag<double, 8>;
using FloatTag = hn::Rebind<float, RowTag>;
using Row = hn::Vec<RowTag>;
constexpr size_t kStep = hn::MaxLanes(RowTag());

HWY_INLINE Row set(double x) { return hn::Set(RowTag(), x); }

/// Of the nodes from `at` on, in the order of glm's products and lengths.
HWY_INLINE void slopes_at(const float* at, const SlopeScale& scale, double* slopes) {
  const RowTag d;
  const auto difference = [&](std::ptrdiff_t step) {
    const auto value = [&](const float* from) { return hn::PromoteTo(d, hn::LoadU(FloatTag(), from)); };
    return hn::Mul(set(0.5), hn::Sub(value(at + step), value(at - step)));
  };
  const Row g[3] = {difference(100), difference(10), difference(1)};
  Row squares[3];
  for (int row = 0; row < 3; ++row) {
    const auto part = [&](int column) { return hn::Mul(set(scale.per_side[column][row]), g[column]); };
    const Row change = hn::Add(hn::Add(part(0), part(1)), part(2));
    squares[row] = hn::Mul(change, change);
  }
  const Row length = hn::Sqrt(hn::Add(hn::Add(squares[0], squares[1]), squares[2]));
  const Row share = hn::Div(length, set(scale.background)), most = set(1000.0);
  hn::Store(hn::Mul(set(kSlopeUnits), hn::IfThenElse(hn::Lt(share, most), share, most)), d, slopes);
}

void add_slopes(const NodeWindow& nodes, const NodeBits& inside, const ActiveRows& active, const SlopeScale& scale, SlopeSums& sums) {
  for (size_t x = 0; x < 8; ++x)
    for (size_t y = 0; y < 8; ++y) {
      const std::uint32_t own = inside.row(x + 1, y + 1) >> 1;
      const std::uint32_t along[3] = {own ^ inside.row(x + 2, y + 1) >> 1, own ^ inside.row(x + 1, y + 2) >> 1, own ^ own >> 1};
      const std::uint32_t any = (along[0] | along[1] | along[2]) & 0xffu;
      if (any == 0) continue;
      const std::uint32_t here = active[x + 2][y + 2],
                          beside = active[x + 1][y + 2] & active[x + 3][y + 2] & active[x + 2][y + 1] & active[x + 2][y + 3];
      const std::uint32_t whole = (beside & here << 1 & here >> 1) >> 2;
      HWY_ALIGN double slopes[8];
      for (size_t z = 0; z < 8; z += kStep) slopes_at(&nodes[x + 1][y + 1][z + 1], scale, slopes + z);
      for (std::uint32_t bits = any; bits != 0; bits &= bits - 1) {
        const int z = std::countr_zero(bits);
        const size_t kind = (whole >> z & 1u) != 0 ? 0 : 1;
        const std::int64_t crossings = (along[0] >> z & 1u) + (along[1] >> z & 1u) + (along[2] >> z & 1u);
        sums.sum[kind] += crossings * static_cast<std::int64_t>(slopes[z]);
        sums.count[kind] += crossings;
      }
    }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(add_slopes);
}  // namespace

void add_slopes(const NodeWindow& nodes, const NodeBits& inside, const ActiveRows& active, const SlopeScale& scale, SlopeSums& sums) {
  HWY_DYNAMIC_DISPATCH(add_slopes)(nodes, inside, active, scale, sums);
}

}  // namespace limn
#endif
