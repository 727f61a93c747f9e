// More samples a pixel make a picture smoother; its border stays where it is, and nothing shows between ink and object.

#include <numbers>

#include "raymarch/border/silhouette.h"
#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

constexpr std::array kSamples = {1, 4, 16};

/// So many that a picture's own sampling no longer counts.
constexpr int kReference = 36;

/// The translation of `reference` that `ink` is most like, by least squares (Lucas and Kanade 1981).
glm::dvec2 moved(const Image<float>& ink, const Image<float>& reference) {
  double xx = 0.0, xy = 0.0, yy = 0.0;
  glm::dvec2 b(0.0);
  for (int y = 1; y + 1 < ink.height; ++y) {
    for (int x = 1; x + 1 < ink.width; ++x) {
      const double dx = 0.5 * double{reference.at(x + 1, y) - reference.at(x - 1, y)},
                   dy = 0.5 * double{reference.at(x, y + 1) - reference.at(x, y - 1)}, more = double{ink.at(x, y) - reference.at(x, y)};
      xx += dx * dx, xy += dx * dy, yy += dy * dy;
      b -= more * glm::dvec2(dx, dy);
    }
  }
  const double determinant = xx * yy - xy * xy;
  return determinant > 0.0 ? glm::dvec2(yy * b.x - xy * b.y, xx * b.y - xy * b.x) / determinant : glm::dvec2(1e3);
}

double area_of(const Image<float>& ink) {
  double area = 0.0;
  for (const float share : ink.pixels) area += double{share};
  return area;
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

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  Worst worst;
  const StabilityStage& stage = context.stage();
  const bool alpha = with.choice("look") == "alpha";
  for (const StabilityView& view : context.views()) {
    const double length = static_cast<double>(find_silhouette(view.seen, false).crossings) * 0.25 * std::numbers::pi;
    const Border border = draw_border(stage, view, *method);
    const Image<float> reference = alpha ? Image<float>() : draw(stage, view, {method, 1}, kReference, context.how()).border;
    for (const int samples : kSamples) {
      const Picture picture = draw(stage, view, {method, 1}, samples, context.how());
      if (alpha) {
        const double open = open_share(picture, draw(stage, view, {}, samples, context.how()));
        worst.see(open,
                  fmt::format("{} samples: the background shows in {:.2g} % of the pixels between ink and object", samples, 100.0 * open),
                  stage, view, &border);
        continue;
      }
      const double apart = glm::length(moved(picture.border, reference));
      const double wider = std::abs(area_of(picture.border) - area_of(reference)) / std::max(1.0, length);
      worst.see(std::max(apart, wider),
                fmt::format("{} samples: the ink lies {:.3f} px off, and is {:.3f} px wider or narrower, than with {}", samples, apart,
                            wider, kReference),
                stage, view, &border);
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
          {a_choice("look", {"place", "alpha"}).help("place: of the ink, px; alpha: share of pixels that are not filled")},
          run};
}

}  // namespace limn
