#include "raymarch/border/surface_notes.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace limn {
namespace {

// What a plane's normals differ by in a level set of single precision; a sphere turns more from pixel to pixel unless its radius is
// beyond 30 000 px.
constexpr float kSameNormal = 3e-5f;

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

void join_if_same(const GBuffer& gbuffer, std::vector<std::uint32_t>& parent, size_t a, size_t b) {
  if (gbuffer.id.pixels[a] != gbuffer.id.pixels[b]) return;
  const glm::vec3 difference = gbuffer.normal.pixels[a] - gbuffer.normal.pixels[b];
  if (glm::dot(difference, difference) > kSameNormal * kSameNormal) return;
  const std::uint32_t root_a = root_of(parent, static_cast<std::uint32_t>(a)), root_b = root_of(parent, static_cast<std::uint32_t>(b));
  parent[std::max(root_a, root_b)] = std::min(root_a, root_b);
}

/// For each pixel the first pixel of its region.
std::vector<std::uint32_t> flat_regions(const GBuffer& gbuffer) {
  std::vector<std::uint32_t> parent(gbuffer.id.size());
  std::iota(parent.begin(), parent.end(), 0u);
  for (int y = 0; y < gbuffer.height; ++y) {
    for (int x = 0; x < gbuffer.width; ++x) {
      const size_t i = gbuffer.id.index(x, y);
      if (gbuffer.id.pixels[i] == 0) continue;
      if (x > 0) join_if_same(gbuffer, parent, i, i - 1);
      if (y > 0) join_if_same(gbuffer, parent, i, i - static_cast<size_t>(gbuffer.width));
    }
  }
  for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = parent[parent[i]];  // roots come first
  return parent;
}

std::string flat_note(const std::string& name, const GBuffer& gbuffer, const Image<float>& coverage) {
  const std::vector<FlatFace> faces = flat_faces(gbuffer, coverage);
  if (faces.empty()) return {};
  std::int64_t flat = 0, inked = 0, clear = 0;
  for (const FlatFace& face : faces) {
    flat += face.pixels;
    inked += face.inked == face.pixels;
    clear += face.inked == 0;
  }
  const auto count = static_cast<std::int64_t>(faces.size());
  const double share = 100.0 * static_cast<double>(flat) / static_cast<double>(std::max<std::int64_t>(1, count_hits(gbuffer).hits));
  return fmt::format(
      "{} undefined (zero curvature) on {} flat face{}, {:.1f} % of the pixels hit: {} flipped whole to border, {} whole clear, {} mixed",
      name, count, count == 1 ? "" : "s", share, inked, clear, count - inked - clear);
}

/// One note for each object that is almost wholly turned away: its normals point inwards, or the eye is inside it.
void add_inverted_notes(const std::string& name, const GBuffer& gbuffer, std::vector<std::string>& notes) {
  const std::int32_t objects = gbuffer.id.pixels.empty() ? 0 : *std::max_element(gbuffer.id.pixels.begin(), gbuffer.id.pixels.end());
  std::vector<std::int64_t> seen(static_cast<size_t>(objects) + 1), turned(static_cast<size_t>(objects) + 1);
  for (size_t i = 0; i < gbuffer.id.size(); ++i) {
    const auto id = static_cast<size_t>(gbuffer.id.pixels[i]);
    ++seen[id];
    turned[id] += gbuffer.n_dot_v.pixels[i] <= 0.0f;
  }
  for (size_t id = 1; id < seen.size(); ++id) {
    if (seen[id] == 0 || static_cast<double>(turned[id]) < 0.95 * static_cast<double>(seen[id])) continue;
    notes.push_back(
        fmt::format("{}: the whole of object {} is border: N.V <= 0 on {:.1f} % of its {} pixels; its orientation is inverted, "
                    "or the eye is inside it",
                    name, id, 100.0 * static_cast<double>(turned[id]) / static_cast<double>(seen[id]), seen[id]));
  }
}

}  // namespace

std::vector<FlatFace> flat_faces(const GBuffer& gbuffer, const Image<float>& coverage, std::int64_t min_pixels) {
  const std::vector<std::uint32_t> region = flat_regions(gbuffer);
  std::vector<std::uint32_t> size(region.size(), 0);
  for (size_t i = 0; i < region.size(); ++i) size[region[i]] += gbuffer.id.pixels[i] != 0;
  std::map<std::uint32_t, FlatFace> found;
  for (size_t i = 0; i < region.size(); ++i) {
    if (gbuffer.id.pixels[i] == 0 || size[region[i]] < min_pixels) continue;
    FlatFace& face = found[region[i]];
    face.id = gbuffer.id.pixels[i];
    ++face.pixels;
    face.inked += coverage.pixels[i] > 0.5f;
  }
  std::vector<FlatFace> faces;
  faces.reserve(found.size());
  for (const auto& [first_pixel, face] : found) faces.push_back(face);
  std::stable_sort(faces.begin(), faces.end(), [](const FlatFace& a, const FlatFace& b) { return a.pixels > b.pixels; });
  return faces;
}

std::vector<std::string> surface_notes(const std::string& name, const GBuffer& gbuffer, const Image<float>& coverage) {
  std::vector<std::string> notes;
  if (std::string note = flat_note(name, gbuffer, coverage); !note.empty()) notes.push_back(std::move(note));
  add_inverted_notes(name, gbuffer, notes);
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

double smoothstep(double edge0, double edge1, double x) {
  if (!(edge1 > edge0)) return x >= edge1 ? 1.0 : 0.0;
  const double t = std::clamp((x - edge0) / (edge1 - edge0), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace limn
