#include "raymarch/border/surface_tally.h"

#include <algorithm>

#include "raymarch/border/surface_notes.h"
#include "raymarch/gbuffer/stream_fill.h"
#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/border/surface_tally.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

static_assert(sizeof(glm::vec3) == 3 * sizeof(float));

/// As have_same_normal(), of pixels a + k and b + k for k < count: sets `bit` in facts[k] where they have. Returns how many pixels it did,
/// as many as fill whole registers; adds to `pairs`.
size_t SamePairs(const GBuffer& layers, size_t a, size_t b, size_t count, std::uint8_t bit, std::uint8_t* facts, std::int64_t& pairs) {
  const hn::ScalableTag<float> f;
  const hn::RebindToSigned<decltype(f)> i32;
  const hn::Rebind<std::uint8_t, decltype(f)> u8;
  const size_t lanes = hn::Lanes(f);
  const auto most = hn::Set(f, kSameNormal * kSameNormal);
  const std::int32_t* const id = layers.id.pixels.data();
  size_t k = 0;
  for (; k + lanes <= count; k += lanes) {
    const auto of = hn::LoadU(i32, id + a + k);
    const auto together = hn::RebindMask(f, hn::And(hn::Ne(of, hn::Zero(i32)), hn::Eq(of, hn::LoadU(i32, id + b + k))));
    if (hn::AllFalse(f, together)) continue;
    hn::Vec<decltype(f)> ax, ay, az, bx, by, bz;
    hn::LoadInterleaved3(f, &layers.normal.pixels[a + k].x, ax, ay, az);
    hn::LoadInterleaved3(f, &layers.normal.pixels[b + k].x, bx, by, bz);
    const auto dx = hn::Sub(ax, bx), dy = hn::Sub(ay, by), dz = hn::Sub(az, bz);
    const auto squared = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
    const auto same = hn::And(together, hn::Not(hn::Gt(squared, most)));
    if (hn::AllFalse(f, same)) continue;  // as mostly on curved surfaces
    pairs += static_cast<std::int64_t>(hn::CountTrue(f, same));
    const auto bits = hn::DemoteTo(u8, hn::IfThenElseZero(hn::RebindMask(i32, same), hn::Set(i32, bit)));
    hn::StoreU(hn::Or(hn::LoadU(u8, facts + k), bits), u8, facts + k);
  }
  return k;
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(SamePairs);

std::int64_t same_pairs_of(const GBuffer& layers, size_t a, size_t b, size_t count, std::uint8_t bit, std::uint8_t* facts) {
  std::int64_t pairs = 0;
  for (size_t k = HWY_DYNAMIC_DISPATCH(SamePairs)(layers, a, b, count, bit, facts, pairs); k < count; ++k) {
    if (layers.id.pixels[a + k] == 0 || !have_same_normal(layers, a + k, b + k)) continue;
    facts[k] = static_cast<std::uint8_t>(facts[k] | bit);
    ++pairs;
  }
  return pairs;
}

/// Pixels of an object: neighbours mostly show the same one.
struct ObjectRun {
  size_t id = 0;
  std::int64_t seen = 0, turned = 0;
};

void add_run(const ObjectRun& run, SurfaceTally& tally) {
  if (run.seen == 0) return;
  tally.seen[run.id].fetch_add(run.seen, std::memory_order_relaxed);
  tally.turned[run.id].fetch_add(run.turned, std::memory_order_relaxed);
}

void add_objects(const GBuffer& layers, size_t start, size_t count, ObjectRun& run, SurfaceTally& tally) {
  for (size_t i = start; i < start + count;) {
    const std::int32_t id = layers.id.pixels[i];
    const size_t begin = i;
    std::int64_t turned = 0;
    for (; i < start + count && layers.id.pixels[i] == id; ++i) turned += layers.n_dot_v.pixels[i] <= 0.0f;
    if (id == 0) continue;
    if (static_cast<size_t>(id) != run.id) {
      add_run(run, tally);
      run = {static_cast<size_t>(id), 0, 0};
    }
    run.seen += static_cast<std::int64_t>(i - begin);
    run.turned += turned;
  }
}

void copy_pixel(const GBuffer& from, size_t i, GBuffer& to, size_t k) {
  to.id.pixels[k] = from.id.pixels[i];
  to.normal.pixels[k] = from.normal.pixels[i];
}

/// What neighbours in other cells will be compared with.
void keep_edges(const GBuffer& layers, const glm::ivec2& first, const PixelTile& pixels, SurfaceTally& tally) {
  const auto at = [&](int x, int y) { return layers.id.index(x - first.x, y - first.y); };
  const int row = pixels.y / tally.cell_px.y, column = pixels.x / tally.cell_px.x;
  const int last_x = pixels.x + pixels.width - 1, last_y = pixels.y + pixels.height - 1;
  for (int x = pixels.x; x <= last_x; ++x) {
    copy_pixel(layers, at(x, pixels.y), tally.lines, tally.lines.id.index(x, 2 * row));
    copy_pixel(layers, at(x, last_y), tally.lines, tally.lines.id.index(x, 2 * row + 1));
  }
  for (int y = pixels.y; y <= last_y; ++y) {
    if (pixels.x == column * tally.cell_px.x) copy_pixel(layers, at(pixels.x, y), tally.columns, tally.columns.id.index(2 * column, y));
    if (last_x == (column + 1) * tally.cell_px.x - 1)
      copy_pixel(layers, at(last_x, y), tally.columns, tally.columns.id.index(2 * column + 1, y));
  }
}

GBuffer edges_of(int width, int height) {
  GBuffer edges;
  edges.width = width;
  edges.height = height;
  edges.id = Image<std::int32_t>(width, height, 0);
  edges.normal = Image<glm::vec3>::unset(width, height);  // not read where the id is 0
  return edges;
}

int cells(int pixels, int cell) { return (pixels + cell - 1) / cell; }

}  // namespace

