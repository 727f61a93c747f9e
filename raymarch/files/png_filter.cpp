#include "raymarch/files/png_filter.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/files/png_filter.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Bytes = hn::ScalableTag<std::uint8_t>;
using Sums = hn::Repartition<std::uint64_t, Bytes>;

/// Sizes as signed numbers, added to eight bytes' sums.
HWY_INLINE hn::Vec<Sums> with_sizes(hn::Vec<Sums> sums, hn::Vec<Bytes> bytes) {
  return hn::Add(sums, hn::SumsOf8(hn::Min(bytes, hn::Sub(hn::Zero(Bytes()), bytes))));
}

std::uint64_t size_of(std::uint8_t byte) { return byte < 128 ? byte : 256u - byte; }

/// Sums of sizes by each filter, of all but the first pixel.
void sum_sizes(const std::uint8_t* row, const std::uint8_t* above, size_t pixel_bytes, size_t count, std::uint64_t* sizes) {
  const size_t lanes = hn::Lanes(Bytes());
  hn::Vec<Sums> plain = hn::Zero(Sums()), beside = plain, below = plain;
  size_t i = pixel_bytes;
  for (; i + lanes <= count; i += lanes) {
    const auto bytes = hn::LoadU(Bytes(), row + i);
    plain = with_sizes(plain, bytes);
    beside = with_sizes(beside, hn::Sub(bytes, hn::LoadU(Bytes(), row + i - pixel_bytes)));
    below = with_sizes(below, hn::Sub(bytes, hn::LoadU(Bytes(), above + i)));
  }
  sizes[0] = hn::GetLane(hn::SumOfLanes(Sums(), plain));
  sizes[1] = hn::GetLane(hn::SumOfLanes(Sums(), beside));
  sizes[2] = hn::GetLane(hn::SumOfLanes(Sums(), below));
  for (; i < count; ++i) {
    sizes[0] += size_of(row[i]);
    sizes[1] += size_of(static_cast<std::uint8_t>(row[i] - row[i - pixel_bytes]));
    sizes[2] += size_of(static_cast<std::uint8_t>(row[i] - above[i]));
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(sum_sizes);

constexpr size_t kFilters = 3;

/// The filter to use, for a row that is neither empty nor the one above.
size_t best_filter(std::span<const std::uint8_t> row, const std::uint8_t* above, size_t pixel_bytes) {
  std::array<std::uint64_t, kFilters> sizes{};
  // Without a row above: the row less itself would be nothing, which is not to be chosen.
  HWY_DYNAMIC_DISPATCH(sum_sizes)(row.data(), above != nullptr ? above : row.data(), pixel_bytes, row.size(), sizes.data());
  for (size_t i = 0; i < pixel_bytes; ++i) {
    const auto size = [](int byte) { return static_cast<std::uint64_t>(std::abs(static_cast<std::int8_t>(byte))); };
    sizes[0] += size(row[i]);
    sizes[1] += size(row[i]);
    sizes[2] += above != nullptr ? size(row[i] - above[i]) : 0;
  }
  const auto end = above != nullptr ? sizes.end() : sizes.begin() + 2;
  return static_cast<size_t>(std::min_element(sizes.begin(), end) - sizes.begin());
}

}  // namespace

bool filter_png_row(std::span<const std::uint8_t> row, const std::uint8_t* above, size_t pixel_bytes, std::uint8_t* to) {
  const size_t count = row.size();
  const std::uint8_t* const bytes = row.data();
  // As most rows of background are, empty or the same as the row above: no other filter leaves less than nothing, and what is found first
  // stays. A row is empty where each byte is the one before it, and the first is nought.
  const bool is_empty = bytes[0] == 0 && std::memcmp(bytes, bytes + 1, count - 1) == 0;
  if (is_empty || (above != nullptr && std::memcmp(bytes, above, count) == 0)) {
    *to = is_empty ? 0 : 2;
    std::fill_n(to + 1, count, std::uint8_t{0});
    return true;
  }
  const size_t filter = best_filter(row, above, pixel_bytes);
  *to++ = static_cast<std::uint8_t>(filter);
  if (filter == 0) {
    std::copy_n(bytes, count, to);
  } else if (filter == 1) {
    std::copy_n(bytes, pixel_bytes, to);
    for (size_t i = pixel_bytes; i < count; ++i) to[i] = static_cast<std::uint8_t>(bytes[i] - bytes[i - pixel_bytes]);
  } else {
    for (size_t i = 0; i < count; ++i) to[i] = static_cast<std::uint8_t>(bytes[i] - above[i]);
  }
  return false;
}

}  // namespace limn
#endif
