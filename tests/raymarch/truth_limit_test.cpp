// Border curves of limit surfaces against roots found line by line, against a cube's known outline, and against what a fine mesh shows.

#include <set>

#include "raymarch/measured_border.h"
#include "raymarch/truth/limit_curves.h"
#include "raymarch/truth/limit_segments.h"
#include "raymarch/truth/proxy.h"
#include "tests/raymarch/border_distance.h"
#include "tests/raymarch/scenes.h"

namespace limn {
namespace {

using namespace test;

constexpr unsigned kSeed = 20261121;

glm::dvec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

Camera random_camera(const Scene& scene, std::mt19937& random, Projection projection, int width = 320, int height = 240) {
  CameraSettings settings = view(width, height, projection);
  settings.direction = random_direction(random);
  return framing(scene, settings);
}

/// A ring of quads around y, every vertex moved a little, so that nothing is symmetric.
Mesh bumpy_torus(std::mt19937& random) {
  constexpr int kAround = 10, kTube = 6;
  std::uniform_real_distribution<double> jitter(-0.05, 0.05);
  Mesh mesh;
  for (int i = 0; i < kAround; ++i) {
    for (int j = 0; j < kTube; ++j) {
      const double a = 2.0 * std::numbers::pi * i / kAround, b = 2.0 * std::numbers::pi * j / kTube, r = 1.0 + 0.35 * std::cos(b);
      mesh.positions.emplace_back(r * std::cos(a) + jitter(random), 0.35 * std::sin(b) + jitter(random), r * std::sin(a) + jitter(random));
    }
  }
  for (int i = 0; i < kAround; ++i) {
    for (int j = 0; j < kTube; ++j) {
      const auto at = [](int x, int y) { return (x % kAround) * kTube + y % kTube; };
      for (const int corner : {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)}) mesh.corner_vertices.push_back(corner);
      mesh.face_sizes.push_back(4);
    }
  }
  return mesh;
}

Mesh pyramid() {
  Mesh mesh;
  mesh.positions = {{-1, -0.6, -1}, {1, -0.6, -1}, {1, -0.6, 1}, {-1, -0.6, 1}, {0.1, 1.1, 0.2}};
  mesh.face_sizes = {4, 3, 3, 3, 3};
  mesh.corner_vertices = {0, 1, 2, 3, 4, 1, 0, 4, 2, 1, 4, 3, 2, 4, 0, 3};
  return mesh;
}

/// A bowl without a lid, deep enough to show its inside and its outside: half of the torus's rings, and its rim.
Mesh bowl() {
  constexpr int kAround = 8, kRings = 4;
  Mesh mesh;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int i = 0; i < kAround; ++i) {
      const double a = 2.0 * std::numbers::pi * i / kAround, r = std::array{0.4, 0.9, 1.1, 1.0}[static_cast<size_t>(ring)];
      mesh.positions.emplace_back(r * std::cos(a), std::array{-0.6, -0.4, 0.1, 0.6}[static_cast<size_t>(ring)] + 0.05 * std::cos(3.0 * a),
                                  r * std::sin(a));
    }
  }
  for (int ring = 0; ring + 1 < kRings; ++ring) {
    for (int i = 0; i < kAround; ++i) {
      const int next = (i + 1) % kAround;
      for (const int corner : {ring * kAround + i, (ring + 1) * kAround + i, (ring + 1) * kAround + next, ring * kAround + next})
        mesh.corner_vertices.push_back(corner);
      mesh.face_sizes.push_back(4);
    }
  }
  return mesh;
}

Mesh octahedron() {
  Mesh mesh;
  mesh.positions = {{1.2, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -0.8, 0}, {0, 0, 1}, {0, 0, -1.1}};
  mesh.face_sizes.assign(8, 3);
  mesh.corner_vertices = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  return mesh;
}

struct Cage {
  std::string name;
  Mesh mesh;
  Scheme scheme;
};

