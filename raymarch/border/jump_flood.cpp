// The same outline as `distance`, by jump flooding; says where the two differ.

#include <fmt/core.h>

#include <cmath>

#include "raymarch/border/picture_rows.h"
#include "raymarch/border/registry.h"
#include "raymarch/border/silhouette.h"

namespace limn {
namespace {

/// Both transforms work in whole numbers on the same crossings, so any difference is jump flooding's own.
void add_comparison(const Image<std::int32_t>& squares, const Image<std::int32_t>& exact, int reach_px, std::vector<std::string>& notes) {
  struct Difference {
    std::int64_t count = 0;
    double largest_px = 0.0;
  };
  std::vector<Difference> of_bands(static_cast<size_t>(squares.height / kBandRows + 1));
  for_each_band(squares.height, [&](int y0, int y1) {
    Difference found;
    for (size_t i = squares.index(0, y0); i < squares.index(0, y1); ++i) {
      if (squares.pixels[i] == exact.pixels[i]) continue;
      ++found.count;
      const double ours = squares.pixels[i] == kFarSquared ? reach_px : std::sqrt(double(squares.pixels[i])) / kSubPixels;
      found.largest_px = std::max(found.largest_px, ours - std::sqrt(double(exact.pixels[i])) / kSubPixels);
    }
    of_bands[static_cast<size_t>(y0 / kBandRows)] = found;
  });
  std::int64_t different = 0;
  double largest_px = 0.0;
  for (const Difference& found : of_bands) {
    different += found.count;
    largest_px = std::max(largest_px, found.largest_px);
  }
  if (different == 0) return;
  notes.push_back(fmt::format("jump_flood: {} pixels differ from the exact transform, at most {:.2g} px", different, largest_px));
}

Border draw(const BorderInput& input, const Parameters& parameters) {
  const OutlineBand band = outline_band(parameters);
  const Silhouette silhouette = find_silhouette(input.gbuffer, parameters.choice("seeds") == "estimated");
  const Image<std::int32_t> squares = jump_flood_squares(silhouette, band.reach_px(), parameters.integer("extra_passes"));
  Border border;
  border.color = glm::vec3(parameters.vector3("color"));
  border.coverage = ink_band(silhouette, squares, band);
  add_silhouette_notes("jump_flood", silhouette, border.notes);
  if (parameters.flag("check")) add_comparison(squares, exact_squares(silhouette, band.reach_px()), band.reach_px(), border.notes);
  return border;
}

}  // namespace

BorderMethod jump_flood_method() {
  std::vector<Parameter> parameters = outline_parameters();
  parameters.push_back(
      {"extra_passes", ParameterKind::integer, "", {2.0}, 0.0, 2.0, "passes of step 2 and 1 after the last; fewer wrong pixels", {}});
  parameters.push_back({"check", ParameterKind::flag, "", {1.0}, 0.0, 1.0, "count the pixels that differ from the exact transform", {}});
  return {{"jump_flood", "outline of constant width around the silhouette, by jump flooding: a fixed number of passes, not exact",
           "Rong and Tan 2006"},
          {"id", "NdotV"},
          parameters,
          [](const SceneModel&, const Scene&) { return std::string(); },
          draw};
}

}  // namespace limn
