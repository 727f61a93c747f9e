// Laplacian of depth: ink where a pixel's depth stands off the mean of its eight neighbours.
//
// A plane's 1/Z is linear in the picture of a pinhole, its Z is linear without perspective. The second difference of that is 0 on a plane
// at any slant, so that no threshold has to grow with the slant, as those of first differences do (edge_sources.h).

#include <fmt/core.h>

#include <array>
#include <atomic>
#include <cmath>

#include "raymarch/border.h"
#include "raymarch/border/broken_lines.h"
#include "raymarch/border/surface_notes.h"
#include "raymarch/gbuffer/picture_rows.h"

namespace limn {
namespace {

enum class Side { both, near, far };

struct LaplacianSettings {
  double threshold_px = 0.0;
  bool slope_correction = true;
  Side side = Side::both;
};

/// Pixels of ink, and those of them that only a steep slope inks: without the correction for it.
struct InkCounts {
  std::atomic<std::int64_t> all{0}, steep{0};
};

/// How much nearer pixel `other` is than pixel `own`, in sizes of a pixel at the depth of `own`; linear in the picture on a plane.
class Nearness {
 public:
  Nearness(const GBuffer& seen, const Camera& camera) : seen_(seen), camera_(camera) {}
  double of(size_t own, size_t other) const {
    const double z = seen_.depth.pixels[own], z_other = seen_.depth.pixels[other];
    if (camera_.projection == Projection::orthographic) return (z - z_other) * camera_.pixels_per_unit;
    return (z / z_other - 1.0) * camera_.focal_px;  // f Z (1/Z' - 1/Z)
  }

 private:
  const GBuffer& seen_;
  const Camera& camera_;
};

/// Whether nothing is hit at one of the neighbours: the silhouette.
bool beside_nothing(const GBuffer& seen, int x, int y) {
  for (int v = std::max(0, y - 1); v <= std::min(seen.height - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(seen.width - 1, x + 1); ++u) {
      if (seen.id.at(u, v) == 0) return true;
    }
  }
  return false;
}

/// By how many pixel sizes the pixel is nearer than its neighbours: a straight jump of 1, and a crease that changes the slope by 1, have 1.
/// A neighbour counts together with the one opposite, else a slope would count: at the frame, where one is missing, neither does.
double laplacian(const GBuffer& seen, const Nearness& nearer, int x, int y) {
  constexpr std::array<glm::ivec2, 4> directions{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
  const size_t i = seen.id.index(x, y);
  double sum = 0.0;
  int pairs = 0;
  for (const glm::ivec2& step : directions) {
    if (!seen.id.inside(x + step.x, y + step.y) || !seen.id.inside(x - step.x, y - step.y)) continue;
    sum -= nearer.of(i, seen.id.index(x + step.x, y + step.y)) + nearer.of(i, seen.id.index(x - step.x, y - step.y));
    ++pairs;
  }
  return pairs == 0 ? 0.0 : sum / (pairs == 4 ? 3.0 : 1.0);  // of the four pairs three lie across a line along the rows
}

/// Square of the slope as both sides of each axis have it: like slopes a and b count as a b, which makes (b - a) / (1 + a b) the tangent of
/// the angle that the surface turns there. Beside a jump only the flatter one is the surface's own.
double slope_squared(const GBuffer& seen, const Nearness& nearer, int x, int y) {
  // Depth falls as the square root of the distance from a contour: from the second pixel on one slope is at most 1 + sqrt(2) times the
  // next.
  constexpr double kLike = 2.5;
  const size_t i = seen.id.index(x, y);
  const auto along = [&](int dx, int dy) {
    if (!seen.id.inside(x - dx, y - dy) || !seen.id.inside(x + dx, y + dy)) return 0.0;
    const double before = -nearer.of(i, seen.id.index(x - dx, y - dy)), after = nearer.of(i, seen.id.index(x + dx, y + dy));
    const double flatter = std::min(std::abs(before), std::abs(after)), steeper = std::max(std::abs(before), std::abs(after));
    return before * after > 0.0 && steeper <= kLike * flatter ? before * after : flatter * flatter;
  };
  return along(1, 0) + along(0, 1);
}

void ink_line(const BorderInput& input, const LaplacianSettings& settings, int y, Image<float>& ink, InkCounts& counts) {
  const GBuffer& seen = input.gbuffer;
  const Nearness nearer(seen, input.camera);
  std::int64_t all = 0, steep = 0;
  for (int x = 0; x < seen.width; ++x) {
    if (seen.id.at(x, y) == 0) continue;
    const bool silhouette = beside_nothing(seen, x, y);
    bool inked = silhouette && settings.side != Side::far;
    if (!silhouette) {
      const double bend = laplacian(seen, nearer, x, y);
      const bool on_side = settings.side == Side::both || (bend > 0.0) == (settings.side == Side::near);
      inked = on_side && std::abs(bend) >= settings.threshold_px;
      if (inked && std::abs(bend) < settings.threshold_px * (1.0 + slope_squared(seen, nearer, x, y))) {
        inked = !settings.slope_correction;
        steep += inked;
      }
    }
    all += inked;
    ink.at(x, y) = inked ? 1.0f : 0.0f;
  }
  counts.all += all;
  counts.steep += steep;
}

void add_notes(const BorderInput& input, const InkCounts& counts, Border& border) {
  if (!input.with_notes) return;
  if (counts.steep > 0) {
    border.notes.push_back(
        fmt::format("depth_laplacian: {} of {} pixels of ink lie where the surface is steep but neither jumps nor has a crease",
                    counts.steep.load(), counts.all.load()));
  }
  for (std::string note : {meetings_note("depth_laplacian", input, border.coverage, "depth neither jumps nor has a sharp crease there"),
                           broken_lines_note("depth_laplacian", input, border.coverage)}) {
    if (!note.empty()) border.notes.push_back(std::move(note));
  }
}

Border draw(const BorderInput& input, const Parameters& parameters) {
  const std::string& side = parameters.choice("side");
  const LaplacianSettings settings{parameters.number("threshold"), parameters.flag("slope_correction"),
                                   side == "near"  ? Side::near
                                   : side == "far" ? Side::far
                                                   : Side::both};
  Border border;
  border.color = glm::vec3(parameters.vector3("color"));
  border.coverage = {input.gbuffer.width, input.gbuffer.height, 0.0f};
  InkCounts counts;
  for_each_band(input.gbuffer.height, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) ink_line(input, settings, y, border.coverage, counts);
  });
  add_notes(input, counts, border);
  return border;
}

}  // namespace

BorderMethod depth_laplacian_method() {
  return {{"depth_laplacian", "border where depth differs from the mean of its eight neighbours: jumps and creases, none on planes",
           "Saito and Takahashi 1990; slope correction: limn"},
          {"Z", "id"},
          {a_number("threshold", 0.25)
               .in(1e-3, 1e6)
               .unit("px")
               .help("least difference, in sizes of a pixel at that depth; a crease that changes the slope by 1 has 0.5 to 1"),
           a_flag("slope_correction", true)
               .help("divide the difference by 1 + slope^2, so that steep rims of curved surfaces get no broad bands"),
           a_choice("side", {"both", "near", "far"})
               .help("both sides of a jump and all creases; its near side and convex creases; its far side and concave creases"),
           a_color("color", {0.0, 0.0, 0.0}).help("ink, linear RGB")},
          [](const SceneModel&, const Scene&) { return std::string(); },
          draw};
}

}  // namespace limn
