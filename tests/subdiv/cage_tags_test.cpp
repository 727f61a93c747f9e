// Holes, Chaikin's creases, smooth triangles, quads with a corner twice: against OpenSubdiv's own refiner, called directly, and by hand.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <algorithm>
#include <numbers>
#include <random>
#include <span>

#include "subdiv/mesh_audit.h"
#include "subdiv/refine.h"
#include "test_meshes.h"

namespace limn {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

struct Point {
  glm::dvec3 p{0.0};
  void Clear(void* = nullptr) { p = glm::dvec3(0.0); }
  void AddWithWeight(const Point& other, double weight) { p += weight * other.p; }
};

struct Direct {
  std::unique_ptr<Far::TopologyRefiner> refiner;
  std::vector<Point> points;  ///< Of the last level.

  const Far::TopologyLevel& last() const { return refiner->GetLevel(refiner->GetMaxLevel()); }
  std::vector<Point> limit() const {
    std::vector<Point> result(points);
    Far::PrimvarRefinerReal<double>(*refiner).Limit(points, result);
    return result;
  }
  /// The descendant of a base vertex on the last level.
  size_t descendant(int vertex) const {
    for (int l = 0; l < refiner->GetMaxLevel(); ++l) vertex = refiner->GetLevel(l).GetVertexChildVertex(vertex);
    return static_cast<size_t>(vertex);
  }
};

Direct refine_directly(const Mesh& cage, Scheme scheme, int level) {
  std::vector<int> pairs, corners;
  std::vector<float> weights, corner_weights;
  for (const Crease& crease : cage.creases) {
    pairs.insert(pairs.end(), {crease.vertex_a, crease.vertex_b});
    weights.push_back(crease.sharpness);
  }
  for (const CornerTag& corner : cage.corners) corners.push_back(corner.vertex), corner_weights.push_back(corner.sharpness);
  Far::TopologyDescriptor descriptor;
  descriptor.numVertices = static_cast<int>(cage.vertex_count());
  descriptor.numFaces = static_cast<int>(cage.face_count());
  descriptor.numVertsPerFace = cage.face_sizes.data();
  descriptor.vertIndicesPerFace = cage.corner_vertices.data();
  descriptor.numCreases = static_cast<int>(weights.size());
  descriptor.creaseVertexIndexPairs = pairs.data();
  descriptor.creaseWeights = weights.data();
  descriptor.numCorners = static_cast<int>(corners.size());
  descriptor.cornerVertexIndices = corners.data();
  descriptor.cornerWeights = corner_weights.data();
  descriptor.numHoles = static_cast<int>(cage.holes.size());
  descriptor.holeIndices = cage.holes.data();
  Sdc::Options options;
  options.SetVtxBoundaryInterpolation(cage.boundary == BoundaryRule::none        ? Sdc::Options::VTX_BOUNDARY_NONE
                                      : cage.boundary == BoundaryRule::edge_only ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY
                                                                                 : Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  if (cage.crease_method == CreaseMethod::chaikin) options.SetCreasingMethod(Sdc::Options::CREASE_CHAIKIN);
  if (cage.triangle_rule == TriangleRule::smooth) options.SetTriangleSubdivision(Sdc::Options::TRI_SUB_SMOOTH);
  const Sdc::SchemeType type = scheme == Scheme::loop       ? Sdc::SCHEME_LOOP
                               : scheme == Scheme::bilinear ? Sdc::SCHEME_BILINEAR
                                                            : Sdc::SCHEME_CATMARK;
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  Direct result;
  result.refiner.reset(Factory::Create(descriptor, Factory::Options(type, options)));
  Far::TopologyRefiner::UniformOptions uniform(level);
  uniform.fullTopologyInLastLevel = true;
  result.refiner->RefineUniform(uniform);
  result.points.resize(cage.vertex_count());
  for (size_t v = 0; v < cage.vertex_count(); ++v) result.points[v].p = cage.positions[v];
  for (int l = 1; l <= level; ++l) {
    std::vector<Point> finer(static_cast<size_t>(result.refiner->GetLevel(l).GetNumVertices()));
    Far::PrimvarRefinerReal<double>(*result.refiner).Interpolate(l, result.points, finer);
    result.points = std::move(finer);
  }
  return result;
}

std::span<const std::int32_t> corners_of(const Mesh& mesh, size_t face) {
  return std::span(mesh.corner_vertices)
      .subspan(static_cast<size_t>(first_corners(mesh)[face]), static_cast<size_t>(mesh.face_sizes[face]));
}

/// Face by face and corner by corner; holes are left out.
void expect_equal(const Mesh& mesh, const Direct& direct, const std::vector<Point>& points, double tolerance, const std::string& what) {
  size_t corner = 0, face = 0;
  for (int f = 0; f < direct.last().GetNumFaces(); ++f) {
    if (direct.last().IsFaceHole(f)) continue;
    ASSERT_LT(face, mesh.face_count()) << what;
    const Far::ConstIndexArray vertices = direct.last().GetFaceVertices(f);
    ASSERT_EQ(mesh.face_sizes[face++], vertices.size()) << what;
    for (const int v : vertices)
      ASSERT_LE(glm::distance(mesh.positions[static_cast<size_t>(mesh.corner_vertices[corner++])], points[static_cast<size_t>(v)].p),
                tolerance)
          << what << ", face " << f;
  }
  EXPECT_EQ(face, mesh.face_count()) << what;
}

/// Cages of triangles, quads and pentagons with creases, holes and all rules at random.
Mesh random_cage(unsigned seed) {
  std::mt19937 random(seed);
  Mesh cage = seed % 4 == 0   ? test::jittered(test::torus(7, 5, 2.0, 0.7), 0.1, seed)
              : seed % 4 == 1 ? test::jittered(test::prism(5), 0.1, seed)
              : seed % 4 == 2 ? test::jittered(test::grid(4, 5), 0.2, seed)
                              : test::jittered(test::sphere(1), 0.1, seed);
  for (const Edge& edge : build_edges(cage))
    if (random() % 3 == 0) cage.creases.push_back({edge.vertex_a, edge.vertex_b, static_cast<float>(random() % 40) / 10.0f});
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(cage.face_count()); ++f)
    if (random() % 6 == 0) cage.holes.push_back(f);
  cage.boundary = random() % 2 == 0 ? BoundaryRule::edge_only : BoundaryRule::edge_and_corner;
  cage.crease_method = random() % 3 == 0 ? CreaseMethod::uniform : CreaseMethod::chaikin;
  cage.triangle_rule = random() % 3 == 0 ? TriangleRule::catmark : TriangleRule::smooth;
  return cage;
}

TEST(CageTags, RefinedPositionsAreOpenSubdivs) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const Mesh cage = random_cage(seed);
    for (const Scheme scheme : {Scheme::catmark, Scheme::bilinear, Scheme::loop}) {
      if (scheme == Scheme::loop && default_scheme(cage) != Scheme::loop) continue;
      for (const int level : {1, 3}) {
        const Mesh mesh = refine(cage, {scheme, level, false});
        const Direct direct = refine_directly(cage, scheme, level);
        expect_equal(mesh, direct, direct.points, 0.0, fmt::format("seed {} {} level {}", seed, name_of(scheme), level));
        EXPECT_EQ(predict_refined_size(cage, scheme, level).faces, static_cast<std::int64_t>(mesh.face_count()));
        EXPECT_EQ(predict_refined_size(cage, scheme, level).vertices, static_cast<std::int64_t>(mesh.vertex_count()));
      }
    }
  }
}

