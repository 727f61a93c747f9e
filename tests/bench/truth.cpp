#include "tests/bench/truth.h"

#include <algorithm>
#include <cmath>

#include "raymarch/surface.h"
#include "sdf/quantile.h"
#include "subdiv/mesh_level_set.h"

namespace limn::bench {
namespace {

/// The least of a 1-Lipschitz distance along a ray, by steps that it allows and by thirds about the best.
template <class Distance>
Lowest search_lowest(const Distance& distance, double from, double to, double finest) {
  Lowest best;
  const auto look = [&](double t) {
    const double value = distance(t);
    if (value < best.value) best = {value, t};
    return value;
  };
  for (double t = from; t <= to;) t += std::max(finest, 0.5 * std::fabs(look(t) - std::min(best.value, 0.0)));
  double a = std::max(from, best.t - 2.0 * finest), b = std::min(to, best.t + 2.0 * finest);
  for (int step = 0; step < 40 && b > a; ++step) {
    const double first = a + (b - a) / 3.0, second = b - (b - a) / 3.0;
    (look(first) < look(second) ? b : a) = look(first) < look(second) ? second : first;
  }
  return best;
}

constexpr double kFarAway = 1e3;  // beyond what any of the objects spans

double percentile(const std::vector<double>& values, double fraction) { return values.empty() ? 0.0 : lower_quantile(values, fraction); }

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

}  // namespace

TrueSurface true_sphere(double radius) {
  TrueSurface sphere;
  sphere.first_hit = [radius](const glm::dvec3& o, const glm::dvec3& d) -> TrueSurface::Hit {
    const double along = -glm::dot(o, d);
    const double inside = radius * radius - glm::dot(o + along * d, o + along * d);
    if (inside < 0.0) return {};
    const double t = along - std::sqrt(inside);
    if (t < 0.0) return {};
    return {t, glm::normalize(o + t * d)};
  };
  sphere.lowest = [radius](const glm::dvec3& o, const glm::dvec3& d, double from, double to) -> Lowest {
    const double t = std::clamp(-glm::dot(o, d), from, to);
    return {glm::length(o + t * d) - radius, t};
  };
  return sphere;
}

TrueSurface true_torus(double major, double minor) {
  const auto distance = [major, minor](const glm::dvec3& p) { return std::hypot(std::hypot(p.x, p.z) - major, p.y) - minor; };
  TrueSurface torus;
  torus.first_hit = [=](const glm::dvec3& o, const glm::dvec3& d) -> TrueSurface::Hit {
    const double along = -glm::dot(o, d), reach = major + minor;
    const double inside = reach * reach - glm::dot(o + along * d, o + along * d);
    if (inside < 0.0) return {};
    const double last = along + std::sqrt(inside);
    double t = std::max(0.0, along - std::sqrt(inside));
    // Sphere tracing of an exact distance comes as near as rounding allows, from outside only.
    for (int step = 0; step < 20'000 && t <= last; ++step) {
      const glm::dvec3 p = o + t * d;
      const double value = distance(p);
      if (value < 1e-12) {
        const double ring = std::hypot(p.x, p.z);
        return {t, glm::normalize(p - glm::dvec3(p.x, 0.0, p.z) * (major / ring))};
      }
      t += value;
    }
    return {};
  };
  torus.lowest = [=](const glm::dvec3& o, const glm::dvec3& d, double from, double to) {
    return search_lowest([&](double t) { return distance(o + t * d); }, std::min(from, kFarAway), std::min(to, 10.0 * (major + minor)),
                         1e-4 * minor);
  };
  return torus;
}

TrueSurface true_mesh(const TriangleMesh& mesh) {
  Mesh polygons;
  polygons.positions = mesh.positions;
  for (const glm::uvec3& t : mesh.triangles) {
    polygons.face_sizes.push_back(3);
    for (int k = 0; k < 3; ++k) polygons.corner_vertices.push_back(static_cast<std::int32_t>(t[k]));
  }
  Scene scene;
  scene.objects.push_back({.name = "mesh", .source = MeshSource{std::move(polygons), {}, {}}});
  auto model = std::make_shared<const SceneModel>(build_model(scene, {.kind = "mesh"}));
  auto closest = std::make_shared<const ClosestPointQuery>(mesh);
  const double extent = bounds(scene).radius();
  TrueSurface surface;
  surface.first_hit = [model](const glm::dvec3& o, const glm::dvec3& d) -> TrueSurface::Hit {
    // One ray a batch, and not as a tile's: the plainest way in.
    RayBatch rays;
    HitBatch hits;
    rays.count = 1;
    rays.set(0, o - model->render_origin, d, 0.0, std::numeric_limits<float>::max());
    hits.status[0] = HitStatus::miss;
    const Surface& mesh_surface = model->surfaces[0];
    mesh_surface.trace(mesh_surface.state.get(), rays, hits);
    if (hits.status[0] != HitStatus::hit) return {};
    return {double(hits.t[0]), glm::dvec3(hits.normal_x[0], hits.normal_y[0], hits.normal_z[0])};
  };
  // Unsigned: a ray that misses comes no nearer than this; of one that hits it says nothing below zero.
  surface.lowest = [closest, extent](const glm::dvec3& o, const glm::dvec3& d, double from, double to) {
    return search_lowest([&](double t) { return closest->closest(o + t * d).distance; }, from, std::min(to, glm::length(o) + 2.0 * extent),
                         1e-5 * extent);
  };
  return surface;
}

TruePicture true_picture(TrueSurface surface, const Camera& camera) {
  const RayForms<double> forms = ray_forms(camera);
  TruePicture picture{std::move(surface), {}, {}};
  const size_t pixels = static_cast<size_t>(camera.width_px) * static_cast<size_t>(camera.height_px);
  picture.distance.resize(pixels);
  picture.normal.resize(pixels);
  for_each_tile(camera.width_px, camera.height_px, [&](int x0, int y0, int x1, int y1) {
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        const size_t i = static_cast<size_t>(y) * static_cast<size_t>(camera.width_px) + static_cast<size_t>(x);
        const TrueSurface::Hit hit = picture.surface.first_hit(forms.eye, forms.direction(x, y));
        picture.distance[i] = hit.t, picture.normal[i] = hit.normal;
      }
    }
  });
  return picture;
}

