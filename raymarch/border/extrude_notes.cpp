// Where an extruded outline fails, in numbers taken from the picture and from the hull.

#include <fmt/core.h>

#include <algorithm>
#include <functional>

#include "raymarch/border/edge_visibility.h"
#include "raymarch/border/extrude.h"
#include "raymarch/border/silhouette.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

enum class OutlinePixel : std::uint8_t { none, inked, gap };

/// `outwards(i, j)`: pixel j lies outwards of pixel i, which shows an object.
template <class Outwards>
OutlinePixel outline_pixel(const GBuffer& seen, const Image<float>& coverage, int x, int y, const Outwards& outwards) {
  const size_t i = seen.id.index(x, y);
  if (seen.id.pixels[i] == 0) return OutlinePixel::none;
  const auto out = [&](int u, int v) { return seen.id.inside(u, v) && outwards(i, seen.id.index(u, v)); };
  if (!out(x - 1, y) && !out(x + 1, y) && !out(x, y - 1) && !out(x, y + 1)) return OutlinePixel::none;
  for (int v = y - 1; v <= y + 1; ++v) {
    for (int u = x - 1; u <= x + 1; ++u) {
      if (out(u, v) && coverage.at(u, v) >= 0.5f) return OutlinePixel::inked;
    }
  }
  return OutlinePixel::gap;
}

/// Pixels of the 8-connected run from (x, y), which it removes.
std::int64_t take_run(Image<OutlinePixel>& kind, int x, int y) {
  std::vector<glm::ivec2> stack{{x, y}};
  kind.at(x, y) = OutlinePixel::none;
  std::int64_t pixels = 0;
  while (!stack.empty()) {
    const glm::ivec2 p = stack.back();
    stack.pop_back();
    ++pixels;
    for (int v = p.y - 1; v <= p.y + 1; ++v) {
      for (int u = p.x - 1; u <= p.x + 1; ++u) {
        if (!kind.inside(u, v) || kind.at(u, v) != OutlinePixel::gap) continue;
        kind.at(u, v) = OutlinePixel::none;
        stack.emplace_back(u, v);
      }
    }
  }
  return pixels;
}

template <class Outwards>
OutlineGaps gaps_where(const GBuffer& gbuffer, const Image<float>& coverage, const Outwards& outwards) {
  OutlineGaps result;
  Image<OutlinePixel> kind(gbuffer.width, gbuffer.height, OutlinePixel::none);
  for (int y = 0; y < gbuffer.height; ++y) {
    for (int x = 0; x < gbuffer.width; ++x) {
      kind.at(x, y) = outline_pixel(gbuffer, coverage, x, y, outwards);
      result.outline_pixels += kind.at(x, y) != OutlinePixel::none;
      result.gap_pixels += kind.at(x, y) == OutlinePixel::gap;
    }
  }
  for (int y = 0; y < gbuffer.height; ++y) {
    for (int x = 0; x < gbuffer.width; ++x) {
      if (kind.at(x, y) != OutlinePixel::gap) continue;
      ++result.gaps;
      result.longest_px = std::max(result.longest_px, take_run(kind, x, y));
    }
  }
  return result;
}

/// Six times the volume of the mesh, about its first corner.
double signed_volume(const Polygons& polygons) {
  const Mesh& mesh = polygons.mesh();
  const auto at = [&mesh](std::uint32_t corner) { return mesh.positions[static_cast<size_t>(mesh.corner_vertices[corner])]; };
  const glm::dvec3 origin = at(0);
  double sum = 0.0;
  for (const glm::uvec3& t : polygons.corner_triangles()) sum += glm::dot(at(t.x) - origin, glm::cross(at(t.y) - origin, at(t.z) - origin));
  return sum;
}

bool closed(const EdgeTopology& topology) {
  return std::all_of(topology.edges.begin(), topology.edges.end(), [](const TopologyEdge& edge) { return edge.face_b >= 0; });
}

glm::dvec2 image_of(const Camera& camera, const glm::dvec3& in_camera) {
  const double scale = pixels_per_unit_at(camera, in_camera.z);
  return {0.5 * camera.width_px + scale * in_camera.x, 0.5 * camera.height_px - scale * in_camera.y};
}

/// The corner of a face at a vertex, or at another one in the same place.
std::int32_t corner_at(const Polygons& polygons, std::int32_t face, std::int32_t vertex) {
  const Mesh& mesh = polygons.mesh();
  const std::vector<std::int32_t>& first = polygons.edges().first_corners;
  const auto place = [&mesh](std::int32_t v) { return mesh.positions[static_cast<size_t>(v)]; };
  for (std::int32_t c = first[static_cast<size_t>(face)]; c < first[static_cast<size_t>(face) + 1]; ++c) {
    if (place(mesh.corner_vertices[static_cast<size_t>(c)]) == place(vertex)) return c;
  }
  return first[static_cast<size_t>(face)];
}

