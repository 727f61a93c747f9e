#include "raymarch/border/extrude_pixels.h"

#include <atomic>
#include <cmath>

#include "raymarch/scene/covered_pixels.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

/// Rays are traced in single precision: by so much they may miss their pixel's middle.
constexpr double kBeside_px = 0.02;
constexpr double kRounding = 1e-5;  // of depths

}  // namespace

SeenDepths::SeenDepths(const GBuffer& seen, const Camera& camera)
    : seen_(seen),
      camera_(camera),
      farthest_((seen.width + kBlock_px - 1) / kBlock_px, (seen.height + kBlock_px - 1) / kBlock_px,
                -std::numeric_limits<float>::infinity()) {
  parallel_for(0, farthest_.height, [&](int row) {
    for (int y = row * kBlock_px; y < std::min(seen.height, (row + 1) * kBlock_px); ++y)
      for (int x = 0; x < seen.width; ++x) {
        float& most = farthest_.at(x / kBlock_px, row);
        most = std::max(most, seen.depth.at(x, y));
      }
  });
}

PixelWindow SeenDepths::pixels_before(const Box& box, double beside_px) const {
  const std::optional<BoxImage> at = image_of(box, camera_);
  if (!at) return {0, 0, seen_.width, seen_.height};
  const double beside = kBeside_px + beside_px;
  const auto pixel = [](double place, int limit) { return static_cast<int>(std::clamp(place, 0.0, static_cast<double>(limit))); };
  const PixelWindow window{pixel(std::ceil(at->pixels.lower.x - beside - seen_.sample.x), seen_.width),
                           pixel(std::ceil(at->pixels.lower.y - beside - seen_.sample.y), seen_.height),
                           pixel(std::floor(at->pixels.upper.x + beside - seen_.sample.x) + 1.0, seen_.width),
                           pixel(std::floor(at->pixels.upper.y + beside - seen_.sample.y) + 1.0, seen_.height)};
  if (window.empty()) return {};
  const double nearest = at->nearest - kRounding * (std::abs(at->nearest) + box.radius());
  for (int v = window.y0 / kBlock_px; v <= (window.y1 - 1) / kBlock_px; ++v)
    for (int u = window.x0 / kBlock_px; u <= (window.x1 - 1) / kBlock_px; ++u)
      if (!(nearest > double{farthest_.at(u, v)})) return window;
  return {};
}

WindowImage<std::uint8_t> pixels_before(const std::vector<Box>& boxes, const SeenDepths& depths, const PixelWindow& window) {
  WindowImage<std::uint8_t> pixels = window_image(window, std::uint8_t{0});
  parallel_parts(boxes.size(), size_t{256}, [&](const IndexRange<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const PixelWindow seen = depths.pixels_before(boxes[i]);
      for (int y = std::max(seen.y0, window.y0); y < std::min(seen.y1, window.y1); ++y)
        for (int x = std::max(seen.x0, window.x0); x < std::min(seen.x1, window.x1); ++x)
          std::atomic_ref<std::uint8_t>(pixels.at(x, y)).store(1, std::memory_order_relaxed);
    }
  });
  return pixels;
}

}  // namespace limn