/// Six levels on, every semi-sharp crease has worn off, and OpenSubdiv's own limit masks hold (but at the ends of sharp creases).
struct FarLimit {
  Direct direct;
  std::vector<Point> points;

  explicit FarLimit(const Mesh& cage, Scheme scheme) : direct(refine_directly(cage, scheme, scheme == Scheme::loop ? 5 : 6)) {
    points = direct.limit();
  }
  glm::dvec3 at(std::int32_t base_vertex) const { return points[direct.descendant(base_vertex)].p; }
};

TEST(CageTags, TheLimitIsThatOfLaterLevels) {
  for (unsigned seed = 1; seed <= 16; ++seed) {
    const Mesh cage = random_cage(seed);
    const Scheme scheme = default_scheme(cage);
    const Mesh mesh = refine(cage, {scheme, 0, true});
    const FarLimit limit(cage, scheme);
    // What Chaikin's rule makes of a spoke's far end lies outside of a vertex's ring, from which a semi-sharp vertex's limit is found.
    const double tolerance = cage.crease_method == CreaseMethod::chaikin ? 5e-4 * bounds(cage).longest_side() : 1e-9;
    size_t corner = 0, face = 0;
    for (size_t f = 0; f < cage.face_count(); ++f) {
      if (std::binary_search(cage.holes.begin(), cage.holes.end(), static_cast<std::int32_t>(f))) continue;
      ++face;
      for (const std::int32_t v : corners_of(cage, f)) {
        const glm::dvec3& ours = mesh.positions[static_cast<size_t>(mesh.corner_vertices[corner++])];
        EXPECT_LT(glm::distance(ours, limit.at(v)), tolerance) << "seed " << seed << ", vertex " << v;
      }
    }
    EXPECT_EQ(face, mesh.face_count());
  }
}