/// The faces meet in a valley. What turns away there lies behind what is before the valley, whatever single samples say.
bool concave(const Polygons& polygons, const TopologyEdge& edge) {
  const Mesh& mesh = polygons.mesh();
  const std::vector<std::int32_t>& first = polygons.edges().first_corners;
  const glm::dvec3& on_edge = mesh.positions[static_cast<size_t>(edge.vertex_a)];
  glm::dvec3 sum(0.0);
  for (std::int32_t c = first[static_cast<size_t>(edge.face_b)]; c < first[static_cast<size_t>(edge.face_b) + 1]; ++c)
    sum += mesh.positions[static_cast<size_t>(mesh.corner_vertices[static_cast<size_t>(c)])] - on_edge;
  return glm::dot(sum, polygons.edges().face_normals[static_cast<size_t>(edge.face_a)]) > 0.0;
}

/// A corner before it grows, in camera axes.
glm::dvec3 rest_of(const Polygons& polygons, const Camera& camera, size_t corner) {
  const Mesh& mesh = polygons.mesh();
  return in_camera_axes(camera, mesh.positions[static_cast<size_t>(mesh.corner_vertices[corner])]);
}

/// Across the image of the edge from a to b, away from the face that is seen from the front.
glm::dvec2 outward_normal(const Polygons& polygons, std::int32_t front, const glm::dvec2& a, const glm::dvec2& b, const Camera& camera) {
  const std::vector<std::int32_t>& first = polygons.edges().first_corners;
  glm::dvec2 middle(0.0);
  const std::int32_t begin = first[static_cast<size_t>(front)], end = first[static_cast<size_t>(front) + 1];
  for (std::int32_t c = begin; c < end; ++c)
    middle += image_of(camera, rest_of(polygons, camera, static_cast<size_t>(c))) / static_cast<double>(end - begin);
  const glm::dvec2 along = glm::normalize(b - a), normal(-along.y, along.x);
  return glm::dot(middle - a, normal) > 0.0 ? -normal : normal;
}

}  // namespace

OutlineGaps outline_gaps(const GBuffer& gbuffer, const Image<float>& coverage) {
  return gaps_where(gbuffer, coverage, [&](size_t i, size_t j) {
    return gbuffer.id.pixels[j] != gbuffer.id.pixels[i] && (gbuffer.id.pixels[j] == 0 || gbuffer.depth.pixels[j] > gbuffer.depth.pixels[i]);
  });
}

OutlineGaps outline_gaps(const BorderInput& input, const GroupSettings& settings, const Image<float>& coverage) {
  if (settings.by == GroupBy::all)
    return gaps_where(input.gbuffer, coverage, [&](size_t, size_t j) { return input.gbuffer.id.pixels[j] == 0; });
  const PictureGroups groups(input, settings.by);
  return gaps_where(input.gbuffer, coverage, [&](size_t i, size_t j) { return groups.of(i) != groups.of(j) && groups.in_front(i, j); });
}

InkBeyond ink_beyond(const GBuffer& gbuffer, const Image<float>& coverage, double width_px) {
  InkBeyond result;
  const int reach = std::min(kLargestReach_px, static_cast<int>(std::ceil(4.0 * width_px)) + 4);
  const Image<std::int32_t> squares = exact_squares(find_silhouette(gbuffer, false), reach);
  for (size_t i = 0; i < squares.size(); ++i) {
    if (gbuffer.id.pixels[i] != 0 || coverage.pixels[i] <= 0.5f) continue;
    ++result.ink_pixels;
    const std::int32_t square = squares.pixels[i];
    const double distance = square == kFarSquared ? static_cast<double>(reach) : std::sqrt(static_cast<double>(square)) / kSubPixels;
    if (distance <= width_px + 1.0) continue;
    ++result.beyond_pixels;
    result.farthest_px = std::max(result.farthest_px, distance);
  }
  return result;
}

