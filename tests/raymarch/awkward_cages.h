#pragma once
// Subdivision cages of every awkward kind, in the style of OpenSubdiv's regression shapes: few faces, nothing symmetric.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "subdiv/refine.h"

namespace limn::test {

struct AwkwardCage {
  std::string kind, name;
  Mesh mesh;
  Scheme scheme = Scheme::catmark;
};

inline void add_face(Mesh& mesh, const std::vector<std::int32_t>& corners) {
  mesh.face_sizes.push_back(static_cast<std::int32_t>(corners.size()));
  mesh.corner_vertices.insert(mesh.corner_vertices.end(), corners.begin(), corners.end());
}

inline Mesh mesh_of(std::vector<glm::dvec3> positions, const std::vector<std::vector<std::int32_t>>& faces) {
  Mesh mesh;
  mesh.positions = std::move(positions);
  for (const auto& face : faces) add_face(mesh, face);
  return mesh;
}

/// Every vertex moved a little, always the same way.
inline Mesh shaken(Mesh mesh, double by, unsigned seed) {
  std::mt19937 random(seed);
  for (glm::dvec3& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) p[axis] += by * (static_cast<double>(random() % 2001) / 1000.0 - 1.0);
  }
  return mesh;
}

inline Mesh without_faces(const Mesh& mesh, const std::vector<size_t>& left_out) {
  Mesh out = mesh;
  out.face_sizes.clear(), out.corner_vertices.clear();
  const std::vector<std::int32_t> first = first_corners(mesh);
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    if (std::find(left_out.begin(), left_out.end(), f) != left_out.end()) continue;
    const auto begin = mesh.corner_vertices.begin();
    add_face(out, {begin + first[f], begin + first[f + 1]});
  }
  return out;
}

inline std::vector<std::int32_t> corners_of_face(const Mesh& mesh, size_t face) {
  const std::vector<std::int32_t> first = first_corners(mesh);
  return {mesh.corner_vertices.begin() + first[face], mesh.corner_vertices.begin() + first[face + 1]};
}

/// A face cut in two from its first corner to the opposite one by way of a new vertex, which has valence 2.
inline Mesh with_valence_two(const Mesh& mesh, size_t face, double outwards) {
  const std::vector<std::int32_t> c = corners_of_face(mesh, face);
  Mesh out = without_faces(mesh, {face});
  glm::dvec3 middle(0.0);
  for (const std::int32_t v : c) middle += mesh.positions[static_cast<size_t>(v)] / static_cast<double>(c.size());
  const auto at = [&](size_t i) { return mesh.positions[static_cast<size_t>(c[i])]; };
  const glm::dvec3 normal = glm::normalize(glm::cross(at(1) - at(0), at(2) - at(0)));
  const auto m = static_cast<std::int32_t>(out.vertex_count());
  out.positions.push_back(middle + outwards * normal);
  const auto half = static_cast<std::ptrdiff_t>(c.size() / 2);
  std::vector<std::int32_t> one(c.begin(), c.begin() + half + 1), two(c.begin() + half, c.end());
  one.push_back(m);
  two.push_back(c[0]);
  two.push_back(m);
  add_face(out, one);
  add_face(out, two);
  return out;
}

inline Mesh joined(Mesh a, const Mesh& b, const glm::dvec3& by) {
  const auto offset = static_cast<std::int32_t>(a.vertex_count());
  for (const glm::dvec3& p : b.positions) a.positions.push_back(p + by);
  a.face_sizes.insert(a.face_sizes.end(), b.face_sizes.begin(), b.face_sizes.end());
  for (const std::int32_t v : b.corner_vertices) a.corner_vertices.push_back(v + offset);
  return a;
}

/// The vertex `b` becomes `a`.
inline Mesh merged(Mesh mesh, std::int32_t a, std::int32_t b) {
  for (std::int32_t& v : mesh.corner_vertices)
    if (v == b) v = a;
  return mesh;
}

inline Mesh turned_face(Mesh mesh, size_t face) {
  const std::vector<std::int32_t> first = first_corners(mesh);
  std::reverse(mesh.corner_vertices.begin() + first[face], mesh.corner_vertices.begin() + first[face + 1]);
  return mesh;
}

