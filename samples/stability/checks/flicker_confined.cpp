// Under moves of the camera by parts of a pixel ink comes and goes only where N.V is near the threshold.

#include <cmath>

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

struct Flips {
  std::int64_t count = 0;
  double farthest = 0.0;  ///< |N.V - c|, the lesser of before and after.
  glm::ivec2 at{0};
};

void compare(const GBuffer& a, const Border& ink_a, const GBuffer& b, const Border& ink_b, double c, Flips& flips) {
  for (size_t i = 0; i < a.id.size(); ++i) {
    if (a.id.pixels[i] == 0 || a.id.pixels[i] != b.id.pixels[i]) continue;
    if ((ink_a.coverage.pixels[i] > 0.5f) == (ink_b.coverage.pixels[i] > 0.5f)) continue;
    ++flips.count;
    const double far = std::min(std::abs(double{a.n_dot_v.pixels[i]} - c), std::abs(double{b.n_dot_v.pixels[i]} - c));
    if (far <= flips.farthest) continue;
    flips.farthest = far;
    flips.at = {static_cast<int>(i) % a.width, static_cast<int>(i) / a.width};
  }
}

/// The moves are the first points of a sequence this long, whatever part of it a case asks for.
constexpr int kMoves = 1024;

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  Worst worst;
  const StabilityStage& stage = context.stage();
  const int moves = with.integer("moves");
  for (const StabilityView& view : context.views()) {
    Flips flips;
    GBuffer before;
    Border ink_before;
    for (int k = 0; k <= moves; ++k) {
      GBuffer seen = k == 0 ? view.seen : render_gbuffer(stage.model, view.camera, context.how(), sample_offset(k, kMoves));
      Border ink = method->method->draw({seen, view.camera, stage.model, stage.scene}, method->parameters);
      if (k > 0) compare(before, ink_before, seen, ink, with.number("threshold"), flips);
      before = std::move(seen);
      ink_before = std::move(ink);
    }
    worst.see(flips.farthest,
              fmt::format("{} flips in {} moves, the farthest from the threshold by {:.3g} at ({}, {})", flips.count, moves, flips.farthest,
                          flips.at.x, flips.at.y),
              stage, view, &ink_before);
  }
  return worst.take();
}

}  // namespace

StabilityCheck flicker_confined_check() {
  return {{"flicker_confined", "how far N.V is from the threshold where ink flips while the camera moves by parts of a pixel", "limn"},
          "N.V",
          true,
          {stability_whole("moves", 8, 1, 1000, "of the camera"), stability_number("threshold", 0.4, "", "of the method")},
          run};
}

}  // namespace limn
