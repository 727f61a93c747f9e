#include "raymarch/border/edge_lines.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr size_t kDepthPlane = 0, kTolerancePlane = 1, kNormalPlane = 2, kColorPlane = 5, kCustomPlane = 8;

/// Adds the square of the operator's answer, times 2 (Roberts) or 16 (Sobel), to `sum`. Lines a, b, c from the top; b is the pixel's own.
void add_roberts(const float* __restrict b, const float* __restrict c, int n, float* __restrict sum) {
  for (int x = 0; x < n; ++x) {
    const float h = b[x] - c[x + 1], v = b[x + 1] - c[x];
    sum[x] += h * h + v * v;
  }
}

void add_sobel(const float* __restrict a, const float* __restrict b, const float* __restrict c, int n, float* __restrict sum) {
  for (int x = 0; x < n; ++x) {
    const float gx = (a[x + 1] - a[x - 1]) + 2.0f * (b[x + 1] - b[x - 1]) + (c[x + 1] - c[x - 1]);
    const float gy = (c[x - 1] - a[x - 1]) + 2.0f * (c[x] - a[x]) + (c[x + 1] - a[x + 1]);
    sum[x] += gx * gx + gy * gy;
  }
}

/// Ids have no size: the operator sees 1 where a pixel's id is another than the first pixel's (Sobel: the middle's), else 0.
void add_id_roberts(const std::uint32_t* __restrict b, const std::uint32_t* __restrict c, int n, float* __restrict sum) {
  for (int x = 0; x < n; ++x) sum[x] += (b[x] != c[x + 1] ? 1.0f : 0.0f) + (b[x + 1] != c[x] ? 1.0f : 0.0f);
}

void add_id_sobel(const std::uint32_t* __restrict a, const std::uint32_t* __restrict b, const std::uint32_t* __restrict c, int n,
                  float* __restrict sum) {
  for (int x = 0; x < n; ++x) {
    const std::uint32_t own = b[x];
    const auto other = [own](std::uint32_t key) { return key != own ? 1.0f : 0.0f; };
    const float top_left = other(a[x - 1]), top_right = other(a[x + 1]), bottom_left = other(c[x - 1]), bottom_right = other(c[x + 1]);
    const float gx = (top_right - top_left) + 2.0f * (other(b[x + 1]) - other(b[x - 1])) + (bottom_right - bottom_left);
    const float gy = (bottom_left - top_left) + 2.0f * (other(c[x]) - other(a[x])) + (bottom_right - top_right);
    sum[x] += gx * gx + gy * gy;
  }
}

void repeat_ends(float* plane, int n) {
  plane[-1] = plane[0];
  plane[n] = plane[n - 1];
}

void split(const glm::vec3* __restrict from, int n, float* __restrict x, float* __restrict y, float* __restrict z) {
  for (int i = 0; i < n; ++i) {
    x[i] = from[i].x;
    y[i] = from[i].y;
    z[i] = from[i].z;
  }
}

void raise(const float* __restrict base, int count, double power, float* __restrict out) {
  const int whole = static_cast<int>(power);
  if (static_cast<double>(whole) == power && whole <= 8) {
    for (int i = 0; i < count; ++i) out[i] = 1.0f;
    for (int k = 0; k < whole; ++k) {
      for (int i = 0; i < count; ++i) out[i] *= base[i];
    }
    return;
  }
  const auto exponent = static_cast<float>(power);
  for (int i = 0; i < count; ++i) out[i] = std::pow(base[i], exponent);
}

}  // namespace

void grazing_factors(const GrazingModulation& modulation, const float* n_dot_v, int count, float* factors) {
  const auto p = static_cast<float>(modulation.p), range = static_cast<float>(1.0 - modulation.hardness);
  const auto strength = static_cast<float>(modulation.strength);
  if (strength == 0.0f) {
    std::fill_n(factors, count, 1.0f);
    return;
  }
  constexpr int kChunk = 64;
  float base[kChunk], fresnel[kChunk];
  for (int first = 0; first < count; first += kChunk) {
    const int n = std::min(kChunk, count - first);
    for (int i = 0; i < n; ++i) base[i] = 1.0f - std::min(1.0f, std::max(0.0f, n_dot_v[first + i]));
    raise(base, n, modulation.power, fresnel);
    for (int i = 0; i < n; ++i) {
      const float m = std::min(1.0f, std::max(0.0f, (fresnel[i] + p - 1.0f) / p));
      const float t = std::min(1.0f, m / range);
      factors[first + i] = 1.0f + strength * (t * t * (3.0f - 2.0f * t));
    }
  }
}

