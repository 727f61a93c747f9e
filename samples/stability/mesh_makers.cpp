#include "samples/stability/mesh_makers.h"

#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "sdf/error.h"
#include "sdf/shape.h"
#include "subdiv/tessellate.h"

namespace limn {
namespace {

void add_face(Mesh& mesh, std::initializer_list<std::int32_t> corners) {
  mesh.face_sizes.push_back(static_cast<std::int32_t>(corners.size()));
  mesh.corner_vertices.insert(mesh.corner_vertices.end(), corners);
}

Parameter whole(const std::string& name, double value, double least, const std::string& help) {
  return an_integer(name, value).in(least, 4096.0).help(help);
}
Parameter length(const std::string& name, double value, const std::string& help) {
  return a_number(name, value).in(1e-9, 1e9).unit("world").help(help);
}

/// Rings of a cylinder about y, each turned by half a step against the last; caps as fans.
Mesh lantern(const Parameters& p) {
  const int around = p.integer("around"), along = p.integer("along");
  const double radius = p.number("radius"), half = p.number("half_height");
  Mesh mesh;
  for (int j = 0; j <= along; ++j) {
    for (int i = 0; i < around; ++i) {
      const double angle = 2.0 * std::numbers::pi * (i + 0.5 * (j % 2)) / around;
      mesh.positions.emplace_back(radius * std::cos(angle), -half + 2.0 * half * j / along, -radius * std::sin(angle));
    }
  }
  for (int j = 0; j < along; ++j) {
    for (int i = 0; i < around; ++i) {
      const int next = (i + 1) % around, low = j * around, high = low + around;
      if (j % 2 == 0) {
        add_face(mesh, {low + i, low + next, high + i});
        add_face(mesh, {low + next, high + next, high + i});
      } else {
        add_face(mesh, {low + i, high + next, high + i});
        add_face(mesh, {low + i, low + next, high + next});
      }
    }
  }
  const auto middle = static_cast<std::int32_t>(mesh.positions.size());
  mesh.positions.emplace_back(0.0, -half, 0.0);
  mesh.positions.emplace_back(0.0, half, 0.0);
  for (int i = 0; i < around; ++i) {
    const int next = (i + 1) % around, top = along * around;
    add_face(mesh, {middle, next, i});
    add_face(mesh, {middle + 1, top + i, top + next});
  }
  return mesh;
}

/// A ball of quads by longitude and latitude: at the poles one side of each has no length.
Mesh globe(const Parameters& p) {
  const int around = p.integer("around"), along = p.integer("along");
  Mesh mesh;
  for (int j = 0; j <= along; ++j) {
    for (int i = 0; i < around; ++i) {
      const double t = std::numbers::pi * j / along, a = 2.0 * std::numbers::pi * i / around;
      const double ring = j == 0 || j == along ? 0.0 : std::sin(t);
      mesh.positions.push_back(p.number("radius") * glm::dvec3(ring * std::cos(a), std::cos(t), -ring * std::sin(a)));
    }
  }
  for (int j = 0; j < along; ++j) {
    for (int i = 0; i < around; ++i) {
      const int next = (i + 1) % around, low = j * around, high = low + around;
      add_face(mesh, {low + i, high + i, high + next, low + next});
    }
  }
  return mesh;
}

/// A double pyramid: two vertices with as many edges as are asked for.
Mesh spindle(const Parameters& p) {
  const int valence = p.integer("valence");
  Mesh mesh;
  mesh.positions = {{0.0, p.number("half_height"), 0.0}, {0.0, -p.number("half_height"), 0.0}};
  for (int i = 0; i < 2 * valence; ++i) {
    const double a = std::numbers::pi * i / valence;
    mesh.positions.emplace_back(p.number("radius") * std::cos(a), 0.0, -p.number("radius") * std::sin(a));
  }
  for (int i = 0; i < valence; ++i) {
    const int a = 2 + 2 * i, b = a + 1, c = 2 + (2 * i + 2) % (2 * valence);
    add_face(mesh, {0, a, b, c});
    add_face(mesh, {1, c, b, a});
  }
  return mesh;
}

/// Each side cut into squares; vertices of neighbouring sides are shared.
Mesh box(const Parameters& p) {
  const int n = p.integer("divisions");
  const auto crease = static_cast<float>(p.number("crease")), edges = static_cast<float>(p.number("edges"));
  Mesh mesh;
  std::map<std::array<int, 3>, std::int32_t> numbers;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [found, is_new] = numbers.try_emplace(at, static_cast<std::int32_t>(mesh.positions.size()));
    if (is_new) mesh.positions.push_back(p.number("half") * (2.0 / n * glm::dvec3(at[0], at[1], at[2]) - 1.0));
    return found->second;
  };
  for (int side = 0; side < 6; ++side) {
    const auto axis = static_cast<size_t>(side / 2), u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        std::array<std::int32_t, 4> corners{};
        for (size_t k = 0; k < 4; ++k) {
          std::array<int, 3> at{};
          at[axis] = side % 2 == 0 ? 0 : n;
          at[u] = i + (k == 1 || k == 2);
          at[v] = j + (k >= 2);
          corners[side % 2 == 0 ? 3 - k : k] = vertex(at);
        }
        add_face(mesh, {corners[0], corners[1], corners[2], corners[3]});
      }
    }
  }
  for (const auto& [at, number] : numbers) {
    for (size_t axis = 0; axis < 3; ++axis) {
      std::array<int, 3> next = at;
      ++next[axis];
      const size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      if (next[axis] > n || at[u] % n != 0 || at[v] % n != 0) continue;
      const bool upper = axis != 1 && at[1] == n;
      if (const float sharpness = upper ? std::max(crease, edges) : edges; sharpness > 0.0f)
        mesh.creases.push_back({number, numbers.at(next), sharpness});
    }
  }
  return mesh;
}

