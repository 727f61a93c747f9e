// Curvature of every surface against closed forms, and how fast it comes near them.

#include "raymarch/scene/curvature.h"

#include <fmt/core.h>

#include <cmath>

#include "subdiv/tessellate.h"
#include "tests/raymarch/scenes.h"
#include "tests/subdiv/test_meshes.h"

namespace limn::test {
namespace {

struct Principal {
  double k1, k2;
};

struct KnownSurface {
  std::string name;
  Field field;
  Principal (*at)(const glm::dvec3& p);
  double size;  ///< Of 1 / curvature, for relative errors.
};

const glm::dvec3 kRadii(1.0, 0.7, 0.5);

/// From Gauss and mean curvature (do Carmo 1976): not by way of any Hessian.
Principal of_ellipsoid(const glm::dvec3& p) {
  const glm::dvec3 s = kRadii * kRadii;
  const double q = glm::dot(p / s, p / s), product = s.x * s.y * s.z;
  const double gauss = 1.0 / (product * q * q), mean = (s.x + s.y + s.z - glm::dot(p, p)) / (2.0 * product * q * std::sqrt(q));
  const double spread = std::sqrt(std::max(0.0, mean * mean - gauss));
  return {mean + spread, mean - spread};
}

Principal of_torus(const glm::dvec3& p) {
  const double ring = std::hypot(p.x, p.z);
  return {1.0 / 0.3, (ring - 0.8) / (0.3 * ring)};
}

std::vector<KnownSurface> known_surfaces() {
  return {{"sphere", make_shape("sphere", {{"radius", {0.8}}}),
           [](const glm::dvec3&) {
             return Principal{1.25, 1.25};
           },
           0.8},
          {"ellipsoid", make_shape("ellipsoid", {{"radii", {kRadii.x, kRadii.y, kRadii.z}}}), of_ellipsoid, 0.5},
          {"torus", make_shape("torus", {{"major", {0.8}}, {"minor", {0.3}}}), of_torus, 0.3},
          {"cylinder", make_shape("cylinder", {{"radius", {0.7}}, {"half_height", {1.5}}}),
           [](const glm::dvec3&) {
             return Principal{1.0 / 0.7, 0.0};
           },
           0.7}};
}

struct Seen {
  std::vector<SurfacePoint> points;
  std::vector<SurfaceCurvature> curvatures;
};

/// Curvatures at what a picture from `eye` shows; `render_origin` is the world's (the scenes are centred).
Seen seen_from(const Scene& scene, const SurfaceSettings& settings, const glm::dvec3& eye, int size_px = 80) {
  const SceneModel model = build_model(scene, settings);
  CameraSettings camera = view(size_px, size_px);
  camera.eye = eye;
  camera.target = glm::dvec3(0.0);
  const GBuffer gbuffer = render_gbuffer(model, framing(scene, camera), {});
  Seen seen;
  for (size_t i = 0; i < gbuffer.id.size(); ++i) {
    if (gbuffer.id.pixels[i] == 0) continue;
    seen.points.push_back(
        {glm::dvec3(gbuffer.position.pixels[i]) - model.render_origin, glm::dvec3(gbuffer.normal.pixels[i]), gbuffer.face.pixels[i]});
  }
  seen.curvatures.resize(seen.points.size());
  const CurvatureSource& source = model.surfaces[0].curvature;
  EXPECT_NE(source.evaluate, nullptr) << source.from;
  if (source.evaluate) source.evaluate(source.state.get(), seen.points, seen.curvatures);
  for (SurfacePoint& point : seen.points) point.position += model.render_origin;
  return seen;
}

Errors errors_of(const Seen& seen, const KnownSurface& known) {
  Errors errors;
  for (size_t i = 0; i < seen.points.size(); ++i) {
    const glm::dvec3& p = seen.points[i].position;
    if (known.name == "cylinder" && std::abs(p.y) > 1.2) continue;  // the rim, and what reads over it
    const Principal expected = known.at(p);
    const SurfaceCurvature& got = seen.curvatures[i];
    errors.add(known.size * std::max(std::abs(got.k1 - expected.k1), std::abs(got.k2 - expected.k2)));
  }
  return errors;
}

TEST(Curvature, OfAFieldIsItsClosedForm) {
  for (const KnownSurface& known : known_surfaces()) {
    const Seen seen = seen_from(scene_of({object_of(known.field)}), surface_kind("analytic"), {1.9, 2.3, 2.9});
    const Errors errors = errors_of(seen, known);
    fmt::print("{}: {:.2g} at most over {} points\n", known.name, errors.largest, errors.count);
    EXPECT_GT(errors.count, 500);
    EXPECT_LT(errors.largest, 1e-5) << known.name;
  }
}

struct Order {
  std::string kind;
  std::array<int, 2> resolutions;  ///< The second twice as fine as the first.
  double order, largest;
};

/// The order that halving the mesh or voxel size shows, by the mean error; and the worst place at the finer one.
testing::AssertionResult has_order(const Order& expected, const KnownSurface& known, const std::function<Scene(int)>& scene) {
  std::array<Errors, 2> errors;
  for (size_t k = 0; k < 2; ++k) {
    SurfaceSettings settings = surface_kind(expected.kind);
    settings.voxels = settings.level = expected.resolutions[k];
    settings.half_width_voxels = expected.kind == "mesh" ? 0.0 : 4.2;
    errors[k] = errors_of(seen_from(scene(expected.resolutions[k]), settings, {1.9, 2.3, 2.9}), known);
  }
  const double order = std::log2(errors[0].mean() / errors[1].mean());
  const std::string figures = fmt::format("{} {}: mean {:.2g}, {:.2g}: order {:.2f}; largest {:.2g}", expected.kind, known.name,
                                          errors[0].mean(), errors[1].mean(), order, errors[1].largest);
  fmt::print("{}\n", figures);
  if (!(order > expected.order - 0.4))
    return testing::AssertionFailure() << figures << "; the order " << order << " should be above " << expected.order - 0.4;
  if (!(errors[1].largest < expected.largest))
    return testing::AssertionFailure() << figures << "; the largest " << errors[1].largest << " should be below " << expected.largest;
  return testing::AssertionSuccess();
}

TEST(Curvature, OfALevelSetIsOfSecondOrder) {
  for (const KnownSurface& known : known_surfaces()) {
    if (known.name == "cylinder") continue;  // its caps' edge lies in every voxel block about the sides of a coarse grid
    EXPECT_TRUE(has_order({"level_set", {32, 64}, 2.0, 0.05}, known, [&](int) { return scene_of({object_of(known.field)}); }));
  }
}

TEST(Curvature, OfATessellatedFieldIsOfSecondOrder) {
  for (const KnownSurface& known : known_surfaces()) {
    if (known.name == "cylinder") continue;
    EXPECT_TRUE(has_order({"mesh", {2, 3}, 2.0, 0.05}, known, [&](int) { return scene_of({object_of(known.field)}); }));
  }
}

/// A mesh that nobody knows more of than its vertices and their normals, moved off every symmetry by uneven sampling.
TEST(Curvature, OfARawMeshWithGoodNormalsConverges) {
  for (const KnownSurface& known : known_surfaces()) {
    if (known.name == "cylinder") continue;
    EXPECT_TRUE(has_order({"mesh", {2, 3}, 1.4, 0.35}, known,
                          [&](int level) { return scene_of({object_of(tessellate(known.field, {.level = level}))}); }));
  }
}

/// A tube of `n` columns of quads about the y axis: its limit's section is the uniform cubic B-spline of a regular n-gon.
Mesh tube(int n, int rings) {
  Mesh mesh;
  for (int j = 0; j < rings; ++j) {
    for (int i = 0; i < n; ++i) {
      const double angle = 2.0 * 3.14159265358979323846 * i / n;
      mesh.positions.emplace_back(std::cos(angle), 0.5 * (j - 0.5 * (rings - 1)), std::sin(angle));
    }
  }
  for (int j = 0; j + 1 < rings; ++j) {
    for (int i = 0; i < n; ++i) {
      const int next = (i + 1) % n;
      mesh.corner_vertices.insert(mesh.corner_vertices.end(), {j * n + i, (j + 1) * n + i, (j + 1) * n + next, j * n + next});
      mesh.face_sizes.push_back(4);
    }
  }
  return mesh;
}

/// Curvature of that B-spline at the polar angle `angle`, n columns.
double spline_curvature(int n, double angle) {
  const double sector = 2.0 * 3.14159265358979323846 / n;
  const double first = std::floor(angle / sector), within = angle - first * sector;
  const auto at = [&](double t, int derivative) {
    const double u = 1.0 - t;
    const std::array<double, 4> weights =
        derivative == 0
            ? std::array<double, 4>{u * u * u / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * u * u * u - 6 * u * u + 4) / 6, t * t * t / 6}
        : derivative == 1 ? std::array<double, 4>{-u * u / 2, (3 * t * t - 4 * t) / 2, -(3 * u * u - 4 * u) / 2, t * t / 2}
                          : std::array<double, 4>{u, 3 * t - 2, 3 * u - 2, t};
    glm::dvec2 sum(0.0);
    for (int i = 0; i < 4; ++i) sum += weights[static_cast<size_t>(i)] * glm::dvec2(std::cos((i - 1) * sector), std::sin((i - 1) * sector));
    return sum;
  };
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const glm::dvec2 p = at(0.5 * (low + high), 0);
    (std::atan2(p.y, p.x) < within ? low : high) = 0.5 * (low + high);
  }
  const glm::dvec2 d = at(low, 1), dd = at(low, 2);
  return (d.x * dd.y - d.y * dd.x) / std::pow(glm::length(d), 3);
}

