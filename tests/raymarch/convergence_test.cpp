// The orders at which normals and borders of models approach those of the surface, on an ellipsoid and a torus whose meshes are jittered:
// on regular meshes symmetry hides the first order (and on spheres every error) of averaged normals.

#include <fmt/core.h>

#include <map>
#include <numbers>

#include "raymarch/truth.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

constexpr unsigned kSeed = 7411;
constexpr double kThreshold = 0.4;
constexpr double kPi = std::numbers::pi;

struct Known {
  std::string name;
  Field field;
  Mesh (*mesh)(int n, std::mt19937& random);
  glm::dvec3 (*normal)(glm::dvec3 p);
};

const glm::dvec3 kRadii(1.0, 0.7, 0.5);
constexpr double kMajor = 1.0, kMinor = 0.4;

/// Of the surface's point next to p: a model's hits lie off the surface by the second order, where the quadric's gradient turns as much.
glm::dvec3 ellipsoid_normal(glm::dvec3 p) {
  for (int step = 0; step < 2; ++step) {
    const glm::dvec3 gradient = 2.0 * p / (kRadii * kRadii);
    p -= (glm::dot(p / kRadii, p / kRadii) - 1.0) / glm::dot(gradient, gradient) * gradient;
  }
  return glm::normalize(p / (kRadii * kRadii));
}
glm::dvec3 torus_normal(glm::dvec3 p) { return glm::normalize(p - kMajor * glm::normalize(glm::dvec3(p.x, 0.0, p.z))); }

/// Two triangles from a quad, cut along either diagonal at random.
void add_quad(Mesh& mesh, const std::array<int, 4>& q, std::mt19937& random) {
  const std::array<int, 6> one{q[0], q[1], q[2], q[0], q[2], q[3]}, two{q[0], q[1], q[3], q[1], q[2], q[3]};
  for (const int corner : random() % 2 ? one : two) mesh.corner_vertices.push_back(corner);
  mesh.face_sizes.insert(mesh.face_sizes.end(), {3, 3});
}

void add_exact_normals(Mesh& mesh, glm::dvec3 (*normal)(glm::dvec3)) {
  for (const std::int32_t v : mesh.corner_vertices) mesh.corner_normals.emplace_back(normal(mesh.positions[static_cast<size_t>(v)]));
}

/// A cube's lattice of n by n quads a face, every point moved by up to a quarter of a step each way, thrown onto the ellipsoid.
Mesh jittered_ellipsoid(int n, std::mt19937& random) {
  std::uniform_real_distribution<double> jitter(-0.25, 0.25);
  Mesh mesh;
  std::map<std::array<int, 3>, int> vertices;
  const auto vertex = [&](const glm::ivec3& at) {
    const auto [entry, added] = vertices.try_emplace({at.x, at.y, at.z}, static_cast<int>(mesh.positions.size()));
    if (added) {
      // Along the cube's face or edge only: a move off it would squeeze the neighbours into slivers, whose normals do not converge.
      glm::dvec3 moved(at);
      for (int axis = 0; axis < 3; ++axis) moved[axis] += at[axis] % n == 0 ? 0.0 : jitter(random);
      const glm::dvec3 cube = 2.0 * moved / double(n) - 1.0;
      mesh.positions.push_back(kRadii * glm::normalize(glm::tan(cube * (kPi / 4.0))));
    }
    return entry->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, n}) {
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const auto at = [&](int a, int b) {
            glm::ivec3 p;
            p[axis] = side;
            p[(axis + 1) % 3] = a;
            p[(axis + 2) % 3] = b;
            return vertex(p);
          };
          std::array<int, 4> q{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
          if (side == 0) std::swap(q[1], q[3]);
          add_quad(mesh, q, random);
        }
      }
    }
  }
  add_exact_normals(mesh, ellipsoid_normal);
  return mesh;
}

Mesh jittered_torus(int n, std::mt19937& random) {
  std::uniform_real_distribution<double> jitter(-0.25, 0.25);
  const int around = 3 * n, tube = 2 * n;
  Mesh mesh;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < tube; ++j) {
      const double a = 2.0 * kPi * (i + jitter(random)) / around, b = 2.0 * kPi * (j + jitter(random)) / tube;
      const double r = kMajor + kMinor * std::cos(b);
      mesh.positions.emplace_back(r * std::cos(a), kMinor * std::sin(b), r * std::sin(a));
    }
  }
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < tube; ++j) {
      const auto at = [&](int x, int y) { return (x % around) * tube + y % tube; };
      add_quad(mesh, {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)}, random);
    }
  }
  add_exact_normals(mesh, torus_normal);
  return mesh;
}