inline Mesh creased(Mesh mesh, const std::vector<Crease>& creases) {
  mesh.creases.insert(mesh.creases.end(), creases.begin(), creases.end());
  return mesh;
}

inline Mesh ruled(Mesh mesh, BoundaryRule rule) {
  mesh.boundary = rule;
  return mesh;
}

inline Mesh cube_cage(unsigned seed) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.emplace_back((i & 1) ? 1.0 : -1.0, (i & 2) ? 0.8 : -0.8, (i & 4) ? 0.9 : -0.9);
  mesh.corner_vertices = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
  mesh.face_sizes.assign(6, 4);
  return shaken(std::move(mesh), 0.12, seed);
}

/// columns x rows quads over z = height(x, y); vertex (i, j) is number j (columns + 1) + i.
template <class Height>
Mesh grid_cage(int columns, int rows, const Height& height) {
  Mesh mesh;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const double x = 2.0 * i / columns - 1.0, y = 2.0 * j / rows - 1.0;
      mesh.positions.emplace_back(x, y, height(x, y));
    }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const int v = j * (columns + 1) + i;
      add_face(mesh, {v, v + 1, v + columns + 2, v + columns + 1});
    }
  return mesh;
}
inline Mesh wave_cage(int columns, int rows, unsigned seed) {
  const auto height = [](double x, double y) { return 0.7 * std::sin(2.4 * x + 0.3) + 0.5 * std::cos(2.0 * y) * x; };
  return shaken(grid_cage(columns, rows, height), 0.05, seed);
}
/// Each quad as two triangles.
inline Mesh halved(const Mesh& mesh) {
  Mesh out = without_faces(mesh, {});
  out.face_sizes.clear(), out.corner_vertices.clear();
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const auto c = corners_of_face(mesh, f);
    add_face(out, {c[0], c[1], c[2]});
    add_face(out, {c[0], c[2], c[3]});
  }
  return out;
}

/// The surface of unit cubes, given by their places; places that meet along an edge only make it non-manifold.
inline Mesh block_cage(const std::vector<glm::ivec3>& cubes) {
  const auto filled = [&](const glm::ivec3& at) { return std::find(cubes.begin(), cubes.end(), at) != cubes.end(); };
  Mesh mesh;
  std::vector<glm::ivec3> places;
  const auto vertex = [&](const glm::ivec3& at) {
    const auto found = std::find(places.begin(), places.end(), at);
    if (found != places.end()) return static_cast<std::int32_t>(found - places.begin());
    places.push_back(at);
    mesh.positions.emplace_back(at);
    return static_cast<std::int32_t>(places.size() - 1);
  };
  for (const glm::ivec3& cube : cubes) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        glm::ivec3 beyond = cube;
        beyond[axis] += side ? 1 : -1;
        if (filled(beyond)) continue;
        glm::ivec3 u(0), v(0), o = cube;
        u[(axis + 1) % 3] = v[(axis + 2) % 3] = 1;
        o[axis] += side;
        if (side)
          add_face(mesh, {vertex(o), vertex(o + u), vertex(o + u + v), vertex(o + v)});
        else
          add_face(mesh, {vertex(o), vertex(o + v), vertex(o + u + v), vertex(o + u)});
      }
    }
  }
  return mesh;
}
/// A slab with holes through it.
inline Mesh slab_cage(int holes) {
  std::vector<glm::ivec3> cubes;
  for (int x = 0; x < 2 * holes + 1; ++x)
    for (int y = 0; y < 3; ++y)
      if (x % 2 == 0 || y != 1) cubes.emplace_back(x, y, 0);
  return block_cage(cubes);
}