TEST(CageTags, ChaikinsSharpnessByHand) {
  // Two creases meet: the child at the meeting takes a quarter of the other's sharpness (DeRose, Kass & Truong 1998): (3 s1 + s2)/4 - 1.
  Mesh cage = test::grid(2, 2);
  cage.creases = {{3, 4, 3.0f}, {4, 5, 2.0f}};
  cage.crease_method = CreaseMethod::chaikin;
  const auto sharpnesses = [&cage] {
    std::vector<float> values;
    for (const Crease& crease : refine(cage, {Scheme::catmark, 1, false}).creases) values.push_back(crease.sharpness);
    std::sort(values.begin(), values.end());
    return values;
  };
  EXPECT_EQ(sharpnesses(), (std::vector<float>{1.0f, 1.25f, 1.75f, 2.0f}));
  cage.crease_method = CreaseMethod::uniform;
  EXPECT_EQ(sharpnesses(), (std::vector<float>{1.0f, 1.0f, 2.0f, 2.0f}));
}

TEST(CageTags, SmoothTrianglesByHand) {
  // An edge between two triangles (Stam & Loop 2003, as OpenSubdiv has it): 0.47 of each face's middle, 0.03 of each end.
  Mesh cage = test::tetrahedron();
  cage.triangle_rule = TriangleRule::smooth;
  const Mesh smooth = refine(cage, {Scheme::catmark, 1, false});
  cage.triangle_rule = TriangleRule::catmark;
  const Mesh usual = refine(cage, {Scheme::catmark, 1, false});
  const auto has = [](const Mesh& mesh, const glm::dvec3& p) {
    return std::any_of(mesh.positions.begin(), mesh.positions.end(), [&](const glm::dvec3& q) { return glm::distance(p, q) < 1e-7; });
  };
  for (const Edge& edge : build_edges(cage)) {
    const auto at = [&cage](std::int32_t v) { return cage.positions[static_cast<size_t>(v)]; };
    const auto middle = [&](std::int32_t f) {
      const auto c = [&](size_t i) { return at(cage.corner_vertices[3 * static_cast<size_t>(f) + i]); };
      return (c(0) + c(1) + c(2)) / 3.0;
    };
    const glm::dvec3 ends = at(edge.vertex_a) + at(edge.vertex_b), faces = middle(edge.face_a) + middle(edge.face_b);
    EXPECT_TRUE(has(smooth, 0.03 * ends + 0.47 * faces));
    EXPECT_FALSE(has(smooth, 0.25 * ends + 0.25 * faces));
    EXPECT_TRUE(has(usual, 0.25 * ends + 0.25 * faces));
  }
}

