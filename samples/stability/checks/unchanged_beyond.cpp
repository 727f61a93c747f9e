// A local change of the scene changes the picture near it only.

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"
#include "sdf/error.h"
#include "sdf/segment.h"

namespace limn {
namespace {

double to_path(std::span<const double> path, const glm::dvec3& p) {
  const auto at = [&](size_t i) { return glm::dvec3(path[3 * i], path[3 * i + 1], path[3 * i + 2]); };
  double least = glm::length(p - at(0));
  for (size_t i = 0; i + 1 < path.size() / 3; ++i) {
    const glm::dvec3 from_start = p - at(i), along = at(i + 1) - at(i);
    least = std::min(least, glm::length(from_start - closest_share(from_start, along) * along));
  }
  return least;
}

/// How far from the path what a pixel shows is; of a pixel whose ink also hangs on its neighbours up to `reach_px` away, the nearest of
/// them whose own picture changed.
double distance_at(const StabilityView& view, const StabilityView& other, std::span<const double> path, const glm::ivec2& at,
                   int reach_px) {
  const auto shown = [&](const StabilityView& by, size_t i) { return to_path(path, glm::dvec3(by.seen.position.pixels[i])); };
  const int width = view.camera.width_px, height = view.camera.height_px;
  const auto index = [width](int x, int y) { return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x); };
  const auto changed = [&](size_t i) {
    return view.seen.id.pixels[i] != other.seen.id.pixels[i] || view.seen.depth.pixels[i] != other.seen.depth.pixels[i] ||
           view.seen.normal.pixels[i] != other.seen.normal.pixels[i];
  };
  const auto own = [&](size_t i) { return view.seen.id.pixels[i] != 0 ? shown(view, i) : shown(other, i); };
  double least = own(index(at.x, at.y));
  for (int y = std::max(0, at.y - reach_px); y <= std::min(height - 1, at.y + reach_px); ++y)
    for (int x = std::max(0, at.x - reach_px); x <= std::min(width - 1, at.x + reach_px); ++x) {
      const size_t i = index(x, y);
      if (changed(i) && (view.seen.id.pixels[i] != 0 || other.seen.id.pixels[i] != 0)) least = std::min(least, own(i));
    }
  return least;
}

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  const std::span<const double> path = with.list("path");
  if (path.empty()) throw InputError({context.which().file, "with.path", "", "no path", "path = [[x, y, z], …]"});
  Worst worst;
  for_each_variant(context, *method, worst, [&](const VariantView& both) {
    const auto& [changed, view, other, border, other_border] = both;
    std::int64_t different = 0;
    double farthest = 0.0;
    for (size_t i = 0; i < view.seen.id.size(); ++i) {
      if (std::abs(border.coverage.pixels[i] - other_border.coverage.pixels[i]) <= 0.5f &&
          view.seen.id.pixels[i] == other.seen.id.pixels[i])
        continue;
      ++different;
      if (view.seen.id.pixels[i] == 0 && other.seen.id.pixels[i] == 0) continue;
      const auto width = static_cast<size_t>(view.camera.width_px);
      farthest = std::max(farthest, distance_at(view, other, path, {i % width, i / width}, with.integer("reach_px")));
    }
    worst.see(farthest,
              fmt::format("{} pixels differ with {}, the farthest {:.3g} from the change", different, changed.variant.words, farthest),
              changed, other, &other_border);
  });
  return worst.take();
}

}  // namespace

StabilityCheck unchanged_beyond_check() {
  return {{"unchanged_beyond", "how far from a path pixels differ between the scene and its variants", "limn"},
          "world",
          true,
          {a_list("path", {}, 3).in(-1e12, 1e12).unit("world").help("the change"),
           stability_whole("reach_px", 0, 0, 16, "how far around a pixel its ink is decided")},
          run};
}

}  // namespace limn
