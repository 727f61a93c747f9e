#include "subdiv/face_orientation.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "subdiv/mesh_audit.h"
#include "subdiv/polygon.h"
#include "test_meshes.h"

namespace limn {
namespace {

/// The first corners stay where they are, as in files of programs that turn faces.
Mesh turned(Mesh mesh) {
  turn_faces(mesh);
  return mesh;
}

Mesh both(Mesh mesh, const Mesh& other) {
  test::append(mesh, other);
  return mesh;
}

/// What turn_outwards makes of `mesh`, and how many parts it says it turned.
struct Outcome {
  Mesh mesh;
  std::int64_t turned_parts;
};
Outcome outwards(Mesh mesh) {
  const std::int64_t turned_parts = turn_outwards(mesh);
  return {std::move(mesh), turned_parts};
}

/// A sphere without its faces above `height`.
Mesh cut_sphere(double height) {
  const Mesh whole = test::sphere(4);
  Mesh mesh{.positions = whole.positions};
  for (size_t f = 0; f < whole.face_count(); ++f) {
    const auto at = [&](size_t corner) { return whole.corner_vertices[3 * f + corner]; };
    const auto height_of = [&](size_t corner) { return whole.positions[static_cast<size_t>(at(corner))].z; };
    if (std::max({height_of(0), height_of(1), height_of(2)}) <= height) test::add_face(mesh, {at(0), at(1), at(2)});
  }
  return mesh;
}

/// Winding number by solid angles (Van Oosterom & Strackee 1983).
double winding_number(const Mesh& mesh, const glm::dvec3& point) {
  double sum = 0.0;
  std::vector<glm::dvec3> corners;
  const std::vector<std::int32_t> first = first_corners(mesh);
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    gather_corners(mesh, face_corners(mesh, first[f], f), corners);
    for (size_t i = 2; i < corners.size(); ++i) {
      const glm::dvec3 a = corners[0] - point, b = corners[i - 1] - point, c = corners[i] - point;
      const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
      const double below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
      sum += 2.0 * std::atan2(glm::dot(a, glm::cross(b, c)), below);
    }
  }
  return sum / (4.0 * std::numbers::pi);
}

/// 1 where every corner of `part` lies in the solids, 0 where every one lies outside; nothing where it touches their surface or crosses it.
std::optional<int> side_of_all(const Mesh& part, const Mesh& solids) {
  std::optional<int> side;
  for (const glm::dvec3& corner : part.positions) {
    const double winding = winding_number(solids, corner);
    const int nearest = static_cast<int>(std::lround(winding));
    if (std::abs(winding - nearest) > 1e-3 || side.value_or(nearest) != nearest) return std::nullopt;
    side = nearest;
  }
  return side;
}

TEST(Orientation, TurningTwiceGivesTheSameMeshAndKeepsFirstCorners) {
  Mesh mesh = test::prism(5);
  mesh.corner_normals = angle_weighted_normals(mesh);
  const Mesh once = turned(mesh), twice = turned(once);
  EXPECT_EQ(twice.corner_vertices, mesh.corner_vertices);
  EXPECT_EQ(twice.corner_normals, mesh.corner_normals);
  const std::vector<std::int32_t> first = first_corners(mesh);
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const auto from = static_cast<size_t>(first[f]), size = static_cast<size_t>(mesh.face_sizes[f]);
    for (size_t c = 0; c < size; ++c) {
      EXPECT_EQ(once.corner_vertices[from + c], mesh.corner_vertices[from + (size - c) % size]);
      EXPECT_EQ(once.corner_normals[from + c], mesh.corner_normals[from + (size - c) % size]);
    }
  }
}

TEST(Orientation, WhatIsInsideOutComesOutAsItWas) {
  const Mesh solid = test::torus(24, 12, 1.0, 0.3);
  const Mesh hollow = both(test::box_at(glm::dvec3(1.0), glm::dvec3(0.0)), turned(test::box_at(glm::dvec3(0.5), glm::dvec3(0.0))));
  const Mesh apart = both(test::box_at(glm::dvec3(2.0), glm::dvec3(0.0)), test::box_at(glm::dvec3(0.5), glm::dvec3(5.0)));
  for (const Mesh& mesh : {solid, hollow, apart}) {
    EXPECT_EQ(outwards(mesh).turned_parts, 0);
    EXPECT_EQ(outwards(mesh).mesh.corner_vertices, mesh.corner_vertices) << "right as it is";
    const Outcome back = outwards(turned(mesh));
    EXPECT_EQ(back.turned_parts, mesh_facts(mesh).parts);
    EXPECT_EQ(back.mesh.corner_vertices, mesh.corner_vertices);
  }
}

