// A local change of the scene changes the picture near it only.

#include "samples/stability/checks/registry.h"
#include "samples/stability/checks/worst.h"
#include "sdf/error.h"

namespace limn {
namespace {

double to_path(std::span<const double> path, const glm::dvec3& p) {
  const auto at = [&](size_t i) { return glm::dvec3(path[3 * i], path[3 * i + 1], path[3 * i + 2]); };
  double least = glm::length(p - at(0));
  for (size_t i = 0; i + 1 < path.size() / 3; ++i) {
    const glm::dvec3 a = at(i), d = at(i + 1) - a;
    const double t = std::clamp(glm::dot(p - a, d) / std::max(1e-300, glm::dot(d, d)), 0.0, 1.0);
    least = std::min(least, glm::length(p - a - t * d));
  }
  return least;
}

StabilityFinding run(Workshop& shop, const MethodCall* method, const Parameters& with) {
  const std::span<const double> path = with.list("path");
  if (path.empty()) throw InputError({shop.which().file, "with.path", "", "no path", "path = [[x, y, z], …]"});
  Worst worst;
  for (size_t variant = 1; variant <= shop.which().variants.size(); ++variant) {
    const StabilityStage& changed = shop.stage(variant);
    worst.said(said_of(changed, method->method->about.name));
    for (size_t k = 0; k < shop.views().size(); ++k) {
      const StabilityView &view = shop.views()[k], &other = shop.views(variant)[k];
      const Border border = draw_border(shop.stage(), view, *method), other_border = draw_border(changed, other, *method);
      std::int64_t different = 0;
      double farthest = 0.0;
      for (size_t i = 0; i < view.seen.id.size(); ++i) {
        if (std::abs(border.coverage.pixels[i] - other_border.coverage.pixels[i]) <= 0.5f &&
            view.seen.id.pixels[i] == other.seen.id.pixels[i])
          continue;
        ++different;
        const bool here = view.seen.id.pixels[i] != 0;
        if (!here && other.seen.id.pixels[i] == 0) continue;
        farthest = std::max(farthest, to_path(path, glm::dvec3((here ? view : other).seen.position.pixels[i])));
      }
      worst.see(farthest,
                fmt::format("{} pixels differ with {}, the farthest {:.3g} from the change", different, changed.variant.words, farthest),
                changed, other, &other_border);
    }
  }
  return worst.take();
}

}  // namespace

StabilityCheck unchanged_beyond_check() {
  return {{"unchanged_beyond", "how far from a path pixels differ between the scene and its variants", "limn"},
          "world",
          true,
          {{"path", ParameterKind::list, "world", {}, -1e12, 1e12, "the change", {}, 3}},
          run};
}

}  // namespace limn