std::vector<Cage> cages(std::mt19937& random) {
  Mesh creased = box_mesh(glm::dvec3(1.0, 0.7, 0.8));
  creased.creases = {{0, 1, 10.0f}, {1, 3, 10.0f}, {3, 2, 10.0f}, {2, 0, 10.0f}, {4, 5, 2.0f}};
  return {{"box", box_mesh(glm::dvec3(1.0, 0.7, 0.5)), Scheme::catmark},
          {"creased box", creased, Scheme::catmark},
          {"torus", bumpy_torus(random), Scheme::catmark},
          {"pyramid with triangles", pyramid(), Scheme::catmark},
          {"octahedron", octahedron(), Scheme::loop}};
}

struct Line {
  glm::dvec2 a, b;
};
std::vector<Line> lines_of(const std::vector<TracedCurve>& curves) {
  std::vector<Line> lines;
  for (const TracedCurve& curve : curves) {
    for (size_t i = 0; i + 1 < curve.points.size(); ++i) lines.push_back({curve.points[i].px, curve.points[i + 1].px});
    if (curve.closed && !curve.points.empty()) lines.push_back({curve.points.back().px, curve.points.front().px});
  }
  return lines;
}

double distance_px(const glm::dvec2& p, const Line& line) { return test::segment_distance(p, line.a, line.b); }
double distance_px(const glm::dvec2& p, const std::vector<Line>& lines) {
  double best = std::numeric_limits<double>::infinity();
  for (const Line& line : lines) best = std::min(best, distance_px(p, line));
  return best;
}

/// Image points where N.V = c on lines of the surface, by nothing but bisection.
std::vector<glm::dvec2> roots_on_lines(const LimitSurface& surface, const Camera& camera, double c) {
  std::vector<glm::dvec2> roots;
  for (int face = 0; face < surface.face_count(); ++face) {
    const bool shares = surface.has_sub_faces(face), triangle = !shares && surface.face_size(face) == 3;
    for (int share = 0; share < (shares ? surface.face_size(face) : 1); ++share) {
      const auto facing = [&](double u, double v, glm::dvec2& px) {
        LimitPoint point;
        EXPECT_TRUE(surface.evaluate(face, share, u, v, point));
        px = glm::dvec2(project(camera, point.position));
        return glm::dot(glm::normalize(glm::cross(point.du, point.dv)), view_vector(camera, point.position)) - c;
      };
      for (int line = 0; line < 17; ++line) {
        const double u = (line + 0.37) / 17.0, reach = triangle ? 1.0 - u : 1.0;
        constexpr int kSteps = 60;
        glm::dvec2 px;
        for (int k = 0; k < kSteps; ++k) {
          double low = 0.001 + 0.998 * reach * k / kSteps, high = 0.001 + 0.998 * reach * (k + 1) / kSteps;
          const bool sign = facing(u, low, px) < 0.0;
          if (sign == (facing(u, high, px) < 0.0)) continue;
          for (int step = 0; step < 50; ++step) {
            const double middle = 0.5 * (low + high);
            ((facing(u, middle, px) < 0.0) == sign ? low : high) = middle;
          }
          roots.push_back(px);
        }
      }
    }
  }
  return roots;
}

