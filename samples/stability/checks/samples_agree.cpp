// More samples a pixel make a picture smoother; its border stays where it is, and nothing shows between ink and object.

#include <numbers>

#include "raymarch/border/silhouette.h"
#include "samples/stability/checks/registry.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

constexpr std::array kSamples = {1, 4, 16};

struct Place {
  glm::dvec2 centre{0.0};
  double area = 0.0;
};

Place place_of(const Image<float>& ink) {
  Place place;
  for (int y = 0; y < ink.height; ++y) {
    for (int x = 0; x < ink.width; ++x) {
      place.area += double{ink.at(x, y)};
      place.centre += double{ink.at(x, y)} * glm::dvec2(x, y);
    }
  }
  if (place.area > 0.0) place.centre /= place.area;
  return place;
}

Picture draw(const StabilityStage& stage, const StabilityView& view, std::span<const MethodCall> methods, int samples,
             const ExecutionSettings& how) {
  PictureSettings settings;
  settings.methods.assign(methods.begin(), methods.end());
  settings.samples = samples;
  return draw_picture(stage.scene, stage.model, view.camera, settings, how);
}

/// Share of the pixels that hold both ink and object, or ink beside an object, through which the background shows.
double open_share(const Picture& picture, const Picture& object) {
  std::int64_t both = 0, open = 0;
  for (int y = 1; y + 1 < picture.border.height; ++y) {
    for (int x = 1; x + 1 < picture.border.width; ++x) {
      const auto share = [&](int u, int v) { return object.composite.at(u, v).a; };
      const float own = share(x, y);
      const bool beside =
          own == 0.0f && (share(x - 1, y) == 1.0f || share(x + 1, y) == 1.0f || share(x, y - 1) == 1.0f || share(x, y + 1) == 1.0f);
      if (!(picture.border.at(x, y) > 0.0f) || (!beside && (own == 0.0f || own == 1.0f))) continue;
      ++both;
      open += picture.composite.at(x, y).a < 0.99f;
    }
  }
  return both > 0 ? static_cast<double>(open) / static_cast<double>(both) : 0.0;
}

StabilityFinding run(Workshop& shop, const MethodCall* method, const Parameters& with) {
  Worst worst;
  const StabilityStage& stage = shop.stage();
  for (const StabilityView& view : shop.views()) {
    const double length = static_cast<double>(find_silhouette(view.seen, false).crossings) * 0.25 * std::numbers::pi;
    const Border border = draw_border(stage, view, *method);
    Place first;
    for (const int samples : kSamples) {
      const Picture picture = draw(stage, view, {method, 1}, samples, shop.how());
      if (with.choice("look") == "alpha") {
        const double open = open_share(picture, draw(stage, view, {}, samples, shop.how()));
        worst.see(open,
                  fmt::format("{} samples: the background shows in {:.2g} % of the pixels between ink and object", samples, 100.0 * open),
                  stage, view, &border);
        continue;
      }
      const Place place = place_of(picture.border);
      if (samples == 1) first = place;
      const double moved = glm::length(place.centre - first.centre), wider = std::abs(place.area - first.area) / std::max(1.0, length);
      worst.see(first.area > 0.0 ? std::max(moved, wider) : 1e3,
                fmt::format("{} samples: the ink's middle moves by {:.3f} px, its width by {:.3f} px", samples, moved, wider), stage, view,
                &border);
    }
  }
  return worst.take();
}

}  // namespace

StabilityCheck samples_agree_check() {
  return {{"samples_agree", "1, 4 and 16 samples a pixel: how far the border moves, or where the background shows between ink and object",
           "limn"},
          "px",
          true,
          {{"look",
            ParameterKind::choice,
            "",
            {0.0},
            0.0,
            1.0,
            "place: of the ink, px; alpha: share of pixels that are not filled",
            {"place", "alpha"}}},
          run};
}

}  // namespace limn
