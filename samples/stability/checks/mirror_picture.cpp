// A scene and its mirror image draw mirror images.

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

/// Whether something like it is within reach of the mirrored place.
template <class Alike>
bool counterpart(const Image<float>& ink, int x, int y, int reach, const Alike& alike) {
  const int mirrored = ink.width - 1 - x;
  for (int v = y - reach; v <= y + reach; ++v) {
    for (int u = mirrored - reach; u <= mirrored + reach; ++u) {
      if (ink.inside(u, v) && alike(ink.index(u, v))) return true;
    }
  }
  return false;
}

struct Shot {
  const GBuffer& seen;
  const Image<float>& ink;
};

/// Pixels of `a` that have nothing alike in `b`.
std::int64_t without_counterpart(const Shot& a, const Shot& b, int reach) {
  std::int64_t count = 0;
  for (int y = 0; y < a.ink.height; ++y) {
    for (int x = 0; x < a.ink.width; ++x) {
      const size_t i = a.ink.index(x, y);
      const bool object = counterpart(b.ink, x, y, reach, [&](size_t j) { return a.seen.id.pixels[i] == b.seen.id.pixels[j]; });
      const bool inked = !(a.ink.pixels[i] > 0.5f) || counterpart(b.ink, x, y, reach, [&](size_t j) { return b.ink.pixels[j] > 0.5f; });
      count += !object || !inked;
    }
  }
  return count;
}

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  const int reach = with.integer("reach_px");
  Worst worst;
  for (size_t variant = 1; variant <= context.which().variants.size(); ++variant) {
    const StabilityStage& changed = context.stage(variant);
    for (size_t k = 0; k < context.views().size(); ++k) {
      const StabilityView &view = context.views()[k], &other = context.views(variant)[k];
      const Border border = draw_border(context.stage(), view, *method), other_border = draw_border(changed, other, *method);
      const Shot a{view.seen, border.coverage}, b{other.seen, other_border.coverage};
      const std::int64_t different = without_counterpart(a, b, reach) + without_counterpart(b, a, reach);
      const bool empty = count_hits(view.seen).hits == 0;
      worst.see(empty ? kNothingSeen : static_cast<double>(different),
                empty ? "nothing is seen"
                      : fmt::format("{} pixels have no counterpart in the mirrored picture with {}", different, changed.variant.words),
                changed, other, &other_border);
    }
  }
  return worst.take();
}

}  // namespace

StabilityCheck mirror_picture_check() {
  return {{"mirror_picture", "pixels without a counterpart in the picture of a variant that is the scene mirrored in x", "limn"},
          "pixels",
          true,
          {stability_whole("reach_px", 1, 0, 16, "how far from the mirrored place it may lie: some methods look to one side")},
          run};
}

}  // namespace limn
