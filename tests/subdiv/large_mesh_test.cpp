// Meshes so large that several threads take a part each: against the same worked out in one go.

#include <gtest/gtest.h>
#include <opensubdiv/far/primvarRefiner.h>

#include <algorithm>
#include <map>
#include <random>

#include "subdiv/edge_topology.h"
#include "subdiv/opensubdiv_cage.h"
#include "subdiv/refine.h"
#include "test_meshes.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

/// Faces of three to five corners at vertices that lie near each other in the list, so that many edges are shared, some by more than two
/// faces; a few corners are repeated, and a few vertices stand at the same place as others.
Mesh random_faces(std::mt19937& random, size_t faces) {
  Mesh mesh;
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  const auto vertices = static_cast<std::int32_t>(faces / 2);
  for (std::int32_t v = 0; v < vertices; ++v) {
    const bool again = v > 0 && random() % 50 == 0;
    mesh.positions.push_back(again ? mesh.positions[random() % static_cast<size_t>(v)]
                                   : glm::dvec3(place(random), place(random), place(random)));
  }
  for (size_t f = 0; f < faces; ++f) {
    const auto at = static_cast<std::int32_t>(random() % static_cast<unsigned>(vertices));
    const std::int32_t size = 3 + static_cast<std::int32_t>(random() % 3);
    for (std::int32_t i = 0; i < size; ++i)
      mesh.corner_vertices.push_back(std::min(at + static_cast<std::int32_t>(random() % 6), vertices - 1));
    mesh.face_sizes.push_back(size);
  }
  return mesh;
}

struct Use {
  std::int32_t face = 0;
  bool forward = false;
};

TEST(LargeMesh, EdgesAreThoseOfAMap) {
  std::mt19937 random(random_seed());
  for (const size_t faces : {size_t{40}, size_t{100'000}, size_t{300'001}}) {
    const Mesh mesh = random_faces(random, faces);
    std::map<std::pair<std::int32_t, std::int32_t>, std::vector<Use>> uses;
    const std::vector<std::int32_t> first = first_corners(mesh);
    for (size_t f = 0; f < faces; ++f) {
      const auto corners = face_corners(mesh, first[f], f);
      for (size_t i = 0; i < corners.size(); ++i) {
        const std::int32_t a = corners[i], b = corners[(i + 1) % corners.size()];
        if (a != b) uses[std::minmax(a, b)].push_back({static_cast<std::int32_t>(f), a < b});
      }
    }
    const Edges edges = build_edges(mesh);
    ASSERT_EQ(edges.size(), uses.size());
    size_t i = 0, shared = 0;
    for (const auto& [ends, of] : uses) {
      const Edge& edge = edges[i++];
      ASSERT_EQ(std::minmax(edge.vertex_a, edge.vertex_b), std::minmax(ends.first, ends.second));
      ASSERT_EQ(edge.vertex_a < edge.vertex_b, of[0].forward);
      ASSERT_EQ(edge.face_a, of[0].face);
      ASSERT_EQ(edge.face_count, static_cast<std::int32_t>(of.size()));
      ASSERT_EQ(edge.face_b, of.size() > 1 ? of[1].face : -1);
      ASSERT_EQ(edge.consistent, of.size() == 1 || of[0].forward != of[1].forward);
      shared += of.size() > 2;
    }
    EXPECT_GT(shared, 0u);
  }
}

TEST(LargeMesh, SmoothNormalsAreSumsInTheOrderOfFaces) {
  std::mt19937 random(random_seed());
  Mesh mesh = random_faces(random, 80'000);
  // A face and its back, alone: their normals cancel, and the last one's is as good as the other.
  const auto lonely = static_cast<std::int32_t>(mesh.vertex_count());
  mesh.positions.insert(mesh.positions.end(), {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {9, 9, 9}});
  for (const std::int32_t v : {0, 1, 2, 0, 2, 1}) mesh.corner_vertices.push_back(lonely + v);
  mesh.face_sizes.insert(mesh.face_sizes.end(), 2, 3);
  const std::vector<std::int32_t> at = first_vertex_at_position(mesh), first = first_corners(mesh);
  std::vector<glm::dvec3> sums(mesh.vertex_count(), glm::dvec3(0.0)), last(sums);
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    std::vector<glm::dvec3> corners;
    gather_corners(mesh, face_corners(mesh, first[f], f), corners);
    if (zero_area(corners)) continue;
    const glm::dvec3 normal = vector_area(corners) / glm::length(vector_area(corners));
    for (size_t i = 0; i < corners.size(); ++i) {
      const auto v = static_cast<size_t>(at[static_cast<size_t>(mesh.corner_vertices[static_cast<size_t>(first[f]) + i])]);
      sums[v] += corner_angle(corners, i, normal) * normal;
      last[v] = normal;
    }
  }
  const std::vector<glm::vec3> baked = bake_smooth_normals(mesh);
  for (size_t v = 0; v < baked.size(); ++v) {
    const auto from = static_cast<size_t>(at[v]);
    const glm::dvec3 sum = glm::length(sums[from]) > 1e-9 ? glm::normalize(sums[from]) : last[from];
    ASSERT_EQ(baked[v], sum == glm::dvec3(0.0) ? glm::vec3(0, 0, 1) : glm::vec3(sum)) << "vertex " << v;
  }
  EXPECT_EQ(baked[static_cast<size_t>(lonely)], glm::vec3(0, 0, -1));
  EXPECT_EQ(baked.back(), glm::vec3(0, 0, 1));
}

