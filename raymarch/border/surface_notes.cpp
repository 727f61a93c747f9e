#include "raymarch/border/surface_notes.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>

#include "raymarch/border/surface_tally.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

/// Pairs of neighbours with the same normal. A region of n pixels has n - 1 of them or more.
std::int64_t same_pairs(const GBuffer& gbuffer) {
  const auto width = static_cast<size_t>(gbuffer.width);
  return parallel_reduce(
      gbuffer.height, 8, std::int64_t{0},
      [&](const IndexRange<int>& rows, std::int64_t pairs) {
        for (int y = rows.first; y < rows.last; ++y) {
          for (size_t i = gbuffer.id.index(0, y), x = 0; x < width; ++i, ++x) {
            if (gbuffer.id.pixels[i] == 0) continue;
            if (x > 0) pairs += have_same_normal(gbuffer, i, i - 1);
            if (y > 0) pairs += have_same_normal(gbuffer, i, i - width);
          }
        }
        return pairs;
      },
      std::plus<>());
}

/// What is asked of a picture's pixels, by their indices.
struct BufferPixels {
  const GBuffer& gbuffer;
  const Image<float>& coverage;
  int width() const { return gbuffer.width; }
  int height() const { return gbuffer.height; }
  std::int32_t id(size_t i) const { return gbuffer.id.pixels[i]; }
  bool same_as_left(size_t i) const { return have_same_normal(gbuffer, i, i - 1); }
  bool same_as_above(size_t i) const { return have_same_normal(gbuffer, i, i - static_cast<size_t>(gbuffer.width)); }
  bool inked(size_t i) const { return coverage.pixels[i] > 0.5f; }
};
struct TallyPixels {
  const Image<std::uint8_t>& facts;
  std::uint8_t ink;
  int width() const { return facts.width; }
  int height() const { return facts.height; }
  std::int32_t id(size_t i) const { return facts.pixels[i] & kIsHit; }  // 1 for all objects
  bool same_as_left(size_t i) const { return (facts.pixels[i] & kSameAsLeft) != 0; }
  bool same_as_above(size_t i) const { return (facts.pixels[i] & kSameAsAbove) != 0; }
  bool inked(size_t i) const { return (facts.pixels[i] & ink) != 0; }
};

void join(std::vector<std::uint32_t>& parent, size_t a, size_t b) {
  const std::uint32_t root_a = root_of(parent, static_cast<std::uint32_t>(a)), root_b = root_of(parent, static_cast<std::uint32_t>(b));
  parent[std::max(root_a, root_b)] = std::min(root_a, root_b);
}

/// For each pixel the first pixel of its region.
template <class Seen>
std::vector<std::uint32_t> flat_regions(const Seen& seen) {
  const auto width = static_cast<size_t>(seen.width());
  std::vector<std::uint32_t> parent(width * static_cast<size_t>(seen.height()));
  std::iota(parent.begin(), parent.end(), 0u);
  size_t i = 0;
  for (int y = 0; y < seen.height(); ++y) {
    for (size_t x = 0; x < width; ++x, ++i) {
      if (seen.id(i) == 0) continue;
      if (x > 0 && seen.same_as_left(i)) join(parent, i, i - 1);
      if (y > 0 && seen.same_as_above(i)) join(parent, i, i - width);
    }
  }
  for (std::uint32_t k = 0; k < parent.size(); ++k) parent[k] = parent[parent[k]];  // roots come first
  return parent;
}

template <class Seen>
std::vector<FlatFace> faces_of(const Seen& seen, std::int64_t min_pixels) {
  const std::vector<std::uint32_t> region = flat_regions(seen);
  std::vector<std::uint32_t> size(region.size(), 0);
  for (size_t i = 0; i < region.size(); ++i) size[region[i]] += seen.id(i) != 0;
  std::map<std::uint32_t, FlatFace> found;
  for (size_t i = 0; i < region.size(); ++i) {
    if (seen.id(i) == 0 || size[region[i]] < min_pixels) continue;
    FlatFace& face = found[region[i]];
    face.id = seen.id(i);
    ++face.pixels;
    face.inked += seen.inked(i);
  }
  std::vector<FlatFace> faces;
  faces.reserve(found.size());
  for (const auto& [first_pixel, face] : found) faces.push_back(face);
  std::stable_sort(faces.begin(), faces.end(), [](const FlatFace& a, const FlatFace& b) { return a.pixels > b.pixels; });
  return faces;
}

