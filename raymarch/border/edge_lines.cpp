#include "raymarch/border/edge_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limn {
namespace {

// Where a source's row starts, in floats for each pixel, and how many it has.
constexpr size_t kDepthRow = 0, kToleranceRow = 1, kNormalRow = 2, kColorRow = 5, kCustomRow = 8, kVector = 3;

/// The square of the operator's answer, times 2 (Roberts) or 16 (Sobel). Lines a, b, c from the top; b is the pixel's own. `n` floats,
/// neighbouring pixels kStep floats apart.
template <int kStep>
void roberts(const float* __restrict b, const float* __restrict c, int n, float* __restrict squares) {
  for (int x = 0; x < n; ++x) {
    const float h = b[x] - c[x + kStep], v = b[x + kStep] - c[x];
    squares[x] = h * h + v * v;
  }
}

template <int kStep>
void sobel(const float* __restrict a, const float* __restrict b, const float* __restrict c, int n, float* __restrict squares) {
  for (int x = 0; x < n; ++x) {
    const float left = a[x - kStep], right = a[x + kStep], lower_left = c[x - kStep], lower_right = c[x + kStep];
    const float gx = (right - left) + 2.0f * (b[x + kStep] - b[x - kStep]) + (lower_right - lower_left);
    const float gy = (lower_left - left) + 2.0f * (c[x] - a[x]) + (lower_right - right);
    squares[x] = gx * gx + gy * gy;
  }
}

void sum_vectors(const float* __restrict wide, int n, float* __restrict squares) {
  for (int x = 0; x < n; ++x) squares[x] = wide[3 * x] + wide[3 * x + 1] + wide[3 * x + 2];
}

/// Ids have no size: the operator sees 1 where a pixel's id is another than the first pixel's (Sobel: the middle's), else 0.
void id_roberts(const std::uint32_t* __restrict b, const std::uint32_t* __restrict c, int n, float* __restrict squares) {
  for (int x = 0; x < n; ++x) squares[x] = (b[x] != c[x + 1] ? 1.0f : 0.0f) + (b[x + 1] != c[x] ? 1.0f : 0.0f);
}

void id_sobel(const std::uint32_t* __restrict a, const std::uint32_t* __restrict b, const std::uint32_t* __restrict c, int n,
              float* __restrict squares) {
  for (int x = 0; x < n; ++x) {
    const std::uint32_t own = b[x];
    const auto other = [own](std::uint32_t key) { return key != own ? 1.0f : 0.0f; };
    const float top_left = other(a[x - 1]), top_right = other(a[x + 1]), bottom_left = other(c[x - 1]), bottom_right = other(c[x + 1]);
    const float gx = (top_right - top_left) + 2.0f * (other(b[x + 1]) - other(b[x - 1])) + (bottom_right - bottom_left);
    const float gy = (bottom_left - top_left) + 2.0f * (other(c[x]) - other(a[x])) + (bottom_right - top_right);
    squares[x] = gx * gx + gy * gy;
  }
}

void repeat_ends(float* row, int n, size_t floats) {
  std::copy_n(row, floats, row - floats);
  float* end = row + static_cast<size_t>(n) * floats;
  std::copy_n(end - floats, floats, end);
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
      wide_squares_(kVector * squares_.size()),
      least_(stride_) {
  for (Line& each : lines_) {
    each.floats.reset(new float[kFloatsPerPixel * stride_]);
    each.keys.resize(stride_);
    each.grazed.resize(static_cast<size_t>((width_ + kChunk - 1) / kChunk));
  }
}

EdgeLines::Line& EdgeLines::line(int y) {
  const int row = std::clamp(y, 0, input_.gbuffer.height - 1);
  Line& slot = lines_[static_cast<size_t>(row) % 3];
  if (slot.row != row) fill(row, slot);
  return slot;
}

/// Depth as edge_sources.h derives it: 1/Z in units of the nearest, which is 0 where nothing is hit; without perspective Z in pixels. The
/// tolerance is the largest edge strength that a surface through this very pixel explains, still without its grazing factor. Where nothing
/// is hit it explains none.
void EdgeLines::fill_depth(size_t first, Line& out) {
  const float* __restrict z = input_.gbuffer.depth.pixels.data() + first;
  float* __restrict depth = row_of(out, kDepthRow, 1);
  float* __restrict tolerance = row_of(out, kToleranceRow, 1);
  const float threshold = settings_.sources[kDepthSource].threshold, growth = settings_.distance_factor, nearest = nearest_;
  if (input_.camera.projection == Projection::perspective) {
    const float scale = threshold / static_cast<float>(input_.camera.focal_px);
    for (int x = 0; x < width_; ++x) {
      const float inverse = nearest / z[x];
      depth[x] = inverse;
      tolerance[x] = scale * inverse * (inverse * (1.0f - growth) + growth);
    }
  } else {
    const auto scale = static_cast<float>(input_.camera.pixels_per_unit);
    constexpr float kNothing = -1e15f;  // its square is still finite
    for (int x = 0; x < width_; ++x) {
      const bool hit = z[x] < std::numeric_limits<float>::infinity();
      depth[x] = hit ? (z[x] - nearest) * scale : kNothing;
      tolerance[x] = hit ? threshold : 0.0f;
    }
  }
  repeat_ends(depth, width_, 1);
  repeat_ends(tolerance, width_, 1);
  std::fill(out.grazed.begin(), out.grazed.end(), std::uint8_t{0});
}

void EdgeLines::graze(Line& of, int chunk) {
  if (of.grazed[static_cast<size_t>(chunk)]) return;
  of.grazed[static_cast<size_t>(chunk)] = 1;
  const int first = chunk * kChunk, count = std::min(kChunk, width_ - first);
  float factors[kChunk];
  grazing_factors(settings_.grazing, &input_.gbuffer.n_dot_v.at(first, of.row), count, factors);
  float* tolerance = row_of(of, kToleranceRow, 1);
  for (int i = 0; i < count; ++i) tolerance[first + i] *= factors[i];
  repeat_ends(tolerance, width_, 1);
}

void EdgeLines::fill_normals(size_t first, Line& out) {
  const glm::vec3 clear(input_.camera.world_from_camera[2]);
  const std::int32_t* __restrict id = input_.gbuffer.id.pixels.data() + first;
  const auto* __restrict from = reinterpret_cast<const float*>(input_.gbuffer.normal.pixels.data() + first);
  float* __restrict to = row_of(out, kNormalRow, kVector);
  for (int x = 0; x < width_; ++x) {
    const bool hit = id[x] != 0;
    to[3 * x] = hit ? from[3 * x] : clear.x;
    to[3 * x + 1] = hit ? from[3 * x + 1] : clear.y;
    to[3 * x + 2] = hit ? from[3 * x + 2] : clear.z;
  }
  repeat_ends(to, width_, kVector);
}

void EdgeLines::fill_colors(size_t first, Line& out) {
  const GBuffer& seen = input_.gbuffer;
  float* to = row_of(out, kColorRow, kVector);
  for (int x = 0; x < width_; ++x) {
    const size_t i = first + static_cast<size_t>(x);
    const std::int32_t id = seen.id.pixels[i];
    const glm::vec3 color =
        id == 0 ? glm::vec3(0.0f) : input_.model.colors[static_cast<size_t>(id - 1)] * (0.25f + 0.75f * seen.n_dot_v.pixels[i]);
    for (int k = 0; k < 3; ++k) to[3 * x + k] = color[k];
  }
  repeat_ends(to, width_, kVector);
}

void EdgeLines::fill(int y, Line& out) {
  const GBuffer& seen = input_.gbuffer;
  const size_t first = seen.id.index(0, y);
  out.row = y;
  if (settings_.used(kDepthSource)) fill_depth(first, out);
  if (settings_.used(kNormalSource)) fill_normals(first, out);
  if (settings_.used(kColorSource)) fill_colors(first, out);
  if (settings_.used(kIdSource)) {
    // One key of object and material; the odd multiplier keeps keys of different objects far apart (Knuth's multiplicative hashing).
    std::uint32_t* keys = out.keys.data() + 1;
    const std::int32_t *id = seen.id.pixels.data() + first, *material = seen.material.pixels.data() + first;
    for (int x = 0; x < width_; ++x) keys[x] = static_cast<std::uint32_t>(id[x]) * 2654435761u + static_cast<std::uint32_t>(material[x]);
    keys[-1] = keys[0];
    keys[width_] = keys[width_ - 1];
  }
  if (settings_.used(kCustomSource)) {
    float* to = row_of(out, kCustomRow, kVector);
    std::copy_n(&settings_.custom->pixels[first].x, kVector * static_cast<size_t>(width_), to);
    repeat_ends(to, width_, kVector);
  }
}

void EdgeLines::strength(size_t floats_before, size_t floats, const Rows& rows) {
  const float *a = row_of(*rows[0], floats_before, floats), *b = row_of(*rows[1], floats_before, floats),
              *c = row_of(*rows[2], floats_before, floats);
  const bool cross = settings_.edge_operator == EdgeOperator::roberts;
  if (floats == 1) {
    cross ? roberts<1>(b, c, width_, squares_.data()) : sobel<1>(a, b, c, width_, squares_.data());
    return;
  }
  float* wide = wide_squares_.data();
  cross ? roberts<3>(b, c, 3 * width_, wide) : sobel<3>(a, b, c, 3 * width_, wide);
  sum_vectors(wide, width_, squares_.data());
}

void EdgeLines::id_strength(const Rows& rows) {
  const std::uint32_t *a = rows[0]->keys.data() + 1, *b = rows[1]->keys.data() + 1, *c = rows[2]->keys.data() + 1;
  if (settings_.edge_operator == EdgeOperator::roberts) {
    id_roberts(b, c, width_, squares_.data());
  } else {
    id_sobel(a, b, c, width_, squares_.data());
  }
}

/// A jump counts where no pixel of the neighbourhood explains it: the smallest tolerance decides, so that what lies behind a rounded edge,
/// seen straight, keeps the line that the grazing rim in front of it would suppress.
void EdgeLines::compare_depth(const Rows& rows, int x0, int x1, float* __restrict edges) {
  const bool cross = settings_.edge_operator == EdgeOperator::roberts;
  const float *a = row_of(*rows[cross ? 1 : 0], kToleranceRow, 1), *b = row_of(*rows[1], kToleranceRow, 1),
              *c = row_of(*rows[2], kToleranceRow, 1);
  float* least = least_.data() + 1;
  const int reach = cross ? 0 : 1;
  for (int x = x0 - 1; x <= x1; ++x) least[x] = std::min(std::min(a[x], b[x]), c[x]);
  const float scale = cross ? 2.0f : 16.0f;
  const float* squares = squares_.data();
  for (int x = x0; x < x1; ++x) {
    const float tolerance = std::min(std::min(least[x - reach], least[x]), least[x + 1]);
    edges[x] = squares[x] > scale * tolerance * tolerance ? 1.0f : 0.0f;
  }
}

/// The grazing factor is 1 or more: it is worked out only about jumps that the bare threshold lets through.
void EdgeLines::depth_edges(const Rows& rows, float* edges) {
  strength(kDepthRow, 1, rows);
  compare_depth(rows, 0, width_, edges);
  const auto chunks = static_cast<int>(rows[1]->grazed.size());
  for (int chunk = 0; chunk < chunks; ++chunk) {
    const int x0 = chunk * kChunk, x1 = std::min(width_, x0 + kChunk);
    if (std::find(edges + x0, edges + x1, 1.0f) == edges + x1) continue;
    for (Line* each : rows) {
      for (int near = std::max(0, chunk - 1); near <= std::min(chunks - 1, chunk + 1); ++near) graze(*each, near);
    }
    compare_depth(rows, x0, x1, edges);
  }
}

void EdgeLines::find_edges(int y, EdgeFlags& flags) {
  const Rows rows{&line(y - 1), &line(y), &line(y + 1)};
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
      strength(source == kNormalSource ? kNormalRow : source == kColorSource ? kColorRow : kCustomRow, kVector, rows);
    }
    const float threshold = settings_.sources[source].threshold, least = scale * threshold * threshold;
    const float* squares = squares_.data();
    for (int x = 0; x < width_; ++x) edges[x] = squares[x] > least ? 1.0f : 0.0f;
  }
}

}  // namespace limn
