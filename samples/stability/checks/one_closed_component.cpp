// An outline without gaps, in one piece.

#include "raymarch/border/extrude.h"
#include "raymarch/metric.h"
#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

int pieces_of(const Image<float>& ink, const Camera& camera) {
  Picture picture;
  picture.border = ink;
  for (const MetricValue& value : find_metric("topology").measure({picture, picture, camera})) {
    if (value.name == "topology_components") return static_cast<int>(value.value);
  }
  return 0;
}

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  Worst worst;
  for (const StabilityView& view : context.views()) {
    const Border border = draw_border(context.stage(), view, *method);
    const OutlineGaps gaps = outline_gaps(view.seen, border.coverage);
    const int pieces = pieces_of(border.coverage, view.camera);
    const auto excess = std::abs(pieces - with.integer("pieces"));
    worst.see(static_cast<double>(gaps.gaps) + excess,
              fmt::format("{} gaps (longest {} px), {} piece{} of ink", gaps.gaps, gaps.longest_px, pieces, pieces == 1 ? "" : "s"),
              context.stage(), view, &border);
  }
  return worst.take();
}

}  // namespace

StabilityCheck one_closed_component_check() {
  return {{"one_closed_component", "gaps of the outline, and pieces of ink more or fewer than there should be", "limn"},
          "gaps",
          true,
          {stability_whole("pieces", 1, 0, 1000, "of ink that there should be")},
          run};
}

}  // namespace limn
