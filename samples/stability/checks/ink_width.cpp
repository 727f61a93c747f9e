// How wide ink is where it is widest, whatever it follows: the largest disc that lies in it.

#include <cmath>

#include "samples/stability/checks/registry.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

/// To the nearest pixel without ink, in rings about this one; pixels beyond the picture have none.
double to_bare(const Image<float>& ink, int x, int y) {
  double least = 1e30;
  for (int ring = 1; ring < least; ++ring) {
    for (int i = -ring; i <= ring; ++i) {
      for (const auto& [dx, dy] : {std::pair(i, -ring), std::pair(i, ring), std::pair(-ring, i), std::pair(ring, i)}) {
        if (!ink.inside(x + dx, y + dy) || !(ink.at(x + dx, y + dy) > 0.5f)) least = std::min(least, std::hypot(dx, dy));
      }
    }
  }
  return least;
}

StabilityFinding run(Workshop& shop, const MethodCall* method, const Parameters& with) {
  Worst worst;
  for (const StabilityView& view : shop.views()) {
    const Border border = draw_border(shop.stage(), view, *method);
    double widest = 0.0;
    glm::ivec2 at(0);
    for (int y = 0; y < view.seen.height; ++y) {
      for (int x = 0; x < view.seen.width; ++x) {
        if (!(border.coverage.at(x, y) > 0.5f)) continue;
        // A line of n pixels has its middle (n + 1) / 2 from bare ones.
        const double width = 2.0 * to_bare(border.coverage, x, y) - 1.0;
        if (width > widest) widest = width, at = {x, y};
      }
    }
    worst.see(widest == 0.0 ? 1e3 : widest - with.number("width"),
              widest == 0.0 ? "no ink at all" : fmt::format("{:.1f} px wide where it is widest, at ({}, {})", widest, at.x, at.y),
              shop.stage(), view, &border);
  }
  return worst.take();
}

}  // namespace

StabilityCheck ink_width_check() {
  return {{"ink_width", "how much wider ink is at its widest than it was asked to be", "limn"},
          "px",
          true,
          {stability_number("width", 3.0, "px", "that the method was asked for")},
          run};
}

}  // namespace limn
