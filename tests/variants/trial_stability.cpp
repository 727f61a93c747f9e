// A check of stability cases, for the test of this folder: pixels of ink beyond a parameter.

#include <numeric>

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  Worst worst;
  for (const StabilityView& view : context.views()) {
    const Border border = draw_border(context.stage(), view, *method);
    const double ink = std::accumulate(border.coverage.pixels.begin(), border.coverage.pixels.end(), 0.0);
    worst.see(std::max(0.0, ink - with.number("most")), fmt::format("{} pixels of ink", ink), context.stage(), view, &border);
  }
  return worst.take();
}

}  // namespace

StabilityCheck trial_ink_check() {
  return {{"trial_ink", "pixels of ink beyond what there may be, on trial", "limn"},
          "pixels",
          true,
          {stability_number("most", 1e6, "px", "of ink that there may be")},
          run};
}

}  // namespace limn