namespace {

/// A convex edge between a face that turns to the eye and one that does not.
struct OutlineEdge {
  size_t edge = 0;
  bool a_front = false;  ///< The first one does.
};

std::vector<OutlineEdge> outline_edges(const Polygons& polygons, const Camera& camera) {
  constexpr size_t kTogether = 16384;
  const Mesh& mesh = polygons.mesh();
  const EdgeTopology& topology = polygons.edges();
  std::vector<std::vector<OutlineEdge>> parts((topology.edges.size() + kTogether - 1) / kTogether);
  parallel_each(parts.size(), [&](size_t part) {
    for (size_t e = part * kTogether; e < std::min((part + 1) * kTogether, topology.edges.size()); ++e) {
      const TopologyEdge& edge = topology.edges[e];
      if (edge.face_b < 0 || edge.opposed) continue;
      const glm::dvec3 &a = mesh.positions[static_cast<size_t>(edge.vertex_a)], &b = mesh.positions[static_cast<size_t>(edge.vertex_b)];
      const glm::dvec3 to_eye = view_vector(camera, 0.5 * (a + b));
      const bool a_front = glm::dot(topology.face_normals[static_cast<size_t>(edge.face_a)], to_eye) > 0.0;
      const bool b_front = glm::dot(topology.face_normals[static_cast<size_t>(edge.face_b)], to_eye) > 0.0;
      if (a_front != b_front && !concave(polygons, edge)) parts[part].push_back({e, a_front});
    }
  });
  std::vector<OutlineEdge> all;
  for (const std::vector<OutlineEdge>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace

void HullNotes::add(const BorderInput& input, size_t object, std::span<const glm::dvec3> grown, const ExtrudeSettings& settings) {
  const Polygons& polygons = *input.model.surfaces[object].polygons;
  const Mesh& mesh = polygons.mesh();
  const EdgeTopology& topology = polygons.edges();
  inverted_objects_ += closed(topology) && signed_volume(polygons) < 0.0;
  if (settings.direction == ExtrudeDirection::vertex_normal) {
    const std::span<const glm::vec3> normals = polygons.corner_normals();
    wrong_corners_ += parallel_reduce(
        mesh.face_count(), size_t{8192}, std::int64_t{0},
        [&](const IndexRange<size_t>& range, std::int64_t count) {
          for (size_t f = range.begin(); f < range.end(); ++f)
            for (std::int32_t c = topology.first_corners[f]; c < topology.first_corners[f + 1]; ++c)
              count += glm::dot(glm::dvec3(normals[static_cast<size_t>(c)]), topology.face_normals[f]) < 0.0;
          return count;
        },
        std::plus<>());
    corners_ += static_cast<std::int64_t>(normals.size());
  }
  const EdgeVisibility view(input);
  for (const OutlineEdge& outline : outline_edges(polygons, view.camera())) {
    const TopologyEdge& edge = topology.edges[outline.edge];
    const bool a_front = outline.a_front;
    const glm::dvec3 &a = mesh.positions[static_cast<size_t>(edge.vertex_a)], &b = mesh.positions[static_cast<size_t>(edge.vertex_b)];
    ImageEdge image;
    image.object = static_cast<std::int32_t>(object);
    image.face_a = edge.face_a;
    image.face_b = edge.face_b;
    if (!view.place(a, b, 0.0, image) || !view.visible(image, 0.5) || image.a == image.b) continue;
    const std::int32_t front = a_front ? edge.face_a : edge.face_b, back = a_front ? edge.face_b : edge.face_a;
    const glm::dvec2 out = outward_normal(polygons, front, image.a, image.b, view.camera());
    for (const std::int32_t vertex : {edge.vertex_a, edge.vertex_b}) {
      double width = -std::numeric_limits<double>::infinity();
      // The back face alone is drawn, or both are and the wider one shows.
      for (const std::int32_t face : {back, settings.mask == ExtrudeMask::stencil ? front : back}) {
        const auto c = static_cast<size_t>(corner_at(polygons, face, vertex));
        const glm::dvec3 rest = rest_of(polygons, view.camera(), c);
        if (!(rest.z > view.near() && grown[c].z > view.near())) continue;
        width = std::max(width, glm::dot(image_of(view.camera(), grown[c]) - image_of(view.camera(), rest), out));
      }
      if (std::isfinite(width)) samples_.push_back({width, 0.5 * glm::length(image.b - image.a)});
    }
  }
}

DrawnWidths HullNotes::widths() const {
  std::vector<WeightedValue> sorted = samples_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const WeightedValue& a, const WeightedValue& b) { return a.value < b.value; });
  double total = 0.0, inward = 0.0;
  for (const WeightedValue& width : sorted) {
    total += width.weight;
    if (width.value < 0.0) inward = total;
  }
  if (!(total > 0.0)) return {};
  return {upper_quantile(sorted, 0.05), upper_quantile(sorted, 0.5), upper_quantile(sorted, 0.95), inward / total};
}

void HullNotes::write(const ExtrudeSettings& settings, std::vector<std::string>& notes) const {
  const std::string name = "extrude by " + settings.direction_name;
  if (inverted_objects_ > 0)
    notes.push_back(fmt::format("{}: {} object{} with faces wound inwards: the outline turns inwards", name, inverted_objects_,
                                inverted_objects_ == 1 ? "" : "s"));
  if (wrong_corners_ > 0)
    notes.push_back(fmt::format("{}: {} of {} corner normals point against their faces", name, wrong_corners_, corners_));
  if (samples_.empty()) return;
  const DrawnWidths drawn = widths();
  if (drawn.inward_share > 0.0) notes.push_back(fmt::format("{}: inwards on {:.1f} % of the outline", name, 100.0 * drawn.inward_share));
  if (drawn.high - drawn.low > std::max(0.25, 0.05 * std::abs(drawn.median)))
    notes.push_back(fmt::format("{}: {:.2f} to {:.2f} px wide along the outline (5 % to 95 % of it), median {:.2f} px", name, drawn.low,
                                drawn.high, drawn.median));
}

}  // namespace limn