/// Nothing where no face is flat.
void add_flat_note(const std::string& name, const std::vector<FlatFace>& faces, std::int64_t hits, std::vector<std::string>& notes) {
  if (faces.empty()) return;
  std::int64_t flat = 0, inked = 0, clear = 0;
  for (const FlatFace& face : faces) {
    flat += face.pixels;
    inked += face.inked == face.pixels;
    clear += face.inked == 0;
  }
  const auto count = static_cast<std::int64_t>(faces.size());
  const double share = 100.0 * static_cast<double>(flat) / static_cast<double>(std::max<std::int64_t>(1, hits));
  notes.push_back(fmt::format(
      "{} undefined (zero curvature) on {} flat face{}, {:.1f} % of the pixels hit: {} flipped whole to border, {} whole clear, {} mixed",
      name, count, count == 1 ? "" : "s", share, inked, clear, count - inked - clear));
}

struct ObjectPixels {
  std::int64_t seen = 0, turned = 0;
};

/// By id; nothing is counted where nothing is hit.
std::vector<ObjectPixels> pixels_of_objects(const GBuffer& gbuffer) {
  return parallel_reduce(
      gbuffer.id.size(), size_t{1} << 14, std::vector<ObjectPixels>{},
      [&](const IndexRange<size_t>& part, std::vector<ObjectPixels> objects) {
        for (size_t i = part.first; i < part.last; ++i) {
          const auto id = static_cast<size_t>(gbuffer.id.pixels[i]);
          if (id == 0) continue;
          if (id >= objects.size()) objects.resize(id + 1);
          ++objects[id].seen;
          objects[id].turned += gbuffer.n_dot_v.pixels[i] <= 0.0f;
        }
        return objects;
      },
      [](std::vector<ObjectPixels> left, const std::vector<ObjectPixels>& right) {
        left.resize(std::max(left.size(), right.size()));
        for (size_t id = 0; id < right.size(); ++id) {
          left[id].seen += right[id].seen;
          left[id].turned += right[id].turned;
        }
        return left;
      });
}

/// One note for each object that is almost wholly turned away: its normals point inwards, or the eye is inside it.
void add_inverted_notes(const std::string& name, const std::vector<ObjectPixels>& objects, std::vector<std::string>& notes) {
  for (size_t id = 1; id < objects.size(); ++id) {
    const auto [seen, turned] = objects[id];
    if (seen == 0 || static_cast<double>(turned) < 0.95 * static_cast<double>(seen)) continue;
    notes.push_back(
        fmt::format("{}: the whole of object {} is border: N.V <= 0 on {:.1f} % of its {} pixels; its orientation is inverted, "
                    "or the eye is inside it",
                    name, id, 100.0 * static_cast<double>(turned) / static_cast<double>(seen), seen));
  }
}

}  // namespace

std::vector<FlatFace> flat_faces(const GBuffer& gbuffer, const Image<float>& coverage, std::int64_t min_pixels) {
  if (same_pairs(gbuffer) < min_pixels - 1) return {};  // as most pictures of curved surfaces have none
  return faces_of(BufferPixels{gbuffer, coverage}, min_pixels);
}

std::vector<std::string> surface_notes(const std::string& name, const GBuffer& gbuffer, const Image<float>& coverage) {
  std::vector<std::string> notes;
  if (const std::vector<FlatFace> faces = flat_faces(gbuffer, coverage); !faces.empty())
    add_flat_note(name, faces, count_hits(gbuffer).hits, notes);
  add_inverted_notes(name, pixels_of_objects(gbuffer), notes);
  return notes;
}

std::vector<std::string> surface_notes(const std::string& name, const SurfaceTally& tally, size_t method) {
  std::vector<std::string> notes;
  if (tally.same_pairs >= kFlatPixels - 1) {
    const auto ink = static_cast<std::uint8_t>(kInkedByFirst << method);
    add_flat_note(name, faces_of(TallyPixels{tally.facts, ink}, kFlatPixels), tally.hits, notes);
  }
  std::vector<ObjectPixels> objects;
  objects.reserve(tally.seen.size());
  for (size_t id = 0; id < tally.seen.size(); ++id) objects.push_back({tally.seen[id], tally.turned[id]});
  add_inverted_notes(name, objects, notes);
  return notes;
}

std::string meetings_note(const std::string& name, const BorderInput& input, const Image<float>& coverage, const std::string& reason) {
  if (input.model.surfaces.size() < 2) return {};
  const Image<std::int32_t>& id = input.gbuffer.id;
  std::int64_t all = 0, bare = 0;
  const auto look = [&](size_t i, size_t j) {
    if (id.pixels[i] == 0 || id.pixels[j] == 0 || id.pixels[i] == id.pixels[j]) return;
    ++all;
    bare += coverage.pixels[i] < 0.5f && coverage.pixels[j] < 0.5f;
  };
  for (int y = 0; y < id.height; ++y) {
    for (int x = 0; x < id.width; ++x) {
      const size_t i = id.index(x, y);
      if (x + 1 < id.width) look(i, i + 1);
      if (y + 1 < id.height) look(i, i + static_cast<size_t>(id.width));
    }
  }
  if (bare == 0) return {};
  return fmt::format("{}: {} of {} places where one object meets another have no line: {}", name, bare, all, reason);
}

}  // namespace limn
