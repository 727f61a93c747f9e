// The frame is no border: what is cut by it has no line along it.

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

/// The same view with more around it.
StabilityView wider(const StabilityStage& stage, const StabilityView& view, int margin_px, const ExecutionSettings& how) {
  StabilityView out = view;
  out.camera.width_px += 2 * margin_px;
  out.camera.height_px += 2 * margin_px;
  out.seen = render_gbuffer(stage.model, out.camera, how);
  return out;
}

bool ink_near(const Image<float>& ink, int x, int y) {
  for (int v = y - 2; v <= y + 2; ++v) {
    for (int u = x - 2; u <= x + 2; ++u) {
      if (ink.inside(u, v) && ink.at(u, v) > 0.5f) return true;
    }
  }
  return false;
}

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  const int margin = with.integer("margin_px"), edge = with.integer("edge_px");
  Worst worst;
  for (const StabilityView& view : context.views()) {
    const StabilityStage& stage = context.stage();
    const Border border = draw_border(stage, view, *method), whole = draw_border(stage, wider(stage, view, margin, context.how()), *method);
    const Image<float>& ink = border.coverage;
    std::int64_t cut = 0, inked = 0;
    for (int y = 0; y < ink.height; ++y) {
      for (int x = 0; x < ink.width; ++x) {
        if (x >= edge && y >= edge && x + edge < ink.width && y + edge < ink.height) continue;
        cut += view.seen.id.at(x, y) != 0;
        inked += ink.at(x, y) > 0.5f && !ink_near(whole.coverage, x + margin, y + margin);
      }
    }
    worst.see(cut == 0 ? kNothingSeen : static_cast<double>(inked),
              fmt::format("{} of {} pixels along the frame inked that a larger picture leaves bare", inked, cut), stage, view, &border);
  }
  return worst.take();
}

}  // namespace

StabilityCheck frame_free_check() {
  return {{"frame_free", "pixels inked along the frame, where a picture that shows more has no ink", "limn"},
          "pixels",
          true,
          {stability_whole("margin_px", 24, 1, 1000, "that the larger picture has more on each side"),
           stability_whole("edge_px", 3, 1, 64, "from the frame that are looked at")},
          run};
}

}  // namespace limn