std::vector<Known> known_surfaces() {
  return {{"ellipsoid", make_shape("ellipsoid", {{"radii", {kRadii.x, kRadii.y, kRadii.z}}}), jittered_ellipsoid, ellipsoid_normal},
          {"torus", make_shape("torus", {{"major", {kMajor}}, {"minor", {kMinor}}}), jittered_torus, torus_normal}};
}

struct Errors {
  double normal_rms = 0.0;  ///< Radians, over the pixels.
  double border_rms = 0.0;  ///< px, over the true inner border.
};

double normal_rms(const GBuffer& gbuffer, const Known& known) {
  double squares = 0.0, count = 0.0;
  for (size_t i = 0; i < gbuffer.id.size(); ++i) {
    if (gbuffer.id.pixels[i] == 0) continue;
    const glm::dvec3 truth = known.normal(glm::dvec3(gbuffer.position.pixels[i])), found(gbuffer.normal.pixels[i]);
    const double angle = std::atan2(glm::length(glm::cross(truth, found)), glm::dot(truth, found));
    squares += angle * angle;
    count += 1.0;
  }
  return std::sqrt(squares / count);
}

/// Where along the outward normal of a point of the true border the model's own N.V crosses the threshold: by rays alone, the crossing
/// nearest to the truth among a fan of places, then bisected.
double displacement(const SceneModel& model, const Camera& camera, const glm::dvec2& at, const glm::dvec2& outward, double reach_px) {
  constexpr int kPlaces = 24;
  std::vector<glm::dvec2> places;
  for (int k = -kPlaces; k <= kPlaces; ++k) places.push_back(at + outward * (reach_px * k / kPlaces));
  std::vector<PointSample> samples(places.size());
  sample_points(model, camera, places, samples);
  const auto is_ink = [](const PointSample& s) { return s.status == HitStatus::hit && s.n_dot_v < float(kThreshold); };
  double best = std::numeric_limits<double>::quiet_NaN();
  for (int k = -kPlaces; k < kPlaces; ++k) {
    const auto i = static_cast<size_t>(k + kPlaces);
    if (!is_ink(samples[i]) || is_ink(samples[i + 1]) || samples[i + 1].status != HitStatus::hit) continue;
    double low = reach_px * k / kPlaces, high = reach_px * (k + 1) / kPlaces;
    for (int step = 0; step < 12; ++step) {
      const glm::dvec2 middle = at + outward * (0.5 * (low + high));
      PointSample s;
      sample_points(model, camera, std::span(&middle, 1), std::span(&s, 1));
      (is_ink(s) ? low : high) = 0.5 * (low + high);
    }
    if (!(std::abs(best) <= std::abs(0.5 * (low + high)))) best = 0.5 * (low + high);
  }
  return best;
}

double border_rms(const SceneModel& model, const Camera& camera, const BorderTruth& truth, double reach_px) {
  double squares = 0.0, count = 0.0;
  for (const BorderCurve& curve : truth.curves.curves) {
    if (curve.kind != CurveKind::inner) continue;
    for (size_t i = 0; i + 1 < curve.points.size(); ++i) {
      const glm::dvec2 step = curve.points[i + 1].px - curve.points[i].px;
      if (glm::length(step) < 1e-6) continue;
      const double off = displacement(model, camera, 0.5 * (curve.points[i].px + curve.points[i + 1].px),
                                      glm::normalize(glm::dvec2(-step.y, step.x)), reach_px);
      if (!std::isfinite(off)) continue;
      squares += off * off;
      count += 1.0;
    }
  }
  EXPECT_GT(count, 100.0);
  return std::sqrt(squares / count);
}

/// A way to model, and the orders that theory gives it.
struct Way {
  std::string name;
  SurfaceSettings settings;
  std::vector<int> resolutions;
  double low, high;             ///< Order of the normal.
  double position_order = 2.0;  ///< Of the hit.
  int width = 480;              ///< Of the pictures, px: so large that the errors stand out from the truth's own bound.
};

