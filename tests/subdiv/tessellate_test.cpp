#include "subdiv/tessellate.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstdio>
#include <map>
#include <numbers>
#include <random>

#include "sdf/error.h"
#include "sdf/shape.h"
#include "subdiv/dual_contour.h"
#include "subdiv/mesh_audit.h"
#include "subdiv/polygon.h"
#include "subdiv/surface_snap.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

struct Quality {
  double worst_off = 0.0;  // |f|/|grad f| by the radius of the bounds
  size_t folded = 0;
};

Quality quality_of(const Field& field, const Mesh& mesh) {
  Quality quality;
  FieldEvaluator evaluator(field);
  const double radius = field.traits().bounds.radius();
  for (const glm::dvec3& p : mesh.positions) {
    const FieldJet jet = evaluator.jet(p);
    quality.worst_off = std::max(quality.worst_off, std::abs(jet.value) / std::max(glm::length(jet.gradient), 1e-9) / radius);
  }
  quality.folded = folded_faces(field, mesh).size();
  return quality;
}

Mesh tessellated(const Field& field, int level) {
  TessellateSettings settings;
  settings.level = level;
  return tessellate(field, settings);
}

Field carved_box() { return combine(Csg::difference, make_shape("box", {{"half", {1, 1, 1}}}), make_shape("sphere", {{"radius", {1.2}}})); }

TEST(Tessellate, EveryBoundedShapeIsAClosedManifoldOnItsSurfaceWithTheRightTopology) {
  // Euler numbers of the shapes as their defaults make them; the gyroid's is not known beforehand.
  const std::map<std::string, std::int64_t> euler = {{"torus", 0}, {"cyclide", 0}};
  int checked = 0;
  for (const ShapeDescriptor& shape : shapes()) {
    const std::string& name = shape.about.name;
    const Field field = make_shape(name);
    if (!field.traits().bounds.finite()) {
      EXPECT_THROW(cage_of(field), InputError) << name;
      continue;
    }
    const Mesh mesh = tessellated(field, 1);
    const std::optional<Topology> topology = topology_of(mesh);
    ASSERT_TRUE(topology.has_value()) << name << " is not a closed manifold";
    EXPECT_EQ(topology->parts, 1) << name;
    if (name != "gyroid") {
      EXPECT_EQ(topology->euler, euler.count(name) ? euler.at(name) : 2) << name;
    }
    const Quality quality = quality_of(field, mesh);
    std::printf("  %-15s %6zu faces, euler %3d, worst vertex off by %.1e of the radius, %zu folded\n", name.c_str(), mesh.face_count(),
                static_cast<int>(topology->euler), quality.worst_off, quality.folded);
    EXPECT_LT(quality.worst_off, 1e-9) << name;
    // Where the ball cuts the gyroid's wall to wedges a face in a thousand may fold.
    EXPECT_LE(quality.folded, name == "gyroid" ? mesh.face_count() / 1000 : 0u) << name;
    ASSERT_EQ(mesh.corner_normals.size(), mesh.corner_vertices.size()) << name;
    for (const glm::vec3& n : mesh.corner_normals) ASSERT_NEAR(glm::length(n), 1.0f, 1e-5f) << name;
    EXPECT_NO_THROW(validate(mesh, name));
    ++checked;
  }
  EXPECT_GE(checked, 10);
}

TEST(Tessellate, CagesHaveAboutAHundredFacesAndMore) {
  for (const char* name : {"sphere", "torus", "box", "capsule"}) {
    const Mesh cage = cage_of(make_shape(name));
    EXPECT_GE(cage.face_count(), 80u) << name;
    EXPECT_LE(cage.face_count(), 1000u) << name;
  }
}

TEST(Tessellate, ABoxKeepsItsEdgesAndCornersAndFlatNormals) {
  for (const double angle : {0.0, 0.7}) {
    const Field box = rotate(make_shape("box", {{"half", {1.0, 0.8, 0.6}}}), {1.0, 2.0, 3.0}, angle);
    const Mesh mesh = tessellated(box, 2);
    double area = 0.0;
    const TriangleMesh triangles = triangulate(mesh, NormalKind::limit, true);
    double worst = 0.0;
    for (size_t i = 0; i < triangles.triangles.size(); ++i) {
      const glm::uvec3 t = triangles.triangles[i];
      const glm::dvec3 cross =
          glm::cross(triangles.positions[t.y] - triangles.positions[t.x], triangles.positions[t.z] - triangles.positions[t.x]);
      area += 0.5 * glm::length(cross);
      if (glm::length(cross) < 1e-8) continue;  // three corners along one edge of the box: a sliver's own normal is rounding
      for (size_t k = 0; k < 3; ++k)
        worst = std::max(worst, glm::length(glm::dvec3(triangles.corner_normals[3 * i + k]) - glm::normalize(cross)));
    }
    // Cut edges would lose area: 2 * 4 * (1*0.8 + 0.8*0.6 + 0.6*1).
    std::printf("  box turned by %.1f: area %.12f, worst normal off by %.2g\n", angle, area, worst);
    EXPECT_NEAR(area, 8.0 * (0.8 + 0.48 + 0.6), 1e-9);
    EXPECT_LT(worst, 1e-5);
  }
}