TEST(Curvature, OfACageIsThatOfItsLimitSurface) {
  for (const double mirror : {1.0, -1.0}) {
    std::array<Errors, 2> errors;
    for (const int level : {2, 3}) {
      Scene scene = scene_of({object_of(tube(6, 8), Scheme::catmark)});
      scene.objects[0].world_from_object.linear = glm::dmat3(mirror, 0, 0, 0, 1, 0, 0, 0, 1);
      SurfaceSettings settings = surface_kind("mesh");
      settings.level = level;
      const Seen seen = seen_from(scene, settings, {3.0, 0.3, 1.0});
      for (size_t i = 0; i < seen.points.size(); ++i) {
        const glm::dvec3& p = seen.points[i].position;
        if (std::abs(p.y) > 0.9 || glm::dot(seen.points[i].normal, glm::dvec3(p.x, 0, p.z)) < 0.0) continue;
        double angle = std::atan2(p.z, mirror * p.x);
        if (angle < 0.0) angle += 2.0 * 3.14159265358979323846;
        errors[static_cast<size_t>(level - 2)].add(
            std::max(std::abs(seen.curvatures[i].k1 - spline_curvature(6, angle)), std::abs(seen.curvatures[i].k2)));
      }
    }
    const double order = std::log2(errors[0].mean() / errors[1].mean());
    fmt::print("tube: {} points, mean {:.2g}, {:.2g}: order {:.2f}; largest {:.2g}\n", errors[1].count, errors[0].mean(), errors[1].mean(),
               order, errors[1].largest);
    EXPECT_GT(errors[1].count, 500);
    EXPECT_GT(order, 1.6);
    EXPECT_LT(errors[1].largest, 0.02);
  }
}

