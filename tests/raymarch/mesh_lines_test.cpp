// Lines of meshes, whose facets hide, pierce and touch each other: as many layers in front as a walk over all triangles counts.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>
#include <optional>
#include <set>

#include "raymarch/lines/mesh_tree.h"
#include "raymarch/mesh/polygons.h"
#include "raymarch/surface.h"
#include "tests/random_seed.h"
#include "tests/raymarch/drawn_lines.h"

namespace limn {
namespace {

constexpr int kViews = 6;
constexpr double kGrid = 4096.0;  // vertices are multiples of 1 / 4096, which single precision holds, as meshes are drawn in it
constexpr double kInFace = 1e-9;
constexpr double kTouching_px = 0.003;  // so near in front of a line a face may count as touching it

/// A ball of triangles whose vertices move along their radii: with much noise it hides and pierces itself. `opening`: rows left out at the
/// top, which leaves a boundary.
Mesh rough_ball(std::mt19937& random, int rows, double noise, int opening, const glm::dvec3& center) {
  std::uniform_real_distribution<double> moved(1.0 - noise, 1.0 + noise), aside(-0.6 * noise, 0.6 * noise);
  Mesh mesh;
  const int columns = 2 * rows;
  for (int i = opening; i <= rows; ++i) {
    for (int k = 0; k < columns; ++k) {
      const double up = std::numbers::pi * i / rows, around = 2.0 * std::numbers::pi * k / columns;
      const glm::dvec3 p(std::sin(up) * std::cos(around), std::cos(up), std::sin(up) * std::sin(around));
      const bool pole = i == 0 || i == rows;
      const glm::dvec3 shift = pole ? glm::dvec3(0.0) : glm::dvec3(aside(random), aside(random), aside(random));
      mesh.positions.push_back(glm::round(kGrid * (center + (pole ? 1.0 : moved(random)) * p + shift)) / kGrid);
    }
  }
  const auto vertex = [&](int i, int k) {
    const int row = i - opening;
    return row * columns + (i == 0 || i == rows ? 0 : k % columns);
  };
  const auto add = [&](int a, int b, int c) {
    if (a == b || b == c || c == a) return;
    mesh.face_sizes.push_back(3);
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), {a, b, c});
  };
  for (int i = opening; i < rows; ++i) {
    for (int k = 0; k < columns; ++k) {
      add(vertex(i, k), vertex(i, k + 1), vertex(i + 1, k + 1));
      add(vertex(i, k), vertex(i + 1, k + 1), vertex(i + 1, k));
    }
  }
  return mesh;
}

/// Where the segment goes through the triangle, as a share of it.
std::optional<double> crossed_at(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& a, const glm::dvec3& b,
                                 const glm::dvec3& c) {
  // By Cramer's rule: from + t (to - from) = a + u (b - a) + v (c - a).
  const glm::dvec3 way = from - to, e = b - a, f = c - a, r = from - a;
  const double determinant = glm::determinant(glm::dmat3(way, e, f));
  if (determinant == 0.0) return {};
  const double t = glm::determinant(glm::dmat3(r, e, f)) / determinant, u = glm::determinant(glm::dmat3(way, r, f)) / determinant,
               v = glm::determinant(glm::dmat3(way, e, r)) / determinant;
  if (!(u > 0.0 && v > 0.0 && u + v < 1.0 && t > 0.0 && t < 1.0)) return {};
  return t;
}

struct Layers {
  int sure = 0, touching = 0;
};

/// Triangles of all meshes between a point of a line and the eye, those that it lies on excepted.
Layers layers_by_all_triangles(const std::vector<Mesh>& meshes, const Camera& camera, const glm::dvec3& p) {
  const glm::dvec3 eye = camera.projection == Projection::perspective ? camera.eye : p + 100.0 * view_vector(camera, p);
  const double touching = kTouching_px / pixels_per_unit_at(camera, project(camera, p).z);
  Layers layers;
  for (const Mesh& mesh : meshes) {
    for (size_t i = 0; i < mesh.corner_vertices.size(); i += 3) {
      const auto at = [&](size_t k) { return mesh.positions[static_cast<size_t>(mesh.corner_vertices[i + k])]; };
      const double off_plane = glm::dot(glm::normalize(glm::cross(at(1) - at(0), at(2) - at(0))), p - at(0));
      const auto share = std::fabs(off_plane) > kInFace ? crossed_at(p, eye, at(0), at(1), at(2)) : std::nullopt;
      if (share) ++(*share * glm::distance(p, eye) > touching ? layers.sure : layers.touching);
    }
  }
  return layers;
}