std::vector<Way> ways() {
  std::vector<Way> out;
  const auto mesh = [&](const char* name, NormalKind normals, double low, double high) {
    SurfaceSettings settings = surface_kind("mesh");
    settings.normals = normals;
    out.push_back({name, settings, {10, 20, 40, 80}, low, high});
  };
  const auto grid = [&](const char* gradient, std::vector<int> voxels, double low, double high, double position_order, int width = 480) {
    SurfaceSettings settings = surface_kind("level_set");
    settings.gradient = gradient;
    out.push_back({gradient, settings, std::move(voxels), low, high, position_order, width});
  };
  mesh("flat", NormalKind::flat, 0.85, 1.15);
  mesh("vertex", NormalKind::vertex, 0.85, 2.15);
  mesh("limit", NormalKind::limit, 1.8, 2.3);
  grid("cell", {20, 40, 80, 160}, 0.85, 1.15, 2.0);
  grid("central", {20, 40, 80, 160}, 1.8, 2.3, 2.0);
  // Where the band is thinner than the sharpest bend is round: four voxels against a radius of 0.25.
  grid("cubic", {48, 64, 88, 120}, 2.7, 4.2, 2.0, 2400);
  return out;
}

Errors errors_of(const Known& known, const Way& way, int resolution, std::mt19937& random) {
  SurfaceSettings settings = way.settings;
  const bool mesh = settings.kind == "mesh";
  settings.voxels = resolution;
  const Scene field_scene = scene_of({object_of(known.field)});
  const SceneModel model = build_model(mesh ? scene_of({object_of(known.mesh(resolution, random))}) : field_scene, settings);
  Errors errors;
  int views = 0;
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    CameraSettings looking = view(way.width, way.width * 3 / 4, projection);
    looking.direction = projection == Projection::perspective ? glm::dvec3(1.9, 2.3, 2.9) : glm::dvec3(-1.3, 2.6, 1.1);
    const Camera camera = framing(field_scene, looking);
    static std::map<std::tuple<std::string, Projection, int>, BorderTruth> truths;
    const auto [truth, added] = truths.try_emplace({known.name, projection, way.width});
    if (added) truth->second = solve_truth(field_scene, camera, {.threshold = kThreshold}, {});
    errors.normal_rms += normal_rms(render_gbuffer(model, camera, {}), known);
    errors.border_rms += border_rms(model, camera, truth->second, 12.0);
    ++views;
  }
  return {errors.normal_rms / views, errors.border_rms / views};
}

/// Slope of log error over log size, by least squares.
double order_of(const std::vector<int>& resolutions, const std::vector<double>& errors) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto n = static_cast<double>(errors.size());
  for (size_t k = 0; k < errors.size(); ++k) {
    const double x = -std::log(double(resolutions[k])), y = std::log(errors[k]);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

TEST(Convergence, NormalsAndBordersHaveTheOrdersOfTheory) {
  RecordProperty("seed", static_cast<int>(kSeed));
  for (const Known& known : known_surfaces()) {
    for (const Way& way : ways()) {
      std::mt19937 random(kSeed);
      std::vector<double> normals, borders;
      for (const int resolution : way.resolutions) {
        const Errors errors = errors_of(known, way, resolution, random);
        normals.push_back(errors.normal_rms);
        borders.push_back(errors.border_rms);
      }
      const double normal_order = order_of(way.resolutions, normals), border_order = order_of(way.resolutions, borders);
      fmt::print("{:9} {:8} normal {:.1e} .. {:.1e} rad, order {:.2f}; border {:.2g} .. {:.2g} px, order {:.2f}\n", known.name, way.name,
                 normals.front(), normals.back(), normal_order, borders.front(), borders.back(), border_order);
      EXPECT_GE(normal_order, way.low) << known.name << " " << way.name << " seed " << kSeed;
      EXPECT_LE(normal_order, way.high) << known.name << " " << way.name << " seed " << kSeed;
      // The border inherits the smaller of the normal's order and the position's.
      EXPECT_NEAR(border_order, std::min(normal_order, way.position_order), 0.35) << known.name << " " << way.name << " seed " << kSeed;
    }
  }
}

}  // namespace
}  // namespace limn::test
