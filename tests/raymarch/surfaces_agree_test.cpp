// The four surfaces of one shape in the same picture: they differ by what their resolution predicts, and by no more.

#include <fmt/core.h>

#include "raymarch/metric.h"
#include "raymarch/surface/object_mesh.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

/// An ellipsoid off every lattice point, so that no symmetry makes errors cancel.
const glm::dvec3 kRadii(1.0, 0.7, 0.5);
const glm::dvec3 kCenter(0.0137, -0.0071, 0.0211);
// Largest principal curvature: the largest ratio of a radius to the square of another.
const double kCurvature = kRadii.x / (kRadii.z * kRadii.z);

Field jittered_ellipsoid() {
  const Field field = make_shape("ellipsoid", {{"radii", {kRadii.x, kRadii.y, kRadii.z}}});
  return translate(rotate(field, {0.3, 0.5, -0.8}, 0.7), kCenter);
}

/// A representation and the lengths of its resolution in world units.
struct Modelled {
  SceneModel model;
  double voxel = 0.0;  ///< 0 without a grid.
  double edge = 0.0;   ///< Longest edge of a triangle; 0 without a mesh.
};

Modelled modelled(const Scene& scene, const SurfaceSettings& settings) {
  Modelled result{build_model(scene, settings), 0.0, 0.0};
  result.voxel = total(result.model).voxel_size;
  if (total(result.model).triangles == 0) return result;
  const TriangleMesh mesh = *object_mesh(scene.objects[0], settings, glm::dvec3(0.0)).triangles;
  for (const glm::uvec3& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      result.edge = std::max(result.edge, glm::length(mesh.positions[triangle[i]] - mesh.positions[triangle[(i + 1) % 3]]));
    }
  }
  return result;
}

struct Difference {
  Errors distance;  ///< Of the hit from the true surface, world.
  Errors normal;    ///< Radians.
  int far_silhouette = 0;
  int silhouette = 0;
};

/// Distance to the ellipsoid to second order, from the field's value and gradient.
double distance_to(FieldEvaluator& evaluator, const glm::dvec3& point) {
  const FieldJet jet = evaluator.jet(point);
  return std::abs(jet.value) / glm::length(jet.gradient);
}

bool near_silhouette(const GBuffer& reference, int x, int y) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (reference.id.inside(x + dx, y + dy) && reference.id.at(x + dx, y + dy) != reference.id.at(x, y)) return true;
    }
  }
  return false;
}

Difference compare(const GBuffer& seen, const GBuffer& reference, const Field& field) {
  Difference difference;
  FieldEvaluator evaluator(field);
  for (int y = 0; y < seen.height; ++y) {
    for (int x = 0; x < seen.width; ++x) {
      const size_t i = seen.id.index(x, y);
      if (seen.id.pixels[i] != reference.id.pixels[i]) {
        ++difference.silhouette;
        difference.far_silhouette += !near_silhouette(reference, x, y);
        continue;
      }
      if (seen.id.pixels[i] == 0) continue;
      difference.distance.add(distance_to(evaluator, glm::dvec3(seen.position.pixels[i])));
      // Against the truth where this surface was hit: the angle is the normal's own, not the displacement's.
      difference.normal.add(angle_between(glm::dvec3(seen.normal.pixels[i]), evaluator.jet(glm::dvec3(seen.position.pixels[i])).gradient));
    }
  }
  return difference;
}

/// A kind at two resolutions, the second of half the lengths.
struct Expectation {
  std::string kind;
  int voxels, level;
  double normal_order;
};

SurfaceSettings settings_of(const Expectation& expected, bool fine) {
  SurfaceSettings settings = surface_kind(expected.kind);
  settings.voxels = expected.voxels * (fine ? 2 : 1);
  settings.level = expected.level + (fine ? 1 : 0);
  return settings;
}

/// What the resolution predicts for the worst pixel.
struct Prediction {
  double distance = 0.0, normal = 0.0;
};