Mesh torus(const Parameters& p) {
  TessellateSettings settings;
  settings.level = p.integer("level");
  settings.normals = NormalKind::vertex;
  return tessellate(make_shape("torus", {{"major", {p.number("major")}}, {"minor", {p.number("minor")}}}), settings);
}

}  // namespace

const Registry<MeshMaker>& mesh_makers() {
  static const Registry<MeshMaker> all(
      "maker", {
                   MeshMaker{{"schwarz_lantern", "a cylinder of triangles whose normals do not follow its own", "Schwarz 1880"},
                             {length("radius", 1.0, "of the cylinder"), length("half_height", 1.0, "of the cylinder"),
                              whole("around", 16.0, 3.0, "vertices of a ring"), whole("along", 64.0, 1.0, "rings")},
                             lantern},
                   MeshMaker{{"globe", "a ball by longitude and latitude, quads collapsed at the poles", "limn"},
                             {length("radius", 1.0, "of the ball"), whole("around", 12.0, 3.0, "quads of a ring"),
                              whole("along", 8.0, 2.0, "rings")},
                             globe},
                   MeshMaker{{"spindle", "two vertices joined by quads, as many as wanted", "limn"},
                             {length("radius", 1.0, "of its waist"), length("half_height", 1.0, "of each vertex"),
                              whole("valence", 7.0, 3.0, "edges at each of the two")},
                             spindle},
                   MeshMaker{{"box", "a cube of squares", "limn"},
                             {length("half", 1.0, "of its side"), whole("divisions", 4.0, 1.0, "squares along a side"),
                              a_number("crease", 0.0).in(0.0, 10.0).help("sharpness of the four upper edges"),
                              a_number("edges", 0.0).in(0.0, 10.0).help("sharpness of all twelve edges")},
                             box},
                   MeshMaker{{"torus", "a torus of triangles and quads, about y", "limn"},
                             {length("major", 1.0, "radius of its centre"), length("minor", 0.4, "radius of its tube"),
                              whole("level", 2.0, 0.0, "refinements")},
                             torus},
               });
  return all;
}

}  // namespace limn
