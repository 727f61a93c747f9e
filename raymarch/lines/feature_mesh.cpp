#include "raymarch/lines/feature_mesh.h"

#include <algorithm>
#include <cmath>

#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kBeyondFrame_px = 16.0;
constexpr int kMostRounds = 16;

struct Edge {
  std::uint32_t a = 0, b = 0;  // a < b
  bool operator<(const Edge& other) const { return std::tie(a, b) < std::tie(other.a, other.b); }
  bool operator==(const Edge& other) const { return a == other.a && b == other.b; }
};
Edge edge_of(std::uint32_t a, std::uint32_t b) { return a < b ? Edge{a, b} : Edge{b, a}; }

/// Length in the image were it seen face on; 0 outside the picture.
double length_px(const Camera& camera, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 middle = 0.5 * (a + b);
  const double length = glm::distance(a, b);
  const glm::dvec3 image = project(camera, middle);
  const bool perspective = camera.projection == Projection::perspective;
  // Beside a pinhole's plane nothing has an image.
  if (perspective && image.z <= 1e-6 * length) return image.z + length > 0.0 ? std::numeric_limits<double>::infinity() : 0.0;
  const double px = length * pixels_per_unit_at(camera, image.z), reach = px + kBeyondFrame_px;
  const bool inside = image.x > -reach && image.y > -reach && image.x < camera.width_px + reach && image.y < camera.height_px + reach;
  return inside ? px : 0.0;
}

/// The triangle with some of its edges cut: `middle[i]` lies on the edge from corner i to the next, or is the largest number.
void add_pieces(const std::array<std::uint32_t, 3>& corners, const std::array<std::uint32_t, 3>& middle, const FeatureMesh& mesh,
                std::vector<std::array<std::uint32_t, 3>>& out) {
  constexpr auto none = std::numeric_limits<std::uint32_t>::max();
  const auto count = 3 - std::count(middle.begin(), middle.end(), none);
  if (count == 0) {
    out.push_back(corners);
  } else if (count == 3) {
    for (size_t i = 0; i < 3; ++i) out.push_back({corners[i], middle[i], middle[(i + 2) % 3]});
    out.push_back({middle[0], middle[1], middle[2]});
  } else if (count == 1) {
    const size_t i = static_cast<size_t>(std::find_if(middle.begin(), middle.end(), [](auto m) { return m != none; }) - middle.begin());
    out.push_back({corners[i], middle[i], corners[(i + 2) % 3]});
    out.push_back({middle[i], corners[(i + 1) % 3], corners[(i + 2) % 3]});
  } else {
    const size_t i = static_cast<size_t>(std::find(middle.begin(), middle.end(), none) - middle.begin());
    const std::uint32_t a = corners[i], b = corners[(i + 1) % 3], c = corners[(i + 2) % 3], bc = middle[(i + 1) % 3],
                        ca = middle[(i + 2) % 3];
    out.push_back({ca, bc, c});
    // The shorter diagonal of what is left.
    if (glm::distance(mesh.positions[a], mesh.positions[bc]) <= glm::distance(mesh.positions[b], mesh.positions[ca])) {
      out.push_back({a, b, bc});
      out.push_back({a, bc, ca});
    } else {
      out.push_back({a, b, ca});
      out.push_back({b, bc, ca});
    }
  }
}

std::vector<Edge> edges_of(const FeatureMesh& mesh) {
  std::vector<Edge> edges(3 * mesh.triangles.size());
  parallel_for(size_t{0}, mesh.triangles.size(), [&](size_t t) {
    for (size_t i = 0; i < 3; ++i) edges[3 * t + i] = edge_of(mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3]);
  });
  parallel_sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

}  // namespace

bool may_be_seen(const Camera& camera, const std::array<glm::dvec3, 3>& corners) {
  const glm::dvec2 size(camera.width_px, camera.height_px);
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-std::numeric_limits<double>::infinity());
  bool all_before = true;
  for (const glm::dvec3& corner : corners) {
    const glm::dvec3 image = project(camera, corner);
    all_before = all_before && image.z > 0.0;
    low = glm::min(low, image);
    high = glm::max(high, image);
  }
  if (!all_before) return camera.projection == Projection::perspective && high.z > 0.0;
  return high.x > -kBeyondFrame_px && high.y > -kBeyondFrame_px && low.x < size.x + kBeyondFrame_px && low.y < size.y + kBeyondFrame_px;
}

double cut_long_edges(const Camera& camera, const CutSettings& settings, FeatureMesh& mesh) {
  constexpr auto none = std::numeric_limits<std::uint32_t>::max();
  for (int round = 0;; ++round) {
    std::vector<Edge> edges = edges_of(mesh);
    std::vector<double> lengths(edges.size());
    parallel_for(size_t{0}, edges.size(),
                 [&](size_t i) { lengths[i] = length_px(camera, mesh.positions[edges[i].a], mesh.positions[edges[i].b]); });
    double longest = 0.0;
    std::vector<Edge> cut;
    for (size_t i = 0; i < edges.size(); ++i) {
      const bool may_be_cut = glm::distance(mesh.positions[edges[i].a], mesh.positions[edges[i].b]) > settings.least;
      if (!may_be_cut || lengths[i] <= settings.edge_px) continue;
      cut.push_back(edges[i]);
      longest = std::max(longest, lengths[i]);
    }
    // Each edge that is cut adds a triangle on either side.
    const auto after = static_cast<std::int64_t>(mesh.triangles.size() + 2 * cut.size());
    if (cut.empty() || after > settings.most || round == kMostRounds) return longest;
    const size_t first = mesh.positions.size();
    mesh.positions.resize(first + cut.size());
    parallel_for(size_t{0}, cut.size(), [&](size_t i) {
      glm::dvec3 p = 0.5 * (mesh.positions[cut[i].a] + mesh.positions[cut[i].b]);
      if (settings.onto_surface) settings.onto_surface(p);
      mesh.positions[first + i] = p;
    });
    std::vector<std::array<std::uint32_t, 3>> triangles;
    triangles.reserve(static_cast<size_t>(after));
    for (const auto& corners : mesh.triangles) {
      std::array<std::uint32_t, 3> middle{none, none, none};
      for (size_t i = 0; i < 3; ++i) {
        const Edge edge = edge_of(corners[i], corners[(i + 1) % 3]);
        const auto at = std::lower_bound(cut.begin(), cut.end(), edge);
        if (at != cut.end() && *at == edge) middle[i] = static_cast<std::uint32_t>(first + static_cast<size_t>(at - cut.begin()));
      }
      add_pieces(corners, middle, mesh, triangles);
    }
    mesh.triangles = std::move(triangles);
  }
}

}  // namespace limn