TEST(CageTags, HolesAreRefinedAndNotDrawn) {
  Mesh cage = test::cube();
  const Mesh whole = refine(cage, {Scheme::catmark, 2, true});
  cage.holes = {2};
  for (int level = 0; level <= 3; ++level) {
    const Mesh mesh = refine(cage, {Scheme::catmark, level, true});
    EXPECT_EQ(mesh.face_count(), 5u << (2 * level));
    EXPECT_TRUE(mesh.holes.empty());
    EXPECT_EQ(mesh_facts(mesh).open_edges, 4 << level) << "edges of a border around the hole";
    EXPECT_EQ(mesh_facts(mesh).unused_vertices, 0);
  }
  // What is left lies where it lies on the whole surface.
  const Mesh mesh = refine(cage, {Scheme::catmark, 2, true});
  for (const glm::dvec3& p : mesh.positions)
    EXPECT_TRUE(
        std::any_of(whole.positions.begin(), whole.positions.end(), [&](const glm::dvec3& q) { return glm::distance(p, q) < 1e-14; }));
  const LimitSurface surface(cage, Scheme::catmark);
  LimitPoint point;
  for (int face = 0; face < 6; ++face) {
    EXPECT_EQ(surface.is_hole(face), face == 2);
    EXPECT_EQ(surface.evaluate(face, 0, 0.3, 0.6, point), face != 2);
  }
}

TEST(CageTags, HolesOfARefinedCageAreRefinedFurtherAsThoseOfTheFirst) {
  Mesh cage = test::cube();
  cage.holes = {2};
  const Mesh direct = refine(cage, {Scheme::catmark, 3, true});
  const Mesh once =
      refine(cage, {.scheme = Scheme::catmark, .level = 1, .to_limit = false, .normals = NormalKind::flat, .keep_holes = true});
  EXPECT_EQ(once.face_count(), 24u);
  EXPECT_EQ(once.holes.size(), 4u);
  const Mesh later = refine(once, {Scheme::catmark, 2, true});
  ASSERT_EQ(later.vertex_count(), direct.vertex_count());
  ASSERT_EQ(later.face_count(), direct.face_count());
  // Vertices are numbered otherwise.
  double worst = 0.0;
  for (const glm::dvec3& p : later.positions) {
    double nearest = 1e9;
    for (const glm::dvec3& q : direct.positions) nearest = std::min(nearest, glm::distance(p, q));
    worst = std::max(worst, nearest);
  }
  EXPECT_LT(worst, 1e-14);
}

TEST(CageTags, SampledFactsLeaveHolesOut) {
  Mesh cage = refine(test::cube(), {Scheme::catmark, 4, true});
  for (std::int32_t face = 0; face < static_cast<std::int32_t>(cage.face_count()); face += 7) cage.holes.push_back(face);
  EXPECT_GT(sampled_mesh_facts(cage, cage.face_count() / 2).open_edges, 100);
}

TEST(CageTags, TheLimitSurfaceTakesTheTags) {
  // Bfr's patches at their corners.
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Mesh cage = random_cage(seed);
    const Scheme scheme = default_scheme(cage);
    const FarLimit limit(cage, scheme);
    const LimitSurface surface(cage, scheme);
    const double size = bounds(cage).longest_side();
    // A patch does not know the creases beyond its neighbours, which Chaikin's rule asks for.
    const double tolerance = cage.crease_method == CreaseMethod::chaikin ? 2e-3 : 2e-4;
    int evaluated = 0;
    for (int f = 0; f < surface.face_count(); ++f) {
      LimitPoint point;
      if (surface.is_hole(f) || !surface.evaluate(f, 0, 0.0, 0.0, point)) continue;
      ++evaluated;
      EXPECT_LT(glm::distance(point.position, limit.at(corners_of(cage, static_cast<size_t>(f))[0])), tolerance * size)
          << "seed " << seed << ", face " << f << (cage.crease_method == CreaseMethod::chaikin ? " chaikin" : " uniform");
    }
    EXPECT_GT(evaluated, 0);
  }
}