/// A sheet of 40 x 40 faces with creases and corners of all kinds, waves and open sides.
Mesh random_cage(std::mt19937& random, bool triangles) {
  constexpr std::int32_t kSide = 40;
  Mesh cage;
  std::uniform_real_distribution<double> off(-0.3, 0.3);
  for (std::int32_t y = 0; y <= kSide; ++y)
    for (std::int32_t x = 0; x <= kSide; ++x) cage.positions.emplace_back(x + off(random), y + off(random), off(random));
  const auto vertex = [](std::int32_t x, std::int32_t y) { return y * (kSide + 1) + x; };
  const auto sharpness = [&] { return random() % 2 ? 10.0f : 0.25f * static_cast<float>(random() % 16); };
  for (std::int32_t y = 0; y < kSide; ++y)
    for (std::int32_t x = 0; x < kSide; ++x) {
      const std::int32_t a = vertex(x, y), b = vertex(x + 1, y), c = vertex(x + 1, y + 1), d = vertex(x, y + 1);
      if (triangles) {
        cage.corner_vertices.insert(cage.corner_vertices.end(), {a, b, c, a, c, d});
        cage.face_sizes.insert(cage.face_sizes.end(), 2, 3);
      } else {
        cage.corner_vertices.insert(cage.corner_vertices.end(), {a, b, c, d});
        cage.face_sizes.push_back(4);
      }
      if (random() % 6 == 0) cage.creases.push_back({a, b, sharpness()});
      if (random() % 60 == 0) cage.corners.push_back({a, sharpness()});
    }
  return cage;
}

TEST(LargeMesh, LimitPointsAreOpenSubdivsOwn) {
  std::mt19937 random(random_seed());
  for (const Scheme scheme : {Scheme::catmark, Scheme::loop, Scheme::bilinear}) {
    const Mesh cage = random_cage(random, scheme == Scheme::loop);
    const std::unique_ptr<Far::TopologyRefiner> refiner = make_refiner(cage, scheme, {});
    Far::TopologyRefiner::UniformOptions options(2);
    options.fullTopologyInLastLevel = true;
    refiner->RefineUniform(options);
    const Far::PrimvarRefinerReal<double> primvars(*refiner);
    Points points(cage.vertex_count());
    for (size_t v = 0; v < points.size(); ++v) points[v].p = cage.positions[v];
    for (int level = 1; level <= 2; ++level) {
      Points finer(static_cast<size_t>(refiner->GetLevel(level).GetNumVertices()));
      primvars.Interpolate(level, points, finer);
      points = std::move(finer);
    }
    LimitFrame own, theirs{points, points, points, {}};
    primvars.Limit(points, theirs.positions, theirs.tangent1, theirs.tangent2);
    limit_points(*refiner, scheme, points, own);
    ASSERT_EQ(own.positions.size(), points.size());
    for (size_t v = 0; v < points.size(); ++v) {
      ASSERT_EQ(own.positions[v].p, theirs.positions[v].p) << name_of(scheme) << ", vertex " << v;
      ASSERT_EQ(own.tangent1[v].p, theirs.tangent1[v].p) << name_of(scheme) << ", vertex " << v;
      ASSERT_EQ(own.tangent2[v].p, theirs.tangent2[v].p) << name_of(scheme) << ", vertex " << v;
    }
  }
}

TEST(LargeMesh, HolesLeaveTheOtherFacesAsTheyAre) {
  std::mt19937 random(random_seed());
  Mesh cage = random_cage(random, false);
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(cage.face_count()); ++f) {
    cage.face_materials.push_back(f % 7);
    cage.face_groups.push_back(f % 5);
    if (random() % 4 == 0) cage.holes.push_back(f);
  }
  for (int m = 0; m < 7; ++m) cage.material_names.push_back(std::to_string(m));
  for (int g = 0; g < 5; ++g) cage.group_names.push_back(std::to_string(g));
  RefineSettings settings{.scheme = Scheme::catmark, .level = 3, .to_limit = true, .normals = NormalKind::limit};
  const Mesh without = refine(cage, settings);
  settings.keep_holes = true;
  const Mesh with = refine(cage, settings);
  const std::vector<std::int32_t> first = first_corners(with), first_without = first_corners(without);
  ASSERT_EQ(with.face_count(), 64 * cage.face_count());
  ASSERT_EQ(with.holes.size(), 64 * cage.holes.size());
  size_t kept = 0, hole = 0;
  for (size_t f = 0; f < with.face_count(); ++f) {
    if (hole < with.holes.size() && with.holes[hole] == static_cast<std::int32_t>(f)) {
      ++hole;
      continue;
    }
    ASSERT_EQ(without.face_sizes[kept], with.face_sizes[f]);
    ASSERT_EQ(without.face_materials[kept], with.face_materials[f]);
    ASSERT_EQ(without.face_groups[kept], with.face_groups[f]);
    for (std::int32_t i = 0; i < with.face_sizes[f]; ++i) {
      const auto a = static_cast<size_t>(first_without[kept] + i), b = static_cast<size_t>(first[f] + i);
      ASSERT_EQ(without.positions[static_cast<size_t>(without.corner_vertices[a])],
                with.positions[static_cast<size_t>(with.corner_vertices[b])]);
      ASSERT_EQ(without.corner_normals[a], with.corner_normals[b]);
    }
    ++kept;
  }
  EXPECT_EQ(kept, without.face_count());
}

}  // namespace
}  // namespace limn