EdgeLines::EdgeLines(const EdgeSettings& settings, const BorderInput& input, float nearest_depth)
    : settings_(settings),
      input_(input),
      nearest_(nearest_depth),
      width_(input.gbuffer.width),
      stride_(static_cast<size_t>(width_) + 2),
      squares_(static_cast<size_t>(width_)),
      scratch_(stride_) {
  for (Line& each : lines_) {
    each.planes.resize(kPlanes * stride_);
    each.keys.resize(stride_);
  }
}

EdgeLines::Line& EdgeLines::line(int y) {
  const int row = std::clamp(y, 0, input_.gbuffer.height - 1);
  Line& slot = lines_[static_cast<size_t>(row) % 3];
  if (slot.row != row) fill(row, slot);
  return slot;
}

/// Depth as edge_sources.h derives it: 1/Z in units of the nearest, which is 0 where nothing is hit; without perspective Z in pixels. The
/// tolerance is the largest edge strength that a surface through this very pixel explains. Where nothing is hit it explains none.
void EdgeLines::fill_depth(size_t first, Line& out) {
  const GBuffer& seen = input_.gbuffer;
  const float* z = seen.depth.pixels.data() + first;
  float* depth = plane(out, kDepthPlane);
  float* tolerance = plane(out, kTolerancePlane);
  grazing_factors(settings_.grazing, seen.n_dot_v.pixels.data() + first, width_, tolerance);
  const float threshold = settings_.sources[kDepthSource].threshold, growth = settings_.distance_factor, nearest = nearest_;
  if (input_.camera.projection == Projection::perspective) {
    const float scale = threshold / static_cast<float>(input_.camera.focal_px);
    for (int x = 0; x < width_; ++x) {
      const float inverse = nearest / z[x];
      depth[x] = inverse;
      tolerance[x] *= scale * inverse * (inverse * (1.0f - growth) + growth);
    }
  } else {
    const auto scale = static_cast<float>(input_.camera.pixels_per_unit);
    constexpr float kNothing = -1e15f;  // its square is still finite
    for (int x = 0; x < width_; ++x) {
      const bool hit = z[x] < std::numeric_limits<float>::infinity();
      depth[x] = hit ? (z[x] - nearest) * scale : kNothing;
      tolerance[x] = hit ? tolerance[x] * threshold : 0.0f;
    }
  }
  repeat_ends(depth, width_);
  repeat_ends(tolerance, width_);
}

void EdgeLines::fill_colors(size_t first, Line& out) {
  const GBuffer& seen = input_.gbuffer;
  for (int x = 0; x < width_; ++x) {
    const size_t i = first + static_cast<size_t>(x);
    const std::int32_t id = seen.id.pixels[i];
    const glm::vec3 color =
        id == 0 ? glm::vec3(0.0f) : input_.model.colors[static_cast<size_t>(id - 1)] * (0.25f + 0.75f * seen.n_dot_v.pixels[i]);
    for (size_t k = 0; k < 3; ++k) plane(out, kColorPlane + k)[x] = color[static_cast<int>(k)];
  }
  for (size_t k = 0; k < 3; ++k) repeat_ends(plane(out, kColorPlane + k), width_);
}