/// Length of the edges where two faces meet at more than 45 degrees.
double crease_length(const Mesh& mesh) {
  const std::vector<std::int32_t> first = first_corners(mesh);
  std::map<std::pair<std::int32_t, std::int32_t>, glm::dvec3> normal_beside;
  double length = 0.0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = face_corners(mesh, first[f], f);
    const auto at = [&](size_t i) { return mesh.positions[static_cast<size_t>(corners[i % corners.size()])]; };
    glm::dvec3 normal(0.0);
    for (size_t i = 0; i < corners.size(); ++i) normal += glm::cross(at(i) - at(0), at(i + 1) - at(0));
    for (size_t i = 0; i < corners.size(); ++i) {
      const std::int32_t a = corners[i], b = corners[(i + 1) % corners.size()];
      const auto [beside, is_first] = normal_beside.try_emplace(std::minmax(a, b), normal);
      const double cosine = glm::dot(beside->second, normal) / (glm::length(beside->second) * glm::length(normal));
      if (!is_first && cosine < std::sqrt(0.5)) length += glm::distance(at(i), at(i + 1));
    }
  }
  return length;
}

TEST(Tessellate, BoxesOfAnySizeAndPlaceLoseNothingAtTheirEdges) {
  const unsigned seed = random_seed();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int exact = 0, whole = 0;
  for (int i = 0; i < 24; ++i) {
    const glm::dvec3 half(0.4 + 0.6 * unit(random), 0.4 + 0.6 * unit(random), 0.4 + 0.6 * unit(random));
    const glm::dvec3 axis(unit(random) - 0.5, unit(random) - 0.5, unit(random) + 0.1);
    const double angle = 3.0 * unit(random), area = 8.0 * (half.x * half.y + half.y * half.z + half.z * half.x);
    const Field box = rotate(make_shape("box", {{"half", {half.x, half.y, half.z}}}), axis, angle);
    const Mesh faces = tessellated(box, 2);
    whole += std::abs(crease_length(faces) - 8.0 * (half.x + half.y + half.z)) < 1e-8;
    const TriangleMesh mesh = triangulate(faces, NormalKind::limit, true);
    double found = 0.0;
    for (const glm::uvec3& t : mesh.triangles)
      found += 0.5 * glm::length(glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
    exact += std::abs(found - area) < 1e-8;
    EXPECT_NEAR(found, area, 1e-3 * area) << fmt::format("box {}, seed {}: half {} {} {}, axis {} {} {}, angle {}", i, seed, half.x, half.y,
                                                         half.z, axis.x, axis.y, axis.z, angle);
  }
  // Of a thousand boxes two keep a face that is folded over its neighbours; before the vertices followed the creases, 10 of 24 were cut.
  EXPECT_GE(exact, 22) << "of 24, seed " << seed;
  // All of each box's edges are edges of faces, none a fold inside a quad.
  EXPECT_GE(whole, 22) << "of 24, seed " << seed;
}

TEST(Tessellate, CsgEdgesAreKept) {
  // The carved box has 24 circular arcs where the sphere cuts the faces: vertices of the mesh must lie on them.
  const Field field = carved_box();
  const Mesh mesh = tessellated(field, 2);
  EXPECT_EQ(topology_of(mesh), (Topology{1, -8}));
  const Quality quality = quality_of(field, mesh);
  EXPECT_EQ(quality.folded, 0u);
  EXPECT_LT(quality.worst_off, 1e-9);
  int on_arcs = 0, on_edges = 0;
  for (const glm::dvec3& p : mesh.positions) {
    const glm::dvec3 q = glm::abs(p);
    const int faces = (std::abs(q.x - 1.0) < 1e-9) + (std::abs(q.y - 1.0) < 1e-9) + (std::abs(q.z - 1.0) < 1e-9);
    on_arcs += faces >= 1 && std::abs(glm::length(p) - 1.2) < 1e-9;
    on_edges += faces >= 2;
  }
  EXPECT_GT(on_arcs, 200);
  EXPECT_GT(on_edges, 200);
}

double worst_middle(const Field& field, const Mesh& mesh) {
  FieldEvaluator evaluator(field);
  const std::vector<std::int32_t> first = first_corners(mesh);
  double worst = 0.0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    glm::dvec3 middle(0.0);
    for (std::int32_t c = first[f]; c < first[f + 1]; ++c)
      middle += mesh.positions[static_cast<size_t>(mesh.corner_vertices[static_cast<size_t>(c)])] / double(first[f + 1] - first[f]);
    const FieldJet jet = evaluator.jet(middle);
    worst = std::max(worst, std::abs(jet.value) / glm::length(jet.gradient));
  }
  return worst;
}