/// All schemes and face sizes: what the limit's derivatives say at a hit must be what the differences of the refined normals say, away
/// from the cage's own vertices.
TEST(Curvature, OfACageAgreesWithTheDifferencesOfItsNormals) {
  struct Case {
    std::string name;
    Mesh cage;
    Scheme scheme;
  };
  for (const Case& c : {Case{"cube", cube(), Scheme::catmark}, Case{"octahedron by quads", octahedron(), Scheme::catmark},
                        Case{"octahedron by triangles", octahedron(), Scheme::loop}, Case{"prism", prism(5), Scheme::catmark}}) {
    for (const double mirror : {1.0, -1.0}) {
      Scene scene = scene_of({object_of(c.cage, c.scheme)});
      scene.objects[0].world_from_object.linear = glm::dmat3(1.2 * mirror, 0, 0, 0, 0.8, 0, 0, 0.3, 1);
      SurfaceSettings settings = surface_kind("mesh");
      settings.level = 4;
      const Seen limit = seen_from(scene, settings, {1.9, 2.3, 2.9});
      // The same mesh without its cage.
      Mesh refined = refine(c.cage, {.scheme = c.scheme, .level = 4});
      Scene raw = scene_of({object_of(refined)});
      raw.objects[0].world_from_object = scene.objects[0].world_from_object;
      const Seen differences = seen_from(raw, settings, {1.9, 2.3, 2.9});
      ASSERT_EQ(limit.points.size(), differences.points.size());
      std::vector<double> errors;
      double scale = 0.0;
      for (size_t i = 0; i < limit.points.size(); ++i) {
        errors.push_back(std::max(std::abs(limit.curvatures[i].k1 - differences.curvatures[i].k1),
                                  std::abs(limit.curvatures[i].k2 - differences.curvatures[i].k2)));
        scale += std::abs(limit.curvatures[i].k1) / static_cast<double>(limit.points.size());
      }
      std::sort(errors.begin(), errors.end());
      const double median = errors[errors.size() / 2] / scale, ninety = errors[errors.size() * 9 / 10] / scale;
      fmt::print("{}: median difference {:.2g}, nine tenths below {:.2g} of the mean curvature\n", c.name, median, ninety);
      EXPECT_LT(median, 0.02) << c.name;
      EXPECT_LT(ninety, 0.12) << c.name;
    }
  }
}