Prediction predicted(const Modelled& surface) {
  const double k = kCurvature, h = surface.voxel, e = surface.edge;
  Prediction prediction;
  // Trilinear interpolation is off by k h^2 / 8 along each of three axes; the middle of a triangle of edge e lies k e^2 / 6 below the
  // sphere through its corners.
  prediction.distance = 3.0 / 8.0 * k * h * h + k * e * e / 6.0;
  // Central differences: 2.3e-3 at h = 0.1 on the unit sphere and of order 2, so 0.23 (k h)^2; twice that for a curvature that varies.
  prediction.normal = 2.0 * 0.23 * k * h * k * h;
  // Interpolated limit normals: e^2 / 8 times their second derivative. A level set of a mesh has the facets' own normals instead, which
  // are off by half the angle between the ends of an edge.
  prediction.normal += h > 0.0 ? 0.5 * k * e : k * e * k * e / 8.0;
  return prediction;
}

TEST(SurfacesAgree, ToTheErrorThatTheirResolutionPredicts) {
  const Field field = jittered_ellipsoid();
  const Scene scene = scene_of({object_of(field)});
  const Camera camera = framing(scene, view(240, 180));
  const GBuffer reference = render_gbuffer(model_of(scene), camera, {});
  for (const Expectation& expected : {Expectation{"level_set", 48, 0, 2.0}, {"mesh", 0, 2, 2.0}, {"mesh_level_set", 96, 3, 1.0}}) {
    Difference measured[2];
    for (const bool fine : {false, true}) {
      const Modelled surface = modelled(scene, settings_of(expected, fine));
      Difference& difference = measured[fine];
      difference = compare(render_gbuffer(surface.model, camera, {}), reference, field);
      const Prediction prediction = predicted(surface);
      fmt::print(
          "{:14} voxel {:.4f} edge {:.4f}: distance mean {:.1e} worst {:.1e} (predicted {:.1e}); normal mean {:.1e} worst {:.1e} "
          "(predicted {:.1e}) rad; silhouette {} px differ, {} beyond one pixel\n",
          expected.kind, surface.voxel, surface.edge, difference.distance.mean(), difference.distance.largest, prediction.distance,
          difference.normal.mean(), difference.normal.largest, prediction.normal, difference.silhouette, difference.far_silhouette);
      EXPECT_GT(difference.distance.count, 5000);
      EXPECT_LT(difference.distance.largest, prediction.distance) << expected.kind;
      EXPECT_LT(difference.normal.largest, prediction.normal) << expected.kind;
      EXPECT_EQ(difference.far_silhouette, 0) << expected.kind;
    }
    // Half the length: the error falls with its order, with room for where the pixels happen to fall.
    EXPECT_LT(measured[1].distance.mean(), measured[0].distance.mean() / std::pow(2.0, 2.0 - 0.4)) << expected.kind;
    EXPECT_LT(measured[1].normal.mean(), measured[0].normal.mean() / std::pow(2.0, expected.normal_order - 0.4)) << expected.kind;
  }
}

TEST(SurfacesAgree, InTheirBordersToo) {
  const Scene scene = scene_of({object_of(jittered_ellipsoid())});
  const Camera camera = framing(scene, view(320, 240));
  const auto draw = [&](const std::string& kind) {
    SurfaceSettings settings = surface_kind(kind);
    settings.voxels = 128;
    settings.level = 4;
    return draw_picture(scene, build_model(scene, settings), camera, {{call_of("rim")}, 1, {}}, {});
  };
  const Picture reference = draw("analytic");
  for (const std::string kind : {"level_set", "mesh", "mesh_level_set"}) {
    const Picture picture = draw(kind);
    for (const MetricValue& value : find_metric("overlap").measure({picture, reference, camera})) {
      fmt::print("{}: intersection over union of the border {:.4f}\n", kind, value.value);
      // A normal off by eps moves the border by s c eps / kr (THEORY): below 0.1 px here, so only pixels on the line may differ.
      EXPECT_GT(value.value, 0.98) << kind;
    }
  }
}

}  // namespace
}  // namespace limn::test
