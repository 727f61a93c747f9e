// Nothing is drawn where there is no edge.

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters&) {
  Worst worst;
  for (const StabilityView& view : context.views()) {
    const Border border = draw_border(context.stage(), view, *method);
    std::int64_t inked = 0;
    float steepest = 1.0f;
    for (size_t i = 0; i < border.coverage.size(); ++i) {
      inked += border.coverage.pixels[i] > 0.0f;
      if (view.seen.id.pixels[i] != 0) steepest = std::min(steepest, view.seen.n_dot_v.pixels[i]);
    }
    worst.see(static_cast<double>(inked), fmt::format("{} of {} pixels inked, N.V from {:.3g}", inked, border.coverage.size(), steepest),
              context.stage(), view, &border);
  }
  return worst.take();
}

}  // namespace

StabilityCheck no_false_lines_check() {
  return {{"no_false_lines", "pixels inked on a surface without any edge that fills the picture", "limn"}, "pixels", true, {}, run};
}

}  // namespace limn