TEST(Tessellate, HolesNarrowerThanACoarseCellAreFound) {
  // Six counterbored holes in a disc: two coarse samplings in a row see none of them.
  std::vector<Field> part = {make_shape("cylinder", {{"radius", {1.16}}, {"half_height", {0.14}}})};
  for (int i = 0; i < 6; ++i) {
    const double angle = (30.0 + 60.0 * i) * std::numbers::pi / 180.0;
    const glm::dvec3 at(0.92 * std::cos(angle), 0.0, 0.92 * std::sin(angle));
    part.push_back(translate(make_shape("cylinder", {{"radius", {0.085}}, {"half_height", {1.0}}}), at));
    part.push_back(translate(make_shape("cylinder", {{"radius", {0.145}}, {"half_height", {0.10}}}), at + glm::dvec3(0.0, 0.18, 0.0)));
  }
  const Field field = combine(Csg::difference, part);
  const Mesh mesh = tessellated(field, 2);
  EXPECT_EQ(topology_of(mesh), (Topology{1, 2 - 2 * 6}));
  const Quality quality = quality_of(field, mesh);
  EXPECT_EQ(quality.folded, 0u);
  EXPECT_LT(quality.worst_off, 1e-9);
  std::printf("  %zu faces, middles off by %.2g\n", mesh.face_count(), worst_middle(field, mesh));
  EXPECT_LT(worst_middle(field, mesh), 0.012);
}

TEST(Tessellate, SharpWedgesAreFollowed) {
  // The carved box's edges are wedges of 34 degrees.
  const Field field = carved_box();
  for (const int level : {1, 2}) EXPECT_LT(worst_middle(field, tessellated(field, level)), 0.006) << level;
}

TEST(Tessellate, PositionsConvergeToTheSurfaceByTheSquareOfTheEdge) {
  const Field field = make_shape("ellipsoid");
  FieldEvaluator evaluator(field);
  double previous = 0.0;
  for (const int level : {1, 2, 3}) {
    const Mesh mesh = tessellated(field, level);
    const std::vector<std::int32_t> first = first_corners(mesh);
    double worst = 0.0;
    for (size_t f = 0; f < mesh.face_count(); ++f) {
      glm::dvec3 middle(0.0);
      for (std::int32_t c = first[f]; c < first[f + 1]; ++c)
        middle += 0.25 * mesh.positions[static_cast<size_t>(mesh.corner_vertices[static_cast<size_t>(c)])];
      const FieldJet jet = evaluator.jet(middle);
      worst = std::max(worst, std::abs(jet.value) / glm::length(jet.gradient));
    }
    std::printf("  ellipsoid level %d: %zu faces, middles off by %.2g\n", level, mesh.face_count(), worst);
    if (previous > 0.0) {
      EXPECT_GT(previous / worst, 3.0);
    }
    previous = worst;
  }
}

TEST(Tessellate, SeveralPartsAndHollowOnes) {
  const Field shell_of_ball = shell(make_shape("sphere", {{"radius", {1.0}}}), 0.2);
  EXPECT_EQ(topology_of(tessellated(shell_of_ball, 1)), (Topology{2, 4}));
  const Field two = combine(Csg::union_, translate(make_shape("sphere", {{"radius", {0.5}}}), {-1, 0, 0}),
                            translate(make_shape("torus", {{"major", {0.5}}, {"minor", {0.15}}}), {1, 0, 0}));
  EXPECT_EQ(topology_of(tessellated(two, 1)), (Topology{2, 2}));
}

TEST(Tessellate, ThreadsDoNotChangeIt) {
  const Field field = carved_box();
  const Mesh many = tessellated(field, 1);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  const Mesh one = tessellated(field, 1);
  EXPECT_EQ(many.positions, one.positions);
  EXPECT_EQ(many.corner_vertices, one.corner_vertices);
  EXPECT_EQ(many.corner_normals, one.corner_normals);
}

TEST(Tessellate, RefusesLevelsAndSizes) {
  TessellateSettings settings;
  settings.level = 9;
  EXPECT_THROW(tessellate(make_shape("sphere"), settings), InputError);
  settings.level = 8;
  settings.max_bytes = 1 << 20;
  EXPECT_THROW(tessellate(make_shape("sphere"), settings), InputError);
  EXPECT_THROW(tessellate(make_shape("plane"), {}), InputError);
}

}  // namespace
}  // namespace limn