/// Sheets of 2 x 2 quads about a common spine along y; the spine's vertices are 0, 1, 2.
inline Mesh book_cage(const std::vector<double>& angles_deg, int rows = 2) {
  Mesh mesh;
  for (int j = 0; j <= rows; ++j) mesh.positions.emplace_back(0.05 * j, j - 0.5 * rows, 0.1 * j * j);
  for (const double degrees : angles_deg) {
    const double a = degrees * std::numbers::pi / 180.0;
    const auto first = static_cast<std::int32_t>(mesh.vertex_count());
    for (int i = 1; i <= 2; ++i)
      for (int j = 0; j <= rows; ++j)
        mesh.positions.emplace_back(0.6 * i * std::cos(a + 0.25 * i), j - 0.5 * rows + 0.1 * i, 0.6 * i * std::sin(a + 0.25 * i));
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < rows; ++j) {
        const auto at = [&](int column, int row) { return column == 0 ? row : first + (column - 1) * (rows + 1) + row; };
        add_face(mesh, {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
  }
  return mesh;
}

/// `sides` faces about vertex 0, every one of which starts there; quads, or triangles.
inline Mesh fan_cage(int sides, bool quads, bool closed, double depth) {
  Mesh mesh;
  mesh.positions.emplace_back(0.1, 0.05, depth);
  const int rim = quads ? 2 * sides + !closed : sides + !closed;
  for (int i = 0; i < rim; ++i) {
    const double a = (closed ? 2.0 : 1.6) * std::numbers::pi * i / (closed ? rim : rim - 1);
    mesh.positions.emplace_back(std::cos(a), std::sin(a), 0.25 * std::cos(3.0 * a));
  }
  for (int i = 0; i < sides; ++i) {
    const auto at = [&](int k) { return 1 + k % rim; };
    if (quads)
      add_face(mesh, {0, at(2 * i), at(2 * i + 1), at(2 * i + 2)});
    else
      add_face(mesh, {0, at(i), at(i + 1)});
  }
  return mesh;
}

/// A bent n-gon.
inline Mesh single_face(int corners) {
  Mesh mesh;
  std::vector<std::int32_t> face;
  for (int i = 0; i < corners; ++i) {
    const double a = 2.0 * std::numbers::pi * i / corners + 0.2;
    mesh.positions.emplace_back(std::cos(a), 0.8 * std::sin(a), 0.6 * std::cos(2.0 * a) + 0.1 * std::sin(3.0 * a));
    face.push_back(i);
  }
  add_face(mesh, face);
  return mesh;
}

/// Rings of four vertices a, m, b, n, tubes of two hexagons: each two share two edges that do not touch.
inline Mesh two_sided_tube(int length) {
  Mesh mesh;
  for (int k = 0; k <= length; ++k) {
    const double z = 1.2 * k, r = 1.0 - 0.15 * k;
    for (int i = 0; i < 4; ++i) mesh.positions.emplace_back(r * std::cos(1.57 * i + 0.2 * k), 0.8 * r * std::sin(1.57 * i + 0.2 * k), z);
  }
  for (int k = 0; k < length; ++k) {
    const std::int32_t v = 4 * k;
    add_face(mesh, {v, v + 1, v + 2, v + 6, v + 5, v + 4});
    add_face(mesh, {v + 2, v + 3, v, v + 4, v + 7, v + 6});
  }
  return mesh;
}

inline Mesh octahedron_cage() {
  return mesh_of({{1.2, 0, 0}, {-1, 0.1, 0}, {0, 1, 0.1}, {0.1, -0.8, 0}, {0, 0, 1}, {0, 0.1, -1.1}},
                 {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
}

/// A globe whose poles every quad there names twice.
inline Mesh globe_cage(int around, int along) {
  Mesh mesh;
  mesh.positions.emplace_back(0.0, 1.0, 0.1);
  for (int j = 1; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      const double t = std::numbers::pi * j / along, a = 2.0 * std::numbers::pi * i / around;
      mesh.positions.emplace_back(std::sin(t) * std::cos(a), std::cos(t), -0.8 * std::sin(t) * std::sin(a));
    }
  mesh.positions.emplace_back(0.1, -1.0, 0.0);
  const auto at = [&](int i, int j) { return j == 0 ? 0 : j == along ? 1 + (along - 1) * around : 1 + (j - 1) * around + i % around; };
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) add_face(mesh, {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
  return mesh;
}

std::vector<AwkwardCage> awkward_cages();

}  // namespace limn::test
