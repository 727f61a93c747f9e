// The picture changes little when a parameter does: the largest change is looked for, and its place cut smaller and smaller.

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

struct Shot {
  double at = 0.0;
  const CaseContext::Swept* swept = nullptr;
  Border border{};
  const StabilityView& view() const { return swept->views.front(); }
};

Shot shoot(CaseContext& context, const MethodCall& method, double at) {
  const CaseContext::Swept& swept = context.swept(at);
  return {at, &swept, draw_border(swept.stage, swept.views.front(), method)};
}

/// Share of the object's pixels whose ink crosses one half.
double change(const Shot& a, const Shot& b) {
  std::int64_t changed = 0, pixels = 0;
  for (size_t i = 0; i < a.border.coverage.size(); ++i) {
    changed += std::abs(a.border.coverage.pixels[i] - b.border.coverage.pixels[i]) > 0.5f;
    pixels += a.view().seen.id.pixels[i] != 0;
  }
  return static_cast<double>(changed) / static_cast<double>(std::max<std::int64_t>(1, pixels));
}

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  const double from = with.number("from"), to = with.number("to");
  const int steps = with.integer("steps");
  std::vector<Shot> shots;
  for (int i = 0; i <= steps; ++i) shots.push_back(shoot(context, *method, from + (to - from) * i / steps));
  size_t largest = 1;
  for (size_t i = 2; i < shots.size(); ++i)
    largest = change(shots[i - 1], shots[i]) > change(shots[largest - 1], shots[largest]) ? i : largest;
  Shot low = std::move(shots[largest - 1]), high = std::move(shots[largest]);
  for (int i = 0; i < with.integer("halvings"); ++i) {
    Shot middle = shoot(context, *method, 0.5 * (low.at + high.at));
    (change(low, middle) > change(middle, high) ? high : low) = std::move(middle);
  }
  Worst worst;
  const double jump = change(low, high);
  worst.see(jump, fmt::format("{:.2g} % of the object changes between {:.9g} and {:.9g}", 100.0 * jump, low.at, high.at), high.swept->stage,
            high.view(), &high.border);
  return worst.take();
}

}  // namespace

StabilityCheck continuous_check() {
  return {
      {"continuous",
       "share of the object whose ink changes at once while \"$sweep\" runs: the largest change, its place halved again and again", "limn"},
      "share",
      true,
      {stability_number("from", 0.0, "", "where \"$sweep\" starts"), stability_number("to", 1.0, "", "where it ends"),
       stability_whole("steps", 20, 2, 1000, "first looked at"),
       stability_whole("halvings", 16, 0, 60, "of the step with the largest change")},
      run};
}

}  // namespace limn