/// A globe whose poles are one vertex each, which every quad there names twice.
Mesh globe_with_repeated_corners(int around, int along) {
  Mesh mesh;
  mesh.positions.emplace_back(0.0, 1.0, 0.0);
  for (int j = 1; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      const double t = std::numbers::pi * j / along, a = 2.0 * std::numbers::pi * i / around;
      mesh.positions.emplace_back(std::sin(t) * std::cos(a), std::cos(t), -std::sin(t) * std::sin(a));
    }
  mesh.positions.emplace_back(0.0, -1.0, 0.0);
  const auto vertex = [&](int j, int i) {
    return j == 0 ? 0 : j == along ? static_cast<int>(mesh.positions.size()) - 1 : 1 + (j - 1) * around + i % around;
  };
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) test::add_face(mesh, {vertex(j, i), vertex(j + 1, i), vertex(j + 1, i + 1), vertex(j, i + 1)});
  return mesh;
}

TEST(CageTags, QuadsWithACornerTwiceAreRefinedAsQuads) {
  const Mesh cage = globe_with_repeated_corners(7, 5);
  EXPECT_EQ(default_scheme(cage), Scheme::catmark);
  for (const int level : {1, 2, 3}) {
    const Mesh mesh = refine(cage, {Scheme::catmark, level, false});
    const Direct direct = refine_directly(cage, Scheme::catmark, level);
    expect_equal(mesh, direct, direct.points, 0.0, fmt::format("level {}", level));
    EXPECT_EQ(mesh.face_count(), 35u << (2 * level));
    const Mesh limit = refine(cage, {Scheme::catmark, level, true});
    expect_equal(limit, direct, direct.limit(), 1e-12, fmt::format("limit, level {}", level));
    for (const glm::vec3& n : limit.corner_normals) ASSERT_NEAR(glm::length(n), 1.0f, 1e-5f);
    for (size_t i = 0; i < limit.corner_vertices.size(); ++i) {
      const glm::dvec3& p = limit.positions[static_cast<size_t>(limit.corner_vertices[i])];
      // The poles are points (infinitely sharp, as OpenSubdiv has it); elsewhere the normal is about that of a ball.
      if (std::abs(p.y) < 0.8) {
        ASSERT_GT(glm::dot(glm::normalize(p), glm::dvec3(limit.corner_normals[i])), 0.9);
      }
    }
  }
  // A face that names two corners twice, or one three times, has no area and goes.
  Mesh faulty = test::cube();
  test::add_face(faulty, {0, 0, 1, 1});
  test::add_face(faulty, {0, 0, 0, 1});
  EXPECT_EQ(refine(faulty, {Scheme::catmark, 1}).face_count(), 24u);
}

TEST(CageTags, SchemesByDefault) {
  EXPECT_EQ(default_scheme(test::octahedron()), Scheme::loop);
  EXPECT_EQ(default_scheme(test::cube()), Scheme::catmark);
  EXPECT_EQ(default_scheme(test::prism(5)), Scheme::catmark) << "quads and pentagons";
  Mesh mixed = test::octahedron();
  mixed.positions.emplace_back(2.0, 2.0, 2.0);
  test::add_face(mixed, {0, 1, 2, 6});
  EXPECT_EQ(default_scheme(mixed), Scheme::catmark) << "triangles and one quad";
}

}  // namespace
}  // namespace limn
