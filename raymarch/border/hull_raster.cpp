#include "raymarch/border/hull_raster.h"

#include <array>
#include <cmath>

#include "raymarch/gbuffer/picture_rows.h"

namespace limn {
namespace {

constexpr double kSubPixels = 1024.0;
// With image points below 2^20 px, differences take 31 bits and edge functions 63.
constexpr double kGuard_px = 1 << 19;
constexpr size_t kPartTriangles = size_t{1} << 14;  // that one thread takes

/// A triangle on the picture: whole 1/1024 px, and 1/Z (perspective) or Z (parallel) as an affine function of them.
struct FlatTriangle {
  std::array<glm::i64vec2, 3> p;  ///< Turned so that the interior is on the left with y up: area > 0.
  std::array<double, 3> q;
  std::int64_t area = 0;
  int top = 0, bottom = 0, left = 0, right = 0;  ///< Pixels, the last ones included.
};

struct Frame {
  const Camera& camera;
  glm::dvec2 sample;
  HullFaces faces;
  double near;
  bool perspective() const { return camera.projection == Projection::perspective; }
  double scale() const { return perspective() ? camera.focal_px : camera.pixels_per_unit; }
};

using Polygon = std::vector<glm::dvec3>;

/// Keeps the side of the polygon where `inside` is not negative (Sutherland & Hodgman 1974). Every crossing is computed from the kept end,
/// so that neighbours agree on it to the last bit.
template <class Inside>
void clip(const Inside& inside, Polygon& polygon, Polygon& scratch) {
  scratch.clear();
  for (size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double at_a = inside(a), at_b = inside(b);
    if (at_a >= 0.0) scratch.push_back(a);
    if (at_a >= 0.0 && at_b < 0.0) scratch.push_back(a + at_a / (at_a - at_b) * (b - a));
    if (at_a < 0.0 && at_b >= 0.0) scratch.push_back(b + at_b / (at_b - at_a) * (a - b));
  }
  polygon.swap(scratch);
}

/// How far from the middle of the picture image points may be, at depth 1 in perspective.
double guard_reach(const Frame& frame) { return kGuard_px / frame.scale(); }
double nearest_of(const Frame& frame) { return frame.perspective() ? frame.near : 0.0; }

void clip_to_view(const Frame& frame, Polygon& polygon, Polygon& scratch) {
  const bool perspective = frame.perspective();
  const double near = nearest_of(frame), reach = guard_reach(frame);
  clip([near](const glm::dvec3& p) { return p.z - near; }, polygon, scratch);
  for (int axis = 0; axis < 2; ++axis) {
    for (const double side : {-1.0, 1.0})
      clip([=](const glm::dvec3& p) { return reach * (perspective ? p.z : 1.0) - side * p[axis]; }, polygon, scratch);
  }
}

/// What clip_to_view() leaves as it is.
bool is_in_view(const Frame& frame, const glm::dvec3& p) {
  const double reach = guard_reach(frame) * (frame.perspective() ? p.z : 1.0);
  return p.z - nearest_of(frame) >= 0.0 && reach - p.x >= 0.0 && reach + p.x >= 0.0 && reach - p.y >= 0.0 && reach + p.y >= 0.0;
}

/// Image point relative to the sample of pixel (0, 0), y up, in whole 1/1024 px.
glm::i64vec2 snapped(const Frame& frame, const glm::dvec3& p) {
  const double scale = frame.perspective() ? frame.scale() / p.z : frame.scale();
  const glm::dvec2 at(0.5 * frame.camera.width_px + scale * p.x - frame.sample.x,
                      0.5 * frame.camera.height_px - scale * p.y - frame.sample.y);
  return {std::llround(at.x * kSubPixels), -std::llround(at.y * kSubPixels)};
}

std::int64_t cross(const glm::i64vec2& a, const glm::i64vec2& b) { return a.x * b.y - a.y * b.x; }

void add_flat(const Frame& frame, std::array<glm::dvec3, 3> corners, std::vector<FlatTriangle>& out) {
  FlatTriangle flat;
  for (size_t i = 0; i < 3; ++i) {
    flat.p[i] = snapped(frame, corners[i]);
    flat.q[i] = frame.perspective() ? 1.0 / corners[i].z : corners[i].z;
  }
  flat.area = cross(flat.p[1] - flat.p[0], flat.p[2] - flat.p[0]);
  if (flat.area == 0 || (flat.area > 0 && frame.faces == HullFaces::back)) return;
  if (flat.area < 0) {
    std::swap(flat.p[1], flat.p[2]);
    std::swap(flat.q[1], flat.q[2]);
    flat.area = -flat.area;
  }
  const auto [low, high] = std::minmax({flat.p[0].y, flat.p[1].y, flat.p[2].y});
  const auto [left, right] = std::minmax({flat.p[0].x, flat.p[1].x, flat.p[2].x});
  const auto first = [](std::int64_t at, int count) {
    return static_cast<int>(std::clamp(std::ceil(static_cast<double>(at) / kSubPixels), 0.0, static_cast<double>(count)));
  };
  const auto last = [](std::int64_t at, int count) {
    return static_cast<int>(std::clamp(std::floor(static_cast<double>(at) / kSubPixels), -1.0, count - 1.0));
  };
  flat.top = first(-high, frame.camera.height_px);
  flat.bottom = last(-low, frame.camera.height_px);
  flat.left = first(left, frame.camera.width_px);
  flat.right = last(right, frame.camera.width_px);
  if (flat.top <= flat.bottom && flat.left <= flat.right) out.push_back(flat);
}

/// Triangles of a part of the hull, and which of them each band of the picture's rows meets.
struct FlatPart {
  std::vector<FlatTriangle> triangles{};
  PixelWindow window{};
  std::vector<std::vector<std::uint32_t>> of_band{};
};

FlatPart flattened(const Frame& frame, const Hull& hull, std::span<const glm::uvec3> triangles) {
  FlatPart part;
  Polygon polygon, scratch;
  for (const glm::uvec3& t : triangles) {
    const std::array<glm::dvec3, 3> corners{hull.corners[t.x], hull.corners[t.y], hull.corners[t.z]};
    if (is_in_view(frame, corners[0]) && is_in_view(frame, corners[1]) && is_in_view(frame, corners[2])) {
      add_flat(frame, corners, part.triangles);
      continue;
    }
    polygon.assign(corners.begin(), corners.end());
    clip_to_view(frame, polygon, scratch);
    for (size_t i = 2; i < polygon.size(); ++i) add_flat(frame, {polygon[0], polygon[i - 1], polygon[i]}, part.triangles);
  }
  part.window = {frame.camera.width_px, frame.camera.height_px, 0, 0};
  for (const FlatTriangle& t : part.triangles)
    part.window = {std::min(part.window.x0, t.left), std::min(part.window.y0, t.top), std::max(part.window.x1, t.right + 1),
                   std::max(part.window.y1, t.bottom + 1)};
  return part;
}

/// Bands are counted from row `y0` on.
void sort_into_bands(int y0, FlatPart& part) {
  if (part.window.empty()) return;
  const auto band_of = [&](int y) { return static_cast<size_t>((y - y0) / kBandRows); };
  part.of_band.resize(band_of(part.window.y1 - 1) + 1);
  for (size_t i = 0; i < part.triangles.size(); ++i) {
    const FlatTriangle& t = part.triangles[i];
    for (size_t band = band_of(t.top); band <= band_of(t.bottom); ++band) part.of_band[band].push_back(static_cast<std::uint32_t>(i));
  }
}

/// Of two triangles that share the edge from a to b exactly one owns the points on it.
bool owns_border(const glm::i64vec2& a, const glm::i64vec2& b) { return b.y < a.y || (b.y == a.y && b.x < a.x); }

void fill_row(const FlatTriangle& flat, int y, bool perspective, WindowImage<double>& depth) {
  const std::int64_t step = static_cast<std::int64_t>(kSubPixels);
  std::array<std::int64_t, 3> edge{}, slope{};
  const glm::i64vec2 start(flat.left * step, -y * step);
  for (size_t i = 0; i < 3; ++i) {
    const glm::i64vec2 &a = flat.p[(i + 1) % 3], &b = flat.p[(i + 2) % 3];
    // Points on an edge that the triangle does not own are put outside by one.
    edge[i] = cross(b - a, start - a) - (owns_border(a, b) ? 0 : 1);
    slope[i] = -(b.y - a.y) * step;
  }
  const double inverse = 1.0 / static_cast<double>(flat.area);
  for (int x = flat.left; x <= flat.right; ++x) {
    if ((edge[0] | edge[1] | edge[2]) >= 0) {
      const double u = static_cast<double>(edge[1]) * inverse, v = static_cast<double>(edge[2]) * inverse;
      const double q = flat.q[0] + u * (flat.q[1] - flat.q[0]) + v * (flat.q[2] - flat.q[0]);
      double& z = depth.at(x, y);
      z = std::min(z, perspective ? 1.0 / q : q);
    }
    for (size_t i = 0; i < 3; ++i) edge[i] += slope[i];
  }
}

}  // namespace

WindowImage<double> rasterize_hull(const Hull& hull, HullFaces faces, const Camera& camera, double near, const glm::dvec2& sample) {
  const Frame frame{camera, sample, faces, near};
  std::vector<FlatPart> parts((hull.triangles.size() + kPartTriangles - 1) / kPartTriangles);
  parallel_each(parts.size(), [&](size_t part) {
    const size_t first = part * kPartTriangles;
    parts[part] = flattened(frame, hull, hull.triangles.subspan(first, std::min(kPartTriangles, hull.triangles.size() - first)));
  });
  PixelWindow window{camera.width_px, camera.height_px, 0, 0};
  for (const FlatPart& part : parts)
    window = {std::min(window.x0, part.window.x0), std::min(window.y0, part.window.y0), std::max(window.x1, part.window.x1),
              std::max(window.y1, part.window.y1)};
  if (window.empty()) return {};
  WindowImage<double> depth = window_image(window, std::numeric_limits<double>::infinity());
  parallel_each(parts.size(), [&](size_t part) { sort_into_bands(window.y0, parts[part]); });
  for_each_band(window.height(), [&](int y0, int y1) {
    const auto band = static_cast<size_t>(y0 / kBandRows);
    for (const FlatPart& part : parts) {
      if (band >= part.of_band.size()) continue;
      for (const std::uint32_t i : part.of_band[band]) {
        const FlatTriangle& flat = part.triangles[i];
        const int first = std::max(flat.top, window.y0 + y0), end = std::min(flat.bottom + 1, window.y0 + y1);
        for (int y = first; y < end; ++y) fill_row(flat, y, frame.perspective(), depth);
      }
    }
  });
  return depth;
}

}  // namespace limn
