// The same outline as `distance`, by jump flooding; says where the two differ.

#include <fmt/core.h>

#include <cmath>

#include "raymarch/border.h"
#include "raymarch/border/outline.h"
#include "raymarch/gbuffer/picture_rows.h"

namespace limn {
namespace {

struct Difference {
  std::int64_t count = 0;
  double largest_px = 0.0;
  void add(const Difference& other) {
    count += other.count;
    largest_px = std::max(largest_px, other.largest_px);
  }
};

/// Both transforms work in whole numbers on the same crossings, so any difference is jump flooding's own.
Difference compare(const Image<std::int32_t>& squares, const Image<std::int32_t>& exact, int reach_px) {
  std::vector<Difference> of_bands(static_cast<size_t>(squares.height / kBandRows + 1));
  for_each_band(squares.height, [&](int y0, int y1) {
    Difference found;
    for (size_t i = squares.index(0, y0); i < squares.index(0, y1); ++i) {
      if (squares.pixels[i] == exact.pixels[i]) continue;
      const double ours = squares.pixels[i] == kFarSquared ? reach_px : std::sqrt(double(squares.pixels[i])) / kSubPixels;
      found.add({1, ours - std::sqrt(double(exact.pixels[i])) / kSubPixels});
    }
    of_bands[static_cast<size_t>(y0 / kBandRows)] = found;
  });
  Difference all;
  for (const Difference& found : of_bands) all.add(found);
  return all;
}

Border draw(const BorderInput& input, const Parameters& parameters) {
  const int extra_passes = parameters.integer("extra_passes");
  const bool check = parameters.flag("check");
  Difference all;
  const auto squares = [&](const Silhouette& silhouette, int reach_px) {
    Image<std::int32_t> flooded = jump_flood_squares(silhouette, reach_px, extra_passes);
    if (check) all.add(compare(flooded, exact_squares(silhouette, reach_px), reach_px));
    return flooded;
  };
  Border border = draw_outline("jump_flood", input, parameters, squares);
  if (all.count > 0) {
    border.notes.push_back(
        fmt::format("jump_flood: {} pixels differ from the exact transform, at most {:.2g} px", all.count, all.largest_px));
  }
  return border;
}

}  // namespace

BorderMethod jump_flood_method() {
  std::vector<Parameter> parameters = outline_parameters();
  parameters.push_back(an_integer("extra_passes", 2.0).in(0.0, 2.0).help("passes of step 2 and 1 after the last; fewer wrong pixels"));
  parameters.push_back(a_flag("check", true).help("count the pixels that differ from the exact transform"));
  return {{"jump_flood", "outline of constant width around the silhouette, by jump flooding: a fixed number of passes, not exact",
           "Rong and Tan 2006"},
          {"Z", "N", "NdotV", "id", "material"},
          parameters,
          [](const SceneModel&, const Scene&) { return std::string(); },
          draw};
}

}  // namespace limn