TEST(TruthLimit, BlocksOfTrianglesHideNoSegment) {
  std::mt19937 random(kSeed);
  RecordProperty("seed", static_cast<int>(kSeed));
  size_t segments = 0;
  for (const Cage& cage : cages(random)) {
    const Scene scene = scene_of({object_of(cage.mesh, cage.scheme)});
    const LimitSurface surface(cage.mesh, cage.scheme);
    const PlacedLimitSurface placed = place(surface, {});
    for (int turn = 0; turn < 4; ++turn) {
      const Camera camera = random_camera(scene, random, turn % 2 ? Projection::orthographic : Projection::perspective);
      double cell_px = 0.0;
      const LimitGrid grid = sample_grid(placed, camera, 8.0, 100'000, cell_px);
      ASSERT_GT(grid.blocks.size(), 1u);
      // One block of everything, whose normals point everywhere.
      LimitGrid whole = sample_grid(placed, camera, 8.0, 100'000, cell_px);
      whole.blocks = {{0, triangle_count(whole)}};
      whole.blocks[0].angle = 4.0;
      whole.blocks[0].cosine = -1.0;
      for (const double c : {0.0, 0.4}) {
        const LimitLevel level{c > 0.0 ? CurveKind::inner : CurveKind::silhouette, c, LimitTurn::none, false};
        const std::vector<LimitSegment> some = limit_segments(placed, grid, camera, level),
                                        all = limit_segments(placed, whole, camera, level);
        ASSERT_EQ(some.size(), all.size()) << cage.name << " c " << c << " view " << turn << " seed " << kSeed;
        for (size_t i = 0; i < all.size(); ++i) {
          EXPECT_EQ(some[i].ends[0].uv, all[i].ends[0].uv);
          EXPECT_EQ(some[i].ends[1].uv, all[i].ends[1].uv);
        }
        segments += all.size();
      }
    }
  }
  EXPECT_GT(segments, 1000u);
}

TEST(TruthLimit, EveryRootOnALineOfTheSurfaceLiesOnACurve) {
  std::mt19937 random(kSeed);
  RecordProperty("seed", static_cast<int>(kSeed));
  double worst = 0.0;
  size_t roots_seen = 0;
  for (const Cage& cage : cages(random)) {
    const Scene scene = scene_of({object_of(cage.mesh, cage.scheme)});
    const LimitSurface surface(cage.mesh, cage.scheme);
    for (int turn = 0; turn < 4; ++turn) {
      const Camera camera = random_camera(scene, random, turn % 2 ? Projection::orthographic : Projection::perspective);
      const PlacedLimitSurface placed = place(surface, {});
      double cell_px = 0.0;
      const LimitGrid grid = sample_grid(placed, camera, 4.0, 1'000'000, cell_px);
      EXPECT_TRUE(grid.invalid_patches.empty()) << cage.name;
      for (const double c : {0.0, 0.15, 0.6}) {
        const CurveKind kind = c > 0.0 ? CurveKind::inner : CurveKind::silhouette;
        const std::vector<TracedCurve> curves = trace_limit_curves(placed, grid, camera, {kind, c, 0.002, 1});
        const std::vector<Line> lines = lines_of(curves);
        for (const glm::dvec2& root : roots_on_lines(surface, camera, c)) {
          const double off = distance_px(root, lines);
          worst = std::max(worst, off);
          ++roots_seen;
          ASSERT_LT(off, 0.01) << cage.name << " c " << c << " view " << turn << " seed " << kSeed;
        }
        for (const TracedCurve& curve : curves) {
          // Silhouettes of closed surfaces are closed; so are level curves where no crease cuts them off.
          EXPECT_TRUE(curve.closed || (c > 0.0 && cage.name == "creased box")) << cage.name << " c " << c;
          for (const TracedPoint& point : curve.points) {
            if (!point.crease) {
              ASSERT_NEAR(glm::dot(point.high, view_vector(camera, point.p)), c, 1e-5) << cage.name;
            }
          }
        }
      }
    }
  }
  EXPECT_GT(roots_seen, 3000u);
  std::printf("%zu roots, the worst %.2g px off\n", roots_seen, worst);
}

TEST(TruthLimit, TheOutlineOfABilinearBoxIsItsShadowsHexagon) {
  std::mt19937 random(kSeed + 1);
  const glm::dvec3 half(1.0, 0.7, 0.4);
  const Scene scene = scene_of({object_of(box_mesh(half), Scheme::bilinear)});
  for (int turn = 0; turn < 10; ++turn) {
    const Camera camera = random_camera(scene, random, Projection::orthographic);
    TruthSettings settings;
    settings.threshold = 0.0;
    const BorderTruth truth = solve_truth(scene, camera, settings, {});
    double expected = 0.0, length = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 along(0.0);
      along[axis] = 2.0 * half[axis];
      const glm::dvec3 a = project(camera, glm::dvec3(0.0)), b = project(camera, along);
      expected += 2.0 * glm::distance(glm::dvec2(a), glm::dvec2(b));
    }
    for (const BorderCurve& curve : truth.curves.curves) {
      EXPECT_EQ(curve.kind, CurveKind::silhouette);
      length += length_px(curve);
    }
    EXPECT_NEAR(length, expected, 0.05) << "view " << turn << " seed " << kSeed + 1;
    EXPECT_EQ(truth.contour_generators, 1);
    EXPECT_TRUE(truth.exact);
  }
}

/// The mesh's border is its own; only how far it may lie from the limit's is asked here.
TEST(TruthLimit, AFineMeshShowsTheSameBorder) {
  std::mt19937 random(kSeed + 2);
  std::vector<Cage> seen = cages(random);
  seen.push_back({"bowl", bowl(), Scheme::catmark});
  for (const Cage& cage : seen) {
    const Scene scene = scene_of({object_of(cage.mesh, cage.scheme)});
    const Camera camera = random_camera(scene, random, Projection::perspective);
    TruthSettings settings;
    settings.threshold = 0.4;
    const BorderTruth truth = solve_truth(scene, camera, settings, {});
    SurfaceSettings fine = surface_kind("mesh");
    fine.level = 6;
    const SceneModel model = build_model(scene, fine);
    const GBuffer gbuffer = render_gbuffer(model, camera, {});
    const BorderCurves measured = measure_border(model, camera, gbuffer, {}, {});
    const auto lines = [](const BorderCurves& border, CurveKind kind) {
      std::vector<Line> out;
      for (const BorderCurve& curve : border.curves) {
        if (curve.kind != kind) continue;
        for (size_t i = 0; i + 1 < curve.points.size(); ++i) out.push_back({curve.points[i].px, curve.points[i + 1].px});
        if (curve.closed) out.push_back({curve.points.back().px, curve.points.front().px});
      }
      return out;
    };
    for (const CurveKind kind : {CurveKind::silhouette, CurveKind::inner}) {
      const std::vector<Line> truth_lines = lines(truth.curves, kind), mesh_lines = lines(measured, kind);
      ASSERT_FALSE(truth_lines.empty()) << cage.name;
      const auto share_off = [](const std::vector<Line>& of, const std::vector<Line>& from) {
        double off = 0.0, all = 0.0;
        for (const Line& line : of) {
          const double length = glm::distance(line.a, line.b);
          all += length;
          if (distance_px(0.5 * (line.a + line.b), from) > 0.1) off += length;
        }
        return off / all;
      };
      // Ends of visible parts, where two curves run into each other, are less than a hundredth of all.
      EXPECT_LT(share_off(truth_lines, mesh_lines), 0.02) << cage.name << (kind == CurveKind::inner ? " inner" : " silhouette");
      EXPECT_LT(share_off(mesh_lines, truth_lines), 0.02) << cage.name << (kind == CurveKind::inner ? " inner" : " silhouette");
    }
    double ink = 0.0, shown = 0.0;
    for (const float share : truth.coverage.pixels) ink += double{share};
    for (size_t i = 0; i < gbuffer.n_dot_v.size(); ++i) shown += gbuffer.id.pixels[i] > 0 && gbuffer.n_dot_v.pixels[i] < 0.4f ? 1.0 : 0.0;
    EXPECT_NEAR(ink, shown, 0.02 * shown + 10.0) << cage.name;
  }
}

TEST(TruthLimit, TheSameForAnyNumberOfThreads) {
  std::mt19937 random(kSeed + 3);
  const Scene scene = scene_of({object_of(bumpy_torus(random), Scheme::catmark)});
  const Camera camera = random_camera(scene, random, Projection::perspective);
  ExecutionSettings one, three;
  one.threads = 1;
  three.threads = 3;
  const BorderTruth a = solve_truth(scene, camera, {}, one), b = solve_truth(scene, camera, {}, three);
  EXPECT_EQ(a.coverage.pixels, b.coverage.pixels);
  ASSERT_EQ(a.curves.curves.size(), b.curves.curves.size());
  for (size_t k = 0; k < a.curves.curves.size(); ++k) {
    ASSERT_EQ(a.curves.curves[k].points.size(), b.curves.curves[k].points.size());
    for (size_t i = 0; i < a.curves.curves[k].points.size(); ++i)
      EXPECT_EQ(a.curves.curves[k].points[i].px, b.curves.curves[k].points[i].px);
  }
}

/// The same numbers, to the last bit.
void expect_equal(const BorderTruth& a, const BorderTruth& b, const std::string& what) {
  EXPECT_EQ(a.coverage.pixels, b.coverage.pixels) << what;
  EXPECT_EQ(a.notes, b.notes) << what;
  EXPECT_EQ(a.from, b.from) << what;
  EXPECT_EQ(a.bound_px, b.bound_px) << what;
  ASSERT_EQ(a.curves.curves.size(), b.curves.curves.size()) << what;
  for (size_t k = 0; k < a.curves.curves.size(); ++k) {
    ASSERT_EQ(a.curves.curves[k].points.size(), b.curves.curves[k].points.size()) << what;
    for (size_t i = 0; i < a.curves.curves[k].points.size(); ++i)
      EXPECT_EQ(a.curves.curves[k].points[i].px, b.curves.curves[k].points[i].px) << what;
  }
}

// A comparison's reference is what its truths would make: cages of the same level onto their limit, meshes as they are.
TEST(TruthLimit, WithAModelThatIsThereAlreadyIsThatWithout) {
  std::mt19937 random(kSeed + 5);
  const Mesh torus = bumpy_torus(random);
  const Scene cage = scene_of({object_of(torus, Scheme::catmark)}), given = scene_of({object_of(torus)});
  for (const bool is_cage : {true, false}) {
    const Scene& scene = is_cage ? cage : given;
    const Camera camera = random_camera(scene, random, Projection::perspective);
    SurfaceSettings settings = surface_kind("mesh");
    if (is_cage) settings.normals = NormalKind::limit, settings.level = proxy_level(scene, camera, 1.5);
    const SceneModel model = build_model(scene, settings);
    for (const TruthReference reference : {TruthReference::given, TruthReference::smooth}) {
      TruthCache cache;
      offer_model(scene, settings, model, cache);
      ASSERT_NE(cache.proxy, nullptr);
      const BorderTruth with = solve_truth(scene, camera, {.reference = reference, .cache = &cache}, {});
      EXPECT_EQ(cache.proxy->model.surfaces.front().state, model.surfaces.front().state) << "made again";
      expect_equal(with, solve_truth(scene, camera, {.reference = reference}, {}), is_cage ? "cage" : "mesh");
    }
    // What a truth would not make is not taken.
    SurfaceSettings other = settings;
    other.normals = is_cage ? NormalKind::vertex : NormalKind::flat;
    TruthCache none;
    offer_model(scene, other, model, none);
    offer_model(scene, surface_kind("mesh_level_set"), model, none);
    if (is_cage) offer_model(given, settings, model, none);
    EXPECT_EQ(none.proxy, nullptr);
  }
}

TEST(TruthLimit, OfSeveralViewsOfOneSceneIsThatOfEachAlone) {
  std::mt19937 random(kSeed + 4);
  const Scene scene = scene_of({object_of(bumpy_torus(random), Scheme::catmark)});
  TruthCache cache;
  std::set<std::shared_ptr<const void>> models;  // held, so that no address comes twice
  const int widths[] = {320, 320, 60, 320};      // a small picture's proxy is coarser
  for (const int width : widths) {
    const Camera camera = random_camera(scene, random, Projection::perspective, width, 3 * width / 4);
    const BorderTruth shared = solve_truth(scene, camera, {.cache = &cache}, {}), alone = solve_truth(scene, camera, {}, {});
    ASSERT_NE(cache.proxy, nullptr);
    EXPECT_EQ(cache.proxy->level, proxy_level(scene, camera, 1.5)) << width;
    models.insert(cache.proxy->model.surfaces.front().state);
    expect_equal(shared, alone, std::to_string(width));
  }
  // The second view took the first one's; what the third had is too coarse for the fourth.
  EXPECT_EQ(models.size(), 3u);
}

}  // namespace
}  // namespace limn