Scene scene_of_meshes(const std::vector<Mesh>& meshes) {
  Scene scene;
  for (const Mesh& mesh : meshes) scene.objects.push_back({.name = "mesh", .source = MeshSource{mesh}});
  return scene;
}

/// The middle of the longest straight step of an edge, and the step's image length.
std::pair<glm::dvec3, double> middle_of_longest(const LineEdge& edge) {
  std::pair<glm::dvec3, double> best{glm::dvec3(0.0), 0.0};
  for (size_t i = 0; i + 1 < edge.points.size(); ++i) {
    const double length_px = glm::distance(edge.points[i].px, edge.points[i + 1].px);
    if (length_px > best.second) best = {0.5 * (edge.points[i].position + edge.points[i + 1].position), length_px};
  }
  return best;
}

/// No point of a line is left out.
LineSettings unthinned() {
  LineSettings settings;
  settings.tolerance_px = 1e-9;
  return settings;
}

struct Wrong {
  int edges = 0, asked = 0, unsure = 0;
  std::string first{};
};

/// Edges whose invisibility is not what all triangles say.
Wrong wrong_edges(const ViewGraph& graph, const std::vector<Mesh>& meshes, const Camera& camera) {
  Wrong wrong;
  for (const LineEdge& edge : graph.edges) {
    const auto [middle, length_px] = middle_of_longest(edge);
    if (length_px < 0.02) continue;
    ++wrong.asked;
    const Layers layers = layers_by_all_triangles(meshes, camera, middle);
    if (layers.touching > 0) ++wrong.unsure;
    if (edge.invisibility >= layers.sure && edge.invisibility <= layers.sure + layers.touching) continue;
    if (wrong.edges++ == 0) wrong.first = fmt::format("{} layers where the graph has {}", layers.sure, edge.invisibility);
  }
  return wrong;
}

TEST(MeshLines, OfARoughBallAllLayersAreCounted) {
  std::mt19937 random(random_seed());
  for (int view = 0; view < kViews; ++view) {
    const std::vector<Mesh> meshes{rough_ball(random, 14, 0.25, view % 3 == 0 ? 2 : 0, glm::dvec3(0.0))};
    const Scene scene = scene_of_meshes(meshes);
    const Camera camera = random_camera(random, scene, view % 2 == 0);
    const ViewGraph graph = solve_lines(scene, camera, unthinned(), {});
    EXPECT_TRUE(graph.conflicts.empty()) << "view " << view << ": " << graph.conflicts[0].what;
    const Wrong wrong = wrong_edges(graph, meshes, camera);
    EXPECT_GT(wrong.asked, 300);
    EXPECT_LT(wrong.unsure, wrong.asked / 10);
    EXPECT_EQ(wrong.edges, 0) << "view " << view << ": " << wrong.first;
  }
}

/// They go through each other, and their intersections are lines, too.
TEST(MeshLines, OfTwoRoughBallsThatOverlapAllLayersAreCounted) {
  std::mt19937 random(random_seed());
  for (int view = 0; view < kViews; ++view) {
    const std::vector<Mesh> meshes{rough_ball(random, 10, 0.15, 0, glm::dvec3(0.0)),
                                   rough_ball(random, 9, 0.15, view % 3 == 0 ? 2 : 0, glm::dvec3(0.7, 0.4, 0.2))};
    const Scene scene = scene_of_meshes(meshes);
    const Camera camera = random_camera(random, scene, view % 2 == 0);
    const ViewGraph graph = solve_lines(scene, camera, unthinned(), {});
    EXPECT_TRUE(graph.conflicts.empty()) << "view " << view << ": " << graph.conflicts[0].what;
    EXPECT_FALSE(drawn(graph, LineClass::intersection, false).empty());
    const Wrong wrong = wrong_edges(graph, meshes, camera);
    EXPECT_GT(wrong.asked, 200);
    EXPECT_LT(wrong.unsure, wrong.asked / 10);
    EXPECT_EQ(wrong.edges, 0) << "view " << view << ": " << wrong.first;
  }
}