TEST(Curvature, IsMissingWithAReasonWhereNothingIsKnown) {
  SurfaceSettings settings = surface_kind("level_set");
  settings.voxels = 24;
  const Scene scene = scene_of({object_of(make_shape("sphere"))});
  const CurvatureSource thin = build_model(scene, settings).surfaces[0].curvature;
  EXPECT_EQ(thin.evaluate, nullptr);
  EXPECT_NE(thin.from.find("too thin"), std::string::npos) << thin.from;
  settings = surface_kind("mesh");
  settings.normals = NormalKind::flat;
  const CurvatureSource flat = build_model(scene_of({object_of(box_mesh({1, 1, 1}))}), settings).surfaces[0].curvature;
  EXPECT_EQ(flat.evaluate, nullptr);
  EXPECT_NE(flat.from.find("flat"), std::string::npos) << flat.from;
}

TEST(Curvature, OfTheOtherSideHasTheOtherSign) {
  FieldJet saddle;  // z = x^2 - y^2 / 2 near 0
  saddle.gradient = {0, 0, 1};
  saddle.hessian[0][0] = -2.0;
  saddle.hessian[1][1] = 1.0;
  const SurfaceCurvature front = curvature_of_jet(saddle), back = facing(front, {0, 0, -1});
  EXPECT_NEAR(front.k1, 1.0, 1e-14);
  EXPECT_NEAR(front.k2, -2.0, 1e-14);
  EXPECT_NEAR(back.k1, 2.0, 1e-14);
  EXPECT_NEAR(std::abs(back.direction1.x), 1.0, 1e-14);
  for (const glm::dvec3& direction : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(1, 2, 0)}) {
    EXPECT_NEAR(curvature_along(front, direction), -curvature_along(back, direction), 1e-14);
  }
  EXPECT_TRUE(std::isnan(curvature_of_jet(FieldJet{}).k1));
}

}  // namespace
}  // namespace limn::test
