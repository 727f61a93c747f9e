// Whatever is drawn is a number: no NaN, unit normals, ink between 0 and 1, no ray without an answer.

#include <cmath>

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// In words what is wrong with a pixel of the surface; empty: nothing.
std::string fault_of(const GBuffer& seen, size_t i) {
  if (seen.status.pixels[i] == static_cast<std::uint8_t>(HitStatus::out_of_steps)) return "out of steps";
  if (seen.id.pixels[i] == 0) return seen.normal.pixels[i] == glm::vec3(0.0f) ? "" : "a normal where nothing is hit";
  if (!finite(seen.position.pixels[i])) return "no finite position";
  if (!std::isfinite(seen.depth.pixels[i])) return "no finite depth";
  if (!finite(seen.normal.pixels[i]) || std::abs(glm::length(seen.normal.pixels[i]) - 1.0f) > 1e-4f) return "no unit normal";
  if (!(seen.n_dot_v.pixels[i] >= 0.0f && seen.n_dot_v.pixels[i] <= 1.0f)) return "N.V outside [0, 1]";
  return {};
}

std::string fault_of(const Border& border, size_t i) {
  if (!(border.coverage.pixels[i] >= 0.0f && border.coverage.pixels[i] <= 1.0f)) return "ink outside [0, 1]";
  if (!border.colors.pixels.empty() && !finite(border.colors.pixels[i])) return "no finite colour";
  return {};
}

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  Worst worst;
  for (const StabilityView& view : context.views()) {
    const Border border = draw_border(context.stage(), view, *method);
    std::int64_t bad = 0;
    std::string first;
    for (size_t i = 0; i < view.seen.id.size(); ++i) {
      std::string fault = fault_of(view.seen, i);
      if (fault.empty()) fault = fault_of(border, i);
      if (fault.empty()) continue;
      const auto width = static_cast<size_t>(view.seen.width);
      if (bad++ == 0) first = fmt::format(", the first ({}) at ({}, {})", fault, i % width, i / width);
    }
    const HitCounts hits = count_hits(view.seen);
    const auto least = static_cast<std::int64_t>(with.number("hits") * static_cast<double>(view.seen.id.size()));
    if (hits.hits < least && bad++ == 0) first = fmt::format(", fewer than {} hit", least);
    worst.see(static_cast<double>(bad), fmt::format("{} bad pixels of {} ({} hit){}", bad, view.seen.id.size(), hits.hits, first),
              context.stage(), view, &border);
  }
  return worst.take();
}

}  // namespace

StabilityCheck finite_outputs_check() {
  return {
      {"finite_outputs", "pixels with anything that is no number, no unit normal, ink outside [0, 1], or a ray without an answer", "limn"},
      "pixels",
      true,
      {stability_number("hits", 0.0, "", "share of the picture that must be hit at least")},
      run};
}

}  // namespace limn