/// Balls of few large and many small triangles, strewn so that each part reaches into some of the others.
TEST(MeshLines, PartsMeetWhereAllEdgesMeetAllFaces) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  size_t met = 0;
  for (int round = 0; round < 2 * kViews; ++round) {
    std::vector<Mesh> meshes;
    std::vector<std::shared_ptr<const Polygons>> polygons;
    std::vector<int> objects;
    for (int part = 0; part < 5; ++part) {
      Mesh mesh = rough_ball(random, part == 0 ? 3 : 4 + 3 * part, 0.1, part == 1 ? 1 : 0, glm::dvec3(0.0));
      const glm::dvec3 center(number(random), number(random), number(random));
      for (glm::dvec3& p : mesh.positions) p = glm::round(kGrid * ((part == 0 ? 2.0 : 0.3 + 0.1 * part) * p + center)) / kGrid;
      polygons.push_back(std::make_shared<const Polygons>(Mesh(mesh), NormalKind::flat));
      objects.push_back(part + 1);
      meshes.push_back(std::move(mesh));
    }
    const MeshTree tree(polygons, glm::dvec3(0.0), objects, 4.0, true);
    ASSERT_EQ(tree.parts(), 5u);
    size_t expected = 0;
    for (const Mesh& one : meshes) {
      std::set<std::pair<std::int32_t, std::int32_t>> edges;
      for (size_t i = 0; i < one.corner_vertices.size(); i += 3) {
        for (size_t k = 0; k < 3; ++k) edges.insert(std::minmax(one.corner_vertices[i + k], one.corner_vertices[i + (k + 1) % 3]));
      }
      for (const Mesh& other : meshes) {
        if (&one == &other) continue;
        for (size_t i = 0; i < other.corner_vertices.size(); i += 3) {
          const auto at = [&](size_t k) { return other.positions[static_cast<size_t>(other.corner_vertices[i + k])]; };
          for (const auto& [a, b] : edges)
            expected +=
                crossed_at(one.positions[static_cast<size_t>(a)], one.positions[static_cast<size_t>(b)], at(0), at(1), at(2)).has_value();
        }
      }
    }
    EXPECT_EQ(tree.meetings().places.size(), expected) << "round " << round;
    met += expected;
  }
  EXPECT_GT(met, 1000u);
}

/// A face that lies in another one hides none of its edges, however both were rounded.
TEST(MeshLines, ABoxThatStandsOnATableShowsItsLowerEdges) {
  std::mt19937 random(random_seed());
  const auto box = [](const glm::dvec3& low, const glm::dvec3& high) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
    mesh.face_sizes = {4, 4, 4, 4, 4, 4};
    mesh.corner_vertices = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    return mesh;
  };
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int view = 0; view < 4 * kViews; ++view) {
    const double top = number(random);
    const glm::dvec3 corner(number(random), top, number(random));
    const Scene scene = scene_of_meshes(
        {box(corner + glm::dvec3(-2.0, -0.5, -2.0), corner + glm::dvec3(3.0, 0.0, 3.0)), box(corner, corner + glm::dvec3(1.0, 1.0, 1.0))});
    // From above, and so that no edge lies along the line of sight.
    const glm::dvec3 direction = glm::normalize(glm::dvec3(0.4 + 0.3 * number(random), 0.8, 1.0 + 0.3 * number(random)));
    const Camera camera = line_view(bounds(scene), direction, 4.0, view % 2 == 0);
    const ViewGraph graph = lines_of(scene, camera);
    EXPECT_TRUE(graph.conflicts.empty()) << "view " << view << ": " << graph.conflicts[0].what;
    double seen = 0.0;
    for (const LineEdge& edge : graph.edges) {
      for (size_t i = 0; i + 1 < edge.points.size(); ++i) {
        const glm::dvec3 &a = edge.points[i].position, &b = edge.points[i + 1].position;
        const bool lower = std::fabs(a.y - top) < 1e-9 && std::fabs(b.y - top) < 1e-9;
        const bool of_box = std::max(a.x, b.x) < corner.x + 1.5 && std::min(a.x, b.x) > corner.x - 0.5 &&
                            std::max(a.z, b.z) < corner.z + 1.5 && std::min(a.z, b.z) > corner.z - 0.5;
        if (lower && of_box && edge.invisibility == 0 && edge.line_class != LineClass::intersection) seen += glm::distance(a, b);
      }
    }
    EXPECT_NEAR(seen, 2.0, 1e-6) << "view " << view;
  }
}

}  // namespace
}  // namespace limn
