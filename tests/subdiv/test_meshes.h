#pragma once
// Meshes with known geometry for the tests of this folder.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "subdiv/mesh.h"

namespace limn::test {

inline void add_face(Mesh& mesh, std::initializer_list<std::int32_t> corners) {
  mesh.face_sizes.push_back(static_cast<std::int32_t>(corners.size()));
  mesh.corner_vertices.insert(mesh.corner_vertices.end(), corners);
}

/// [-1, 1]^3 with outward quads.
inline Mesh cube() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.emplace_back((i & 1) ? 1.0 : -1.0, (i & 2) ? 1.0 : -1.0, (i & 4) ? 1.0 : -1.0);
  add_face(mesh, {0, 2, 3, 1});
  add_face(mesh, {4, 5, 7, 6});
  add_face(mesh, {0, 1, 5, 4});
  add_face(mesh, {2, 6, 7, 3});
  add_face(mesh, {0, 4, 6, 2});
  add_face(mesh, {1, 3, 7, 5});
  return mesh;
}

inline Mesh tetrahedron() {
  Mesh mesh;
  mesh.positions = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  add_face(mesh, {0, 1, 2});
  add_face(mesh, {0, 3, 1});
  add_face(mesh, {0, 2, 3});
  add_face(mesh, {1, 3, 2});
  return mesh;
}

inline Mesh octahedron() {
  Mesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const int x : {0, 1})
    for (const int y : {2, 3})
      for (const int z : {4, 5}) {
        const bool even = (x + (y - 2) + (z - 4)) % 2 == 0;
        if (even) {
          add_face(mesh, {x, y, z});
        } else {
          add_face(mesh, {x, z, y});
        }
      }
  return mesh;
}

/// nx by ny quads in the plane z = 0, one unit each.
inline Mesh grid(int nx, int ny) {
  Mesh mesh;
  for (int y = 0; y <= ny; ++y)
    for (int x = 0; x <= nx; ++x) mesh.positions.emplace_back(x, y, 0.0);
  for (int y = 0; y < ny; ++y)
    for (int x = 0; x < nx; ++x) {
      const int v = y * (nx + 1) + x;
      add_face(mesh, {v, v + 1, v + nx + 2, v + nx + 1});
    }
  return mesh;
}

/// Quads around the y axis at (major + minor cos, minor sin), outward.
inline Mesh torus(int around, int tube, double major, double minor) {
  Mesh mesh;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < tube; ++j) {
      const double a = 2.0 * std::numbers::pi * i / around, b = 2.0 * std::numbers::pi * j / tube;
      const double r = major + minor * std::cos(b);
      mesh.positions.emplace_back(r * std::cos(a), minor * std::sin(b), r * std::sin(a));
    }
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < tube; ++j) {
      const int i1 = (i + 1) % around, j1 = (j + 1) % tube;
      add_face(mesh, {i * tube + j, i * tube + j1, i1 * tube + j1, i1 * tube + j});
    }
  return mesh;
}

/// Triangulated sphere of radius 1: an octahedron with every triangle cut in 4, `level` times, on the sphere.
inline Mesh sphere(int level, double radius = 1.0) {
  Mesh mesh = octahedron();
  for (int l = 0; l < level; ++l) {
    Mesh finer;
    finer.positions = mesh.positions;
    std::vector<std::pair<std::pair<std::int32_t, std::int32_t>, std::int32_t>> known;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const std::pair<std::int32_t, std::int32_t> key = std::minmax(a, b);
      const auto at = std::lower_bound(known.begin(), known.end(), std::pair(key, std::int32_t{0}));
      if (at != known.end() && at->first == key) return at->second;
      const auto index = static_cast<std::int32_t>(finer.positions.size());
      known.insert(at, {key, index});
      finer.positions.push_back(glm::normalize(mesh.positions[static_cast<size_t>(a)] + mesh.positions[static_cast<size_t>(b)]));
      return index;
    };
    for (size_t f = 0; f < mesh.face_count(); ++f) {
      const std::int32_t a = mesh.corner_vertices[3 * f], b = mesh.corner_vertices[3 * f + 1], c = mesh.corner_vertices[3 * f + 2];
      const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      add_face(finer, {a, ab, ca});
      add_face(finer, {b, bc, ab});
      add_face(finer, {c, ca, bc});
      add_face(finer, {ab, bc, ca});
    }
    mesh = std::move(finer);
  }
  for (glm::dvec3& p : mesh.positions) p *= radius;
  return mesh;
}

/// Every position moved by up to `amount` along each axis.
inline Mesh jittered(Mesh mesh, double amount, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-amount, amount);
  for (glm::dvec3& p : mesh.positions) p += glm::dvec3(shift(random), shift(random), shift(random));
  return mesh;
}

/// A prism over a regular n-gon: two n-gons and n quads; axis z.
inline Mesh prism(int n) {
  Mesh mesh;
  for (const double z : {-1.0, 1.0})
    for (int i = 0; i < n; ++i) {
      const double a = 2.0 * std::numbers::pi * i / n;
      mesh.positions.emplace_back(std::cos(a), std::sin(a), z);
    }
  for (int i = 0; i < n; ++i) add_face(mesh, {i, (i + 1) % n, n + (i + 1) % n, n + i});
  mesh.face_sizes.insert(mesh.face_sizes.end(), 2, n);
  for (int i = n - 1; i >= 0; --i) mesh.corner_vertices.push_back(i);
  for (int i = 0; i < n; ++i) mesh.corner_vertices.push_back(n + i);
  return mesh;
}

inline Mesh turned_inside_out(Mesh mesh) {
  auto first = mesh.corner_vertices.begin();
  for (const std::int32_t size : mesh.face_sizes) std::reverse(first, first + size), first += size;
  return mesh;
}

inline void append(Mesh& all, const Mesh& part) {
  const auto shift = static_cast<std::int32_t>(all.vertex_count());
  all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
  all.face_sizes.insert(all.face_sizes.end(), part.face_sizes.begin(), part.face_sizes.end());
  for (const std::int32_t v : part.corner_vertices) all.corner_vertices.push_back(v + shift);
}

inline Mesh box_at(const glm::dvec3& half, const glm::dvec3& center) {
  Mesh mesh = cube();
  for (glm::dvec3& p : mesh.positions) p = p * half + center;
  return mesh;
}

/// Winding number about p: the sum of the triangles' solid angles over 4 pi (van Oosterom and Strackee 1983).
inline double exact_winding(const TriangleMesh& mesh, const glm::dvec3& p) {
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[t.x] - p, b = mesh.positions[t.y] - p, c = mesh.positions[t.z] - p;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    sum += std::atan2(glm::dot(a, glm::cross(b, c)), la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return sum / (2.0 * std::numbers::pi);
}

}  // namespace limn::test