Accuracy judge(const Frame& frame, const TruePicture& truth, const Camera& camera, double voxel_size) {
  constexpr double kGraze_px = 0.05;
  const RayForms<double> forms = ray_forms(camera);
  const glm::dvec3 forward = -camera.world_from_camera[2];
  Accuracy result;
  std::vector<double> angles, depths;
  for (size_t i = 0; i < frame.pixels(); ++i) {
    const double t = static_cast<double>(frame.distance[i]), expected = truth.distance[i];
    const bool hit = std::isfinite(t), should = std::isfinite(expected);
    result.hits += hit;
    if (!hit && !should) continue;
    const glm::dvec3 d = forms.direction(static_cast<int>(i) % frame.width, static_cast<int>(i) / frame.width);
    // How far a ray passes the surface, or how deep it goes in, as pixels at that depth.
    const auto off_px = [&](double from, double to) {
      const Lowest lowest = truth.surface.lowest(forms.eye, d, from, to);
      return lowest.value * camera.focal_px / std::max(1e-12, lowest.t * glm::dot(d, forward));
    };
    if (hit != should) {
      ++result.wrong_hits;
      result.farthest_wrong_px = std::max(result.farthest_wrong_px, std::fabs(off_px(0.0, kFarAway)));
      continue;
    }
    angles.push_back(angle_deg(glm::dvec3(frame.normal_at(i)), truth.normal[i]));
    depths.push_back(std::fabs(t - expected) / voxel_size);
    if (depths.back() < 1.0) continue;
    if (t > expected) {
      result.through += off_px(expected, t) < -kGraze_px;
    } else if (const double off = off_px(t - voxel_size, t + voxel_size); off > kGraze_px) {
      // In front of where the surface is, with nothing near: as wrong as a hit in the open.
      ++result.wrong_hits;
      result.farthest_wrong_px = std::max(result.farthest_wrong_px, off);
    }
  }
  result.normal_p99_deg = percentile(angles, 0.99);
  result.depth_p99_voxels = percentile(depths, 0.99);
  return result;
}

}  // namespace limn::bench
