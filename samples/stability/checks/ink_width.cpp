// How wide ink is where it is widest, whatever it follows: the largest disc that lies in ink of one sheet of surface. Where one sheet ends
// before another each has a border of its own, and the two may touch.

#include <algorithm>
#include <cmath>

#include "raymarch/border/radial_curvature.h"
#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

constexpr int kReach = 64;  // No ink that is wider than twice this need be told from the rest.
constexpr int kSide = 2 * kReach + 1;

struct Offset {
  int dx, dy;
  double distance;  ///< From the middle of a pixel to the nearest point of the one at the offset, in px.
};

/// Nearest first.
std::vector<Offset> offsets() {
  std::vector<Offset> result;
  for (int dy = -kReach; dy <= kReach; ++dy) {
    for (int dx = -kReach; dx <= kReach; ++dx) {
      if (dx == 0 && dy == 0) continue;
      result.push_back({dx, dy, std::hypot(std::max(std::abs(dx) - 0.5, 0.0), std::max(std::abs(dy) - 0.5, 0.0))});
    }
  }
  std::stable_sort(result.begin(), result.end(), [](const Offset& a, const Offset& b) { return a.distance < b.distance; });
  return result;
}

/// Ink spreads from a pixel to neighbours on the same sheet, nearest first; how far away the first is that it does not come to.
class Spread {
 public:
  Spread(const BorderInput& input, const Image<float>& ink) : input_(input), ink_(ink), order_(offsets()), come_(kSide * kSide, 0) {}

  double from(int x, int y) {
    const size_t middle = cell(0, 0);
    come_[middle] = 1;
    size_t next = 0;
    while (next < order_.size() && comes(x, y, order_[next])) come_[cell(order_[next].dx, order_[next].dy)] = 1, ++next;
    come_[middle] = 0;
    for (size_t k = 0; k < next; ++k) come_[cell(order_[k].dx, order_[k].dy)] = 0;
    return next < order_.size() ? order_[next].distance : kReach;
  }

 private:
  static size_t cell(int dx, int dy) { return static_cast<size_t>((dy + kReach) * kSide + dx + kReach); }

  bool comes(int x, int y, const Offset& to) const {
    if (!ink_.inside(x + to.dx, y + to.dy) || !(ink_.at(x + to.dx, y + to.dy) > 0.5f)) return false;
    const Image<std::int32_t>& id = input_.gbuffer.id;
    const size_t there = id.index(x + to.dx, y + to.dy);
    for (int ny = std::max(to.dy - 1, -kReach); ny <= std::min(to.dy + 1, kReach); ++ny) {
      for (int nx = std::max(to.dx - 1, -kReach); nx <= std::min(to.dx + 1, kReach); ++nx) {
        if (come_[cell(nx, ny)] == 0) continue;
        const size_t here = id.index(x + nx, y + ny);
        if (id.pixels[here] != id.pixels[there]) continue;
        if (id.pixels[here] == 0 || same_sheet(input_, here, there, 1)) return true;
      }
    }
    return false;
  }

  const BorderInput& input_;
  const Image<float>& ink_;
  std::vector<Offset> order_;
  std::vector<std::uint8_t> come_;
};

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  Worst worst;
  for (const StabilityView& view : context.views()) {
    const Border border = draw_border(context.stage(), view, *method);
    const BorderInput input{view.seen, view.camera, context.stage().model, context.stage().scene};
    Spread spread(input, border.coverage);
    double widest = 0.0;
    glm::ivec2 at(0);
    for (int y = 0; y < view.seen.height; ++y) {
      for (int x = 0; x < view.seen.width; ++x) {
        if (!(border.coverage.at(x, y) > 0.5f)) continue;
        const double width = 2.0 * spread.from(x, y);
        if (width > widest) widest = width, at = {x, y};
      }
    }
    worst.see(widest == 0.0 ? 1e3 : widest - with.number("width"),
              widest == 0.0 ? "no ink at all" : fmt::format("{:.1f} px wide where it is widest, at ({}, {})", widest, at.x, at.y),
              context.stage(), view, &border);
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