void EdgeLines::fill(int y, Line& out) {
  const GBuffer& seen = input_.gbuffer;
  const size_t first = seen.id.index(0, y);
  out.row = y;
  if (settings_.used(kDepthSource)) fill_depth(first, out);
  if (settings_.used(kColorSource)) fill_colors(first, out);
  if (settings_.used(kNormalSource)) {
    float *nx = plane(out, kNormalPlane), *ny = plane(out, kNormalPlane + 1), *nz = plane(out, kNormalPlane + 2);
    split(seen.normal.pixels.data() + first, width_, nx, ny, nz);
    const glm::vec3 clear(input_.camera.world_from_camera[2]);
    const std::int32_t* id = seen.id.pixels.data() + first;
    for (int x = 0; x < width_; ++x) {
      nx[x] = id[x] == 0 ? clear.x : nx[x];
      ny[x] = id[x] == 0 ? clear.y : ny[x];
      nz[x] = id[x] == 0 ? clear.z : nz[x];
    }
    for (float* n : {nx, ny, nz}) repeat_ends(n, width_);
  }
  if (settings_.used(kIdSource)) {
    // One key of object and material; the odd multiplier keeps keys of different objects far apart (Knuth's multiplicative hashing).
    std::uint32_t* keys = out.keys.data() + 1;
    const std::int32_t *id = seen.id.pixels.data() + first, *material = seen.material.pixels.data() + first;
    for (int x = 0; x < width_; ++x) keys[x] = static_cast<std::uint32_t>(id[x]) * 2654435761u + static_cast<std::uint32_t>(material[x]);
    keys[-1] = keys[0];
    keys[width_] = keys[width_ - 1];
  }
  if (settings_.used(kCustomSource)) {
    float *cx = plane(out, kCustomPlane), *cy = plane(out, kCustomPlane + 1), *cz = plane(out, kCustomPlane + 2);
    split(seen.custom.pixels.data() + first, width_, cx, cy, cz);
    for (float* c : {cx, cy, cz}) repeat_ends(c, width_);
  }
}

void EdgeLines::strength(size_t first_plane, size_t count, const std::array<Line*, 3>& rows) {
  std::fill(squares_.begin(), squares_.end(), 0.0f);
  for (size_t k = first_plane; k < first_plane + count; ++k) {
    if (settings_.edge_operator == EdgeOperator::roberts) {
      add_roberts(plane(*rows[1], k), plane(*rows[2], k), width_, squares_.data());
    } else {
      add_sobel(plane(*rows[0], k), plane(*rows[1], k), plane(*rows[2], k), width_, squares_.data());
    }
  }
}

void EdgeLines::id_strength(const std::array<Line*, 3>& rows) {
  std::fill(squares_.begin(), squares_.end(), 0.0f);
  if (settings_.edge_operator == EdgeOperator::roberts) {
    add_id_roberts(rows[1]->keys.data() + 1, rows[2]->keys.data() + 1, width_, squares_.data());
  } else {
    add_id_sobel(rows[0]->keys.data() + 1, rows[1]->keys.data() + 1, rows[2]->keys.data() + 1, width_, squares_.data());
  }
}

/// A jump counts where no pixel of the neighbourhood explains it: the smallest tolerance decides, so that what lies behind a rounded edge,
/// seen straight, keeps the line that the grazing rim in front of it would suppress.
void EdgeLines::depth_edges(const std::array<Line*, 3>& rows, float* __restrict edges) {
  strength(kDepthPlane, 1, rows);
  const bool roberts = settings_.edge_operator == EdgeOperator::roberts;
  const float *a = plane(*rows[roberts ? 1 : 0], kTolerancePlane), *b = plane(*rows[1], kTolerancePlane),
              *c = plane(*rows[2], kTolerancePlane);
  float* least = scratch_.data() + 1;
  const int reach = roberts ? 0 : 1;
  for (int x = -1; x <= width_; ++x) least[x] = std::min(std::min(a[x], b[x]), c[x]);
  const float scale = roberts ? 2.0f : 16.0f;
  const float* squares = squares_.data();
  for (int x = 0; x < width_; ++x) {
    const float tolerance = std::min(std::min(least[x - reach], least[x]), least[x + 1]);
    edges[x] = squares[x] > scale * tolerance * tolerance ? 1.0f : 0.0f;
  }
}

void EdgeLines::find_edges(int y, EdgeFlags& flags) {
  const std::array<Line*, 3> rows{&line(y - 1), &line(y), &line(y + 1)};
  const float scale = settings_.edge_operator == EdgeOperator::roberts ? 2.0f : 16.0f;
  for (size_t source = 0; source < kSourceCount; ++source) {
    if (!settings_.used(source)) continue;
    float* __restrict edges = flags.of(source);
    if (source == kDepthSource) {
      depth_edges(rows, edges);
      continue;
    }
    if (source == kIdSource) {
      id_strength(rows);
    } else {
      strength(source == kNormalSource ? kNormalPlane : source == kColorSource ? kColorPlane : kCustomPlane, 3, rows);
    }
    const float threshold = settings_.sources[source].threshold, least = scale * threshold * threshold;
    const float* squares = squares_.data();
    for (int x = 0; x < width_; ++x) edges[x] = squares[x] > least ? 1.0f : 0.0f;
  }
}

}  // namespace limn