TEST(Orientation, OnePartOfTwoIsTurnedWhicheverIsLarger) {
  const Mesh small = test::box_at(glm::dvec3(0.5), glm::dvec3(5.0)), large = test::box_at(glm::dvec3(2.0), glm::dvec3(0.0));
  for (const Mesh& wrong : {both(large, turned(small)), both(turned(large), small)}) {
    const Outcome back = outwards(wrong);
    EXPECT_EQ(back.turned_parts, 1);
    EXPECT_EQ(back.mesh.corner_vertices, both(large, small).corner_vertices);
  }
}

TEST(Orientation, HolesAreNoObstacleSheetsHaveNoInside) {
  // A cap of height 0.1 is missing: a hundredth of the volume.
  const Mesh nearly = cut_sphere(0.9);
  ASSERT_GT(mesh_facts(nearly).open_edges, 0);
  EXPECT_EQ(outwards(turned(nearly)).mesh.corner_vertices, nearly.corner_vertices);
  EXPECT_EQ(outwards(nearly).turned_parts, 0);
  // A bowl may be meant from either side; so may a sheet, and faces that disagree have no side at all.
  Mesh mixed = test::cube();
  std::reverse(mixed.corner_vertices.begin(), mixed.corner_vertices.begin() + 4);
  for (const Mesh& mesh : {cut_sphere(0.0), test::grid(4, 4), mixed}) {
    EXPECT_EQ(outwards(mesh).turned_parts, 0);
    EXPECT_EQ(outwards(turned(mesh)).turned_parts, 0);
    EXPECT_EQ(outwards(turned(mesh)).mesh.corner_vertices, turned(mesh).corner_vertices);
  }
}

TEST(Orientation, NormalsOfTheFileEndUpOutside) {
  Mesh mesh = test::sphere(2);
  mesh.corner_normals = angle_weighted_normals(mesh);
  Mesh inwards = turned(mesh), outside = inwards;
  for (glm::vec3& normal : inwards.corner_normals) normal = -normal;
  EXPECT_EQ(outwards(inwards).mesh.corner_normals, mesh.corner_normals) << "turned with the faces";
  EXPECT_EQ(outwards(outside).mesh.corner_normals, mesh.corner_normals) << "right beside a wrong winding";
  EXPECT_EQ(outwards(mesh).mesh.corner_normals, mesh.corner_normals);
}

RC_GTEST_PROP(Orientation, CavitiesAreWhatTheWindingNumberSays, ()) {
  const auto unit = [] { return *rc::gen::inRange(-100000, 100001) / 100000.0; };
  Mesh mesh = test::torus(17, 9, 1.0, 0.4);
  test::append(mesh, test::box_at(glm::dvec3(0.05), glm::dvec3(0.0)));
  const Mesh solids = mesh;
  std::int64_t cavities = 0, inverted = 0;
  for (int i = 0; i < 24; ++i) {
    glm::dvec3 place(1.3 * unit(), 1.3 * unit(), 0.3 * unit());
    // Behind a vertex of the solids, where a ray along x meets all the faces around it.
    const glm::dvec3 met = solids.positions[*rc::gen::inRange<size_t>(0, solids.positions.size())];
    if (i % 2 == 0) place = {place.x, met.y, met.z};
    Mesh hole = turned(test::box_at(glm::dvec3(1e-9), glm::dvec3(0.0)));
    const glm::dvec3 corner = hole.positions[*rc::gen::inRange<size_t>(0, 8)];
    for (glm::dvec3& p : hole.positions) p = place + (p - corner);
    // Beside a corner of the box lies the line of its edge, where there is no telling in from out.
    const std::optional<int> side = side_of_all(hole, solids);
    if (!side) continue;
    ++(*side == 1 ? cavities : inverted);
    test::append(mesh, hole);
  }
  const MeshFacts facts = mesh_facts(mesh);
  RC_ASSERT(facts.cavities == cavities);
  RC_ASSERT(facts.inverted_parts == inverted);
}

}  // namespace
}  // namespace limn
