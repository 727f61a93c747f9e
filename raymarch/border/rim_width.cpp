// Rim of constant width: the distance to the contour in pixels, from N.V and the radial curvature.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "raymarch/border.h"
#include "raymarch/border/hysteresis.h"
#include "raymarch/border/radial_curvature.h"
#include "raymarch/border/surface_notes.h"
#include "raymarch/gbuffer/picture_rows.h"

namespace limn {
namespace {

/// Border::status.
enum Undefined : std::uint8_t { fine = 0, not_convex = 1, wider_than_radius = 2, no_source = 3 };

// Normals that turn less than 3e-5 a pixel count as those of a plane (as in flat_faces).
constexpr double kFlatRadius_px = 3e4;
// The correction is the second term of a series; where it is not small the series says nothing.
constexpr double kLargestCorrection = 0.5;

struct Settings {
  double width_px, softness_px, hysteresis_px;
  bool from_surfaces;
  /// Pixels between which the curvature's change is measured: a third of the width, so that noise in it is not enlarged by wide borders.
  int step() const { return std::clamp(static_cast<int>(std::lround(width_px / 3.0)), 1, 16); }
  double reach() const { return width_px + 0.5 * softness_px + hysteresis_px; }
};

/// With kr growing by k' per unit of arc from the contour inwards, N.V = k0 s + k' s^2/2 and the width is T = k0 s^2/2 + k' s^3/6, which
/// the circle of the pixel's own curvature takes for c^2/(2 kr) = T (1 - c^2 (dkr/dT) / (3 kr^2)) to the next order.
double corrected(const BorderInput& input, const Image<double>& curvature, const Settings& settings, int x, int y, const SeenPoint& seen,
                 const ContourGuess& guess) {
  const ImageSlope slope = slope_at(input, x, y, settings.step(), [&](size_t i) { return curvature.pixels[i]; });
  const double kr = curvature.at(x, y);
  const double inwards = -(slope.slope.x * guess.outward.x - slope.slope.y * guess.outward.y) * seen.scale;
  const double share = seen.n_dot_v * seen.n_dot_v * inwards / (3.0 * kr * kr);
  return guess.distance_px * (1.0 + std::clamp(std::isfinite(share) ? share : 0.0, -kLargestCorrection, kLargestCorrection));
}

struct Pixel {
  double distance_px = std::numeric_limits<double>::infinity();
  std::uint8_t status = fine;
};

/// False where the pixel just beyond the guessed contour shows the same sheet, turned away a little more. At a crease the normals turn
/// within a pixel or two, and the circle that they make has a contour that the surface has not. A sheet behind the contour most often faces
/// the eye more. `held`: in favour of ink (> 0) or of none (< 0), as a share of the width.
bool ends_there(const BorderInput& input, int x, int y, const ContourGuess& guess, double held) {
  const double beyond = guess.distance_px + 1.5;
  const int nx = static_cast<int>(std::lround(x + beyond * guess.outward.x)),
            ny = static_cast<int>(std::lround(y - beyond * guess.outward.y));
  const Image<std::int32_t>& id = input.gbuffer.id;
  if (!id.inside(nx, ny)) return true;
  const size_t here = id.index(x, y), there = id.index(nx, ny);
  if (id.pixels[there] != id.pixels[here]) return true;
  const double ratio = double{input.gbuffer.n_dot_v.pixels[there]} / double{input.gbuffer.n_dot_v.pixels[here]};
  const double favour = held < 0.0 ? 1.0 / (1.0 - held) : 1.0 + held;
  return ratio < 0.5 * favour || ratio > 1.1 / favour || !same_sheet(input, here, there, static_cast<int>(std::ceil(beyond)));
}

Pixel measure(const BorderInput& input, const Image<double>& curvature, const Settings& settings, int x, int y, double held) {
  const SeenPoint seen = seen_at(input, x, y);
  if (seen.n_dot_v < 1e-6) return {0.0, fine};
  const double kr = curvature.at(x, y);
  if (!std::isfinite(kr)) {
    // Face on there is no border; a sliver without neighbours is all of it.
    return {seen.sine < 0.5 ? std::numeric_limits<double>::infinity() : 0.0, fine};
  }
  if (kr * kFlatRadius_px <= seen.scale) return {std::numeric_limits<double>::infinity(), not_convex};
  const ContourGuess guess = circle_contour(input.camera, seen, kr);
  Pixel pixel{guess.distance_px, kr * settings.width_px >= seen.scale ? wider_than_radius : fine};
  if (guess.distance_px > 2.0 * settings.reach()) return pixel;
  if (pixel.status == fine) pixel.distance_px = corrected(input, curvature, settings, x, y, seen, guess);
  if (pixel.distance_px <= settings.reach() && !ends_there(input, x, y, guess, held))
    pixel.distance_px = std::numeric_limits<double>::infinity();
  return pixel;
}

/// What is undefined, in one sentence; and for every object without curvature why it has none.
void add_notes(const BorderInput& input, const Settings& settings, const std::array<std::int64_t, 4>& counts,
               const std::vector<std::int64_t>& missing, std::vector<std::string>& notes) {
  const std::int64_t undefined = counts[not_convex] + counts[wider_than_radius] + counts[no_source];
  if (undefined > 0) {
    const auto hits = static_cast<double>(std::max<std::int64_t>(1, count_hits(input.gbuffer).hits));
    std::string text = fmt::format("rim_width undefined on {:.1f} % of the pixels hit:", 100.0 * static_cast<double>(undefined) / hits);
    const char* separator = " ";
    const auto add = [&](std::int64_t count, const std::string& what) {
      if (count == 0) return;
      text += fmt::format("{}{} {}", separator, count, what);
      separator = ", ";
    };
    add(counts[not_convex], "where the radial curvature is not above 0 (no border there)");
    add(counts[wider_than_radius],
        fmt::format("where {:.6g} px are more than the radius of curvature (no border wider than that)", settings.width_px));
    add(counts[no_source], "without a curvature (estimated from the screen instead)");
    notes.push_back(text);
  }
  for (size_t k = 0; k < missing.size(); ++k) {
    if (missing[k] == 0 || k >= input.model.surfaces.size()) continue;
    const CurvatureSource& source = input.model.surfaces[k].curvature;
    if (!source.evaluate) notes.push_back(fmt::format("rim_width: object {} has no curvature of its own: {}", k + 1, source.from));
  }
}

Image<double> radial_curvature(const BorderInput& input, const Settings& settings, std::vector<std::int64_t>& missing,
                               Image<std::uint8_t>& status) {
  if (!settings.from_surfaces) return curvature_from_screen(input);
  Image<double> curvature = curvature_from_surfaces(input, missing);
  if (std::all_of(missing.begin(), missing.end(), [](std::int64_t count) { return count == 0; })) return curvature;
  const Image<double> screen = curvature_from_screen(input);
  for (size_t i = 0; i < curvature.size(); ++i) {
    if (input.gbuffer.id.pixels[i] == 0 || std::isfinite(curvature.pixels[i])) continue;
    curvature.pixels[i] = screen.pixels[i];
    status.pixels[i] = no_source;
  }
  return curvature;
}

Border draw(const BorderInput& input, const Parameters& parameters) {
  const GBuffer& seen = input.gbuffer;
  const Settings settings{parameters.number("width"), parameters.number("softness"), parameters.number("hysteresis"),
                          parameters.choice("estimator") == "curvature"};
  const double half = 0.5 * settings.softness_px;
  const Hysteresis hysteresis = hysteresis_of(input, parameters);
  Border border;
  border.color = glm::vec3(parameters.vector3("color"));
  border.coverage = {seen.width, seen.height, 0.0f};
  border.status = {seen.width, seen.height, std::uint8_t{fine}};
  std::vector<std::int64_t> missing;
  const Image<double> curvature = radial_curvature(input, settings, missing, border.status);
  for_each_band(seen.height, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      for (int x = 0; x < seen.width; ++x) {
        const size_t i = seen.id.index(x, y);
        if (seen.id.pixels[i] == 0) continue;
        const double shift = hysteresis.shift(i);
        const Pixel pixel = measure(input, curvature, settings, x, y, shift / std::max(settings.width_px, 1.0));
        if (border.status.pixels[i] == fine) border.status.pixels[i] = pixel.status;
        const double edge = settings.width_px + shift;
        border.coverage.pixels[i] = static_cast<float>(1.0 - smoothstep(edge - half, edge + half, pixel.distance_px));
      }
    }
  });
  std::array<std::int64_t, 4> counts{};
  for (const std::uint8_t status : border.status.pixels) ++counts[status];
  add_notes(input, settings, counts, missing, border.notes);
  return border;
}

}  // namespace

BorderMethod rim_width_method() {
  return {{"rim_width", "rim whose threshold follows the radial curvature, so that the border is `width` pixels everywhere",
           "Kindlmann et al. 2003; perspective, both estimators and their second order: limn"},
          {"NdotV", "N", "Z", "id", "face"},
          {a_number("width", 3.0).in(0.0, 1000.0).unit("px").help("width of the border"),
           a_choice("estimator", {"screen", "curvature"})
               .help("radial curvature from the `screen` (differences of N.V), or the surface's own `curvature`"),
           a_number("softness", 0.0).in(0.0, 1000.0).unit("px").help("pixels over which the border fades, about its width; 0 is hard"),
           a_number("hysteresis", 0.0)
               .in(0.0, 1000.0)
               .unit("px")
               .help("by which a surface point has to pass the border's edge before its ink switches from one frame to the next"),
           a_color("color", {0.0, 0.0, 0.0}).help("ink, linear RGB")},
          [](const SceneModel&, const Scene&) { return std::string(); },
          draw};
}

}  // namespace limn