SurfaceTally::SurfaceTally(size_t objects, const glm::ivec2& size_px, const glm::ivec2& cell)
    : cell_px(cell),
      facts(Image<std::uint8_t>::unset(size_px.x, size_px.y)),
      lines(edges_of(size_px.x, 2 * cells(size_px.y, cell.y))),
      columns(edges_of(2 * cells(size_px.x, cell.x), size_px.y)),
      seen(objects + 1),
      turned(objects + 1) {}

void add_pixels(const GBuffer& layers, const glm::ivec2& first, const PixelTile& pixels, SurfaceTally& tally) {
  const auto count = static_cast<size_t>(pixels.width), stride = static_cast<size_t>(layers.width);
  const bool with_normals = !layers.normal.pixels.empty();
  ObjectRun run;
  std::int64_t pairs = 0, hits = 0, out_of_steps = 0;
  for (int y = 0; y < pixels.height; ++y) {
    const size_t start = layers.id.index(pixels.x - first.x, pixels.y - first.y + y);
    std::uint8_t* const facts = &tally.facts.at(pixels.x, pixels.y + y);
    for (size_t k = 0; k < count; ++k) {
      const std::uint8_t status = layers.status.pixels[start + k];
      hits += status == static_cast<std::uint8_t>(HitStatus::hit);
      out_of_steps += status == static_cast<std::uint8_t>(HitStatus::out_of_steps);
      facts[k] = layers.id.pixels[start + k] != 0 ? kIsHit : 0;
    }
    if (with_normals) pairs += same_pairs_of(layers, start + 1, start, count - 1, kSameAsLeft, facts + 1);
    if (with_normals && y > 0) pairs += same_pairs_of(layers, start, start - stride, count, kSameAsAbove, facts);
    add_objects(layers, start, count, run, tally);
  }
  add_run(run, tally);
  if (with_normals) keep_edges(layers, first, pixels, tally);
  tally.same_pairs.fetch_add(pairs, std::memory_order_relaxed);
  tally.hits.fetch_add(hits, std::memory_order_relaxed);
  tally.out_of_steps.fetch_add(out_of_steps, std::memory_order_relaxed);
}

void add_nothing(const PixelTile& pixels, SurfaceTally& tally) { fill_rows(tally.facts, pixels, std::uint8_t{0}); }

void add_ink(std::span<const float> coverage, size_t method, size_t at, SurfaceTally& tally) {
  const auto bit = static_cast<std::uint8_t>(kInkedByFirst << method);
  std::uint8_t* const facts = &tally.facts.pixels[at];
  for (size_t k = 0; k < coverage.size(); ++k) facts[k] = static_cast<std::uint8_t>(facts[k] | (coverage[k] > 0.5f ? bit : 0));
}

void join_cells(SurfaceTally& tally) {
  const auto width = static_cast<size_t>(tally.facts.width);
  std::int64_t pairs = 0;
  for (int row = 1; 2 * row < tally.lines.height; ++row) {
    const size_t first = tally.lines.id.index(0, 2 * row);
    pairs += same_pairs_of(tally.lines, first, first - width, width, kSameAsAbove, &tally.facts.at(0, row * tally.cell_px.y));
  }
  for (int y = 0; y < tally.columns.height; ++y) {
    for (int column = 1; 2 * column < tally.columns.width; ++column) {
      const size_t first = tally.columns.id.index(2 * column, y);
      pairs += same_pairs_of(tally.columns, first, first - 1, 1, kSameAsLeft, &tally.facts.at(column * tally.cell_px.x, y));
    }
  }
  tally.same_pairs += pairs;
}

}  // namespace limn
#endif
