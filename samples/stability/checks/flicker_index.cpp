// Ink that flutters under a trembling camera, beyond what the true border's does.

#include "raymarch/flips.h"
#include "raymarch/frames.h"
#include "raymarch/truth.h"
#include "samples/stability/checks/registry.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

StabilityFinding run(Workshop& shop, const MethodCall* method, const Parameters& with) {
  Worst worst;
  const StabilityStage& stage = shop.stage();
  FramePath path;
  path.frames = with.integer("frames");
  path.seed = 1 + static_cast<std::uint64_t>(1e6 * shop.random().next());
  for (const StabilityView& view : shop.views()) {
    const std::vector<Camera> cameras = path_cameras(view.camera, bounds(stage.scene), path);
    FlipHistory history;
    FrameFlips sum;
    GBuffer seen_before;
    Border last;
    for (size_t k = 0; k < cameras.size(); ++k) {
      GBuffer seen = render_gbuffer(stage.model, cameras[k], shop.how());
      Image<std::int32_t> pixels;
      if (k > 0) pixels = pixels_before(seen, cameras[k], seen_before, cameras[k - 1]);
      const BorderBefore before{last.coverage, pixels};
      Border border = method->method->draw({seen, cameras[k], stage.model, stage.scene, k > 0 ? &before : nullptr}, method->parameters);
      const BorderTruth truth = solve_truth(shop.truth_scene(), cameras[k], {.threshold = with.number("threshold")}, shop.how());
      const FrameFlips flips = count_flips({border.coverage, pixels}, {truth.coverage, pixels}, history);
      sum.flips += flips.flips;
      sum.reference_flips += flips.reference_flips;
      sum.beyond += flips.beyond;
      if (k > 0) sum.border += flips.border;
      seen_before = std::move(seen);
      last = std::move(border);
    }
    const double index = sum.border > 0 ? static_cast<double>(sum.beyond) / static_cast<double>(sum.border) : 1.0;
    worst.see(index,
              fmt::format("{} of {} flips in {} frames are not the true border's ({} of its own), for {} pixels of border", sum.beyond,
                          sum.flips, path.frames, sum.reference_flips, sum.border),
              stage, view, &last);
  }
  return worst.take();
}

}  // namespace

StabilityCheck flicker_index_check() {
  return {{"flicker_index",
           "flips of ink beyond the true border's, for each pixel of border and frame, while the camera wanders within a pixel", "limn"},
          "",
          true,
          {stability_whole("frames", 6, 2, 1000, "of the wander"), stability_number("threshold", 0.4, "", "of the rim")},
          run};
}

}  // namespace limn
