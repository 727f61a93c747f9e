// Level sets of bricks of several voxel sizes: no hit through the surface, and nothing farther off than stated.

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "raymarch/gbuffer/picture_rays.h"
#include "raymarch/local_model.h"
#include "samples/experiment/job.h"
#include "samples/scenes/scenes.h"
#include "sdf/error.h"
#include "sdf/level_set_data.h"
#include "sdf/shape.h"
#include "tests/random_seed.h"
#include "tests/samples/scene_camera.h"

namespace limn {
namespace {

/// A small tolerance: the border takes the smallest voxels.
constexpr double kFinest_px = 1e-6;

struct Local {
  Scene scene{};
  Camera camera{};
  SceneModel model{}, exact{};
  Field field;            ///< Render space.
  double most_off = 0.0;  ///< World units: kLocalCoarse_px where the surface is nearest to the eye.
};

Local make_local(const std::string& name, int view, const std::string& gradient, int voxels) {
  const Scene scene = find_scene(name)->make();
  const Camera camera = camera_of(scene, view, 4, {300, 300});
  SurfaceSettings settings{.kind = "level_set", .voxels = voxels, .gradient = gradient};
  Local local{.scene = scene,
              .camera = camera,
              .model = build_local_model(scene, settings, {{camera}, kFinest_px, {0.4}}),
              .exact = build_model(scene, {.kind = "analytic"}),
              .field = std::get<Field>(scene.objects.front().source)};
  local.field = translate(local.field, -local.model.render_origin);
  const Box box = bounds(scene);
  double nearest = 1e300;
  for (int k = 0; k < 8; ++k) {
    const glm::dvec3 corner(k & 1 ? box.upper.x : box.lower.x, k & 2 ? box.upper.y : box.lower.y, k & 4 ? box.upper.z : box.lower.z);
    nearest = std::min(nearest, project(camera, corner).z);
  }
  local.most_off = kLocalCoarse_px / pixels_per_unit_at(camera, nearest);
  return local;
}

/// How deep a ray goes into the body up to `until`, by the exact field.
double deepest(FieldEvaluator& field, const glm::dvec3& origin, const glm::dvec3& direction, double until, double step) {
  double depth = 0.0;
  for (double t = 0.0; t <= until; t += step) depth = std::max(depth, -field.value(origin + t * direction));
  return depth;
}

struct Faults {
  int hits = 0, through = 0, off = 0;
  double worst_off = 0.0;
};

/// What is wrong with hits: they may stand off by most_off along the normal, and a ray may have been no deeper inside before.
void judge(const Local& local, const RayBatch& rays, const HitBatch& local_hits, const HitBatch& exact_hits, FieldEvaluator& field,
           Faults& faults) {
  const double radius = 2.0 * local.model.bounds.radius();
  for (int i = 0; i < rays.count; ++i) {
    if (!(rays.t_min[i] < rays.t_max[i])) continue;
    const bool hit = local_hits.status[i] == HitStatus::hit, exact = exact_hits.status[i] == HitStatus::hit;
    const glm::dvec3 origin(rays.origin(i)), direction(rays.direction(i));
    const double t = hit ? static_cast<double>(local_hits.t[i]) : radius;
    faults.hits += hit;
    if (hit) {
      const FieldJet jet = field.jet(origin + t * direction);
      const double off = std::abs(jet.value) / std::max(glm::length(jet.gradient), 0.1);
      faults.worst_off = std::max(faults.worst_off, off);
      faults.off += off > local.most_off;
    }
    // As near as the exact hit, nothing can have been passed.
    if (!exact || (hit && t <= static_cast<double>(exact_hits.t[i]) + local.most_off)) continue;
    faults.through += deepest(field, origin, direction, t, 0.1 * local.most_off) > local.most_off;
  }
}

void trace_singly(const SceneModel& model, const RayBatch& rays, HitBatch& hits) {
  std::fill_n(hits.status, kRayBatchSize, HitStatus::miss);
  const Surface& surface = model.surfaces.front();
  surface.trace(surface.state.get(), rays, hits);
}

Faults random_rays(const Local& local, int batches, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  const double radius = local.model.bounds.radius();
  FieldEvaluator field(local.field);
  Faults faults;
  for (int batch = 0; batch < batches; ++batch) {
    RayBatch rays;
    HitBatch local_hits, exact_hits;
    rays.count = kRayBatchSize;
    for (int i = 0; i < rays.count; ++i) {
      const glm::dvec3 from = 1.01 * radius * glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
      const glm::dvec3 to = 0.5 * local.model.bounds.size() * glm::dvec3(part(random), part(random), part(random));
      rays.set(i, from, glm::normalize(to - from), 0.0, 1e3 * radius);
    }
    trace_singly(local.model, rays, local_hits);
    trace_singly(local.exact, rays, exact_hits);
    judge(local, rays, local_hits, exact_hits, field, faults);
  }
  return faults;
}

/// Every pixel of the view that it was made for, as pictures trace them; and the same rays one by one, which must find the same.
Faults pixels(const Local& local, const Camera& camera, int& differ) {
  const Camera in_render = moved(camera, local.model.render_origin);
  const PictureRays picture = picture_rays(in_render, local.model.bounds.radius(), true);
  const Surface &surface = local.model.surfaces.front(), &exact = local.exact.surfaces.front();
  const SurfaceView view = surface.view(surface.state, {.camera = in_render});
  EXPECT_NE(view.trace, nullptr);
  FieldEvaluator field(local.field);
  Faults faults;
  for (int y = 0; y < camera.height_px; y += 16)
    for (int x = 0; x < camera.width_px; x += 16) {
      const PixelTile tile{x, y, std::min(16, camera.width_px - x), std::min(16, camera.height_px - y)};
      RayBatch rays;
      HitBatch hits, singly, exact_hits;
      fill_rays(picture, tile, {0.5, 0.5}, rays);
      for (HitBatch* batch : {&hits, &singly, &exact_hits}) std::fill_n(batch->status, kRayBatchSize, HitStatus::miss);
      view.trace(view.state.get(), tile, rays, hits);
      surface.trace(surface.state.get(), rays, singly);
      exact.trace(exact.state.get(), rays, exact_hits);
      for (int i = 0; i < rays.count; ++i) {
        if (!(rays.t_min[i] < rays.t_max[i])) continue;
        const glm::vec3 normal(hits.normal_x[i], hits.normal_y[i], hits.normal_z[i]);
        const bool hit = hits.status[i] == HitStatus::hit;
        // Across the surface: along rays that graze it, rounding of places is any length.
        const double apart = hit ? static_cast<double>(std::abs((hits.t[i] - singly.t[i]) * glm::dot(normal, rays.direction(i)))) : 0.0;
        const bool same = hits.status[i] == singly.status[i] && (!hit || apart <= 1e-3 * local.most_off);
        differ += !same;
      }
      judge(local, rays, hits, exact_hits, field, faults);
    }
  return faults;
}

TEST(LocalLevelSet, NoRayPassesTheSurfaceAndNoHitIsFartherOffThanStated) {
  std::mt19937 random(random_seed());
  // LIMN_ALL=1 takes 2 million rays and 36 views of each scene.
  const bool all = std::getenv("LIMN_ALL") != nullptr;
  for (const char* name : {"ellipsoid", "tilted_torus", "machined_part"})
    for (const char* gradient : {"central", "cell", "cubic"}) {
      const Local local = make_local(name, 1, gradient, 1024);
      const Faults faults = random_rays(local, all ? 8000 : 40, random);
      EXPECT_GT(faults.hits, 1000) << name;
      EXPECT_EQ(faults.through, 0) << name << " " << gradient;
      EXPECT_EQ(faults.off, 0) << name << " " << gradient << ": " << faults.worst_off << " of " << local.most_off;
      for (int view = 0; view < (all ? 36 : 2); ++view) {
        const Camera camera = view == 0 ? local.camera : camera_of(local.scene, view, 36, {300, 300});
        int differ = 0;
        const Faults seen = pixels(local, camera, differ);
        EXPECT_GT(seen.hits, 1000) << name;
        EXPECT_EQ(seen.through, 0) << name << " " << gradient << " view " << view;
        EXPECT_EQ(seen.off, 0) << name << " " << gradient << " view " << view << ": " << seen.worst_off << " of " << local.most_off;
        // What a picture finds and what a single ray finds: from other packets, whose places are rounded otherwise.
        EXPECT_LE(differ, seen.hits / 1000) << name << " " << gradient << " view " << view;
      }
      if (!all) break;
    }
}

/// [k]: what has N.V below 0.4 and what is hit, of each pixel of the view.
std::vector<int> border_pixels(const SceneModel& model, const Camera& camera) {
  const Camera in_render = moved(camera, model.render_origin);
  const PictureRays picture = picture_rays(in_render, model.bounds.radius(), true);
  const Surface& surface = model.surfaces.front();
  const SurfaceView view = surface.view(surface.state, {.camera = in_render});
  std::vector<int> kinds;
  for (int y = 0; y < camera.height_px; y += 16)
    for (int x = 0; x < camera.width_px; x += 16) {
      const PixelTile tile{x, y, std::min(16, camera.width_px - x), std::min(16, camera.height_px - y)};
      RayBatch rays;
      HitBatch hits;
      fill_rays(picture, tile, {0.5, 0.5}, rays);
      std::fill_n(hits.status, kRayBatchSize, HitStatus::miss);
      view.trace(view.state.get(), tile, rays, hits);
      for (int i = 0; i < rays.count; ++i) {
        const glm::vec3 normal(hits.normal_x[i], hits.normal_y[i], hits.normal_z[i]);
        const bool hit = hits.status[i] == HitStatus::hit;
        kinds.push_back(!hit ? 0 : -glm::dot(normal, rays.direction(i)) < 0.4f ? 1 : 2);
      }
    }
  return kinds;
}

TEST(LocalLevelSet, TheBorderIsThatOfTheUniformLevelSetOfItsSmallestVoxels) {
  for (const char* name : {"ellipsoid", "tilted_torus", "machined_part"})
    for (const char* gradient : {"central", "cubic"}) {
      const Local local = make_local(name, 0, gradient, 512);
      const SceneModel uniform = build_model(local.scene, {.kind = "level_set", .voxels = 512, .gradient = gradient});
      const std::vector<int> ours = border_pixels(local.model, local.camera), theirs = border_pixels(uniform, local.camera);
      int differ = 0;
      for (size_t i = 0; i < ours.size(); ++i) differ += ours[i] != theirs[i];
      EXPECT_LE(differ, 10) << name << " " << gradient;
      EXPECT_LT(total(local.model).bytes, total(uniform).bytes / 2) << name << " " << gradient;
    }
}

TEST(LocalLevelSet, MemoryGrowsLikeTheBordersLength) {
  for (const char* name : {"ellipsoid", "tilted_torus", "machined_part"}) {
    std::vector<double> bytes;
    for (const int voxels : {512, 2048}) bytes.push_back(static_cast<double>(total(make_local(name, 0, "central", voxels).model).bytes));
    EXPECT_LE(std::log(bytes[1] / bytes[0]) / std::log(4.0), 1.3) << name << ": " << bytes[0] << " and " << bytes[1] << " bytes";
  }
}

TEST(LocalLevelSet, RaysThatStartInsideLeaveThroughTheSurface) {
  const Local local = make_local("ellipsoid", 0, "central", 256);
  std::mt19937 random(random_seed());
  std::normal_distribution<double> normal;
  RayBatch rays;
  HitBatch hits, exact;
  rays.count = 37;
  for (int i = 0; i < rays.count; ++i)
    rays.set(i, glm::dvec3(0.0), glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))), 0.0, 100.0);
  trace_singly(local.model, rays, hits);
  trace_singly(local.exact, rays, exact);
  for (int i = 0; i < rays.count; ++i) {
    ASSERT_EQ(hits.status[i], HitStatus::hit);
    EXPECT_NEAR(hits.t[i], exact.t[i], 2.0 * local.most_off);
    const glm::vec3 ours(hits.normal_x[i], hits.normal_y[i], hits.normal_z[i]),
        theirs(exact.normal_x[i], exact.normal_y[i], exact.normal_z[i]);
    EXPECT_GT(glm::dot(ours, theirs), 0.95f);
  }
}

TEST(LocalLevelSet, ItsGridsHoldTheFieldsDistancesAndItsSigns) {
  const Scene scene = find_scene("tilted_torus")->make();
  const Camera camera = camera_of(scene, 0, 4, {300, 300});
  const std::vector<LevelSet> grids = local_level_sets(scene, {.kind = "level_set", .voxels = 512}, {{camera}, kFinest_px, {0.4}});
  EXPECT_GE(grids.size(), 3u);
  FieldEvaluator field(std::get<Field>(scene.objects.front().source));
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> part(0.0, 1.0);
  double last = 0.0;
  for (const LevelSet& grid : grids) {
    const LevelSetInfo& info = grid.info();
    EXPECT_GE(info.voxel_size, 2.0 * last - 1e-12);
    last = info.voxel_size;
    const Box box = bounds(scene);
    int active = 0;
    double worst = 0.0;
    const auto accessor = grid.data().accessor();
    for (int k = 0; k < 300000; ++k) {
      const glm::dvec3 p = box.lower + box.size() * glm::dvec3(part(random), part(random), part(random));
      const glm::ivec3 node(glm::round(grid.data().index_from_world.point(p)));
      const nanovdb::Coord at(node.x, node.y, node.z);
      const double there = static_cast<double>(accessor.getValue(at));
      const double distance = field.value(info.world_from_index.point(glm::dvec3(node)));
      const double half_width = info.half_width_voxels * info.voxel_size;
      if (accessor.isActive(at)) {
        ++active;
        worst = std::max(worst, std::abs(there - std::clamp(distance, -half_width, half_width)) / info.voxel_size);
      } else if (std::abs(distance) > 8.0 * info.voxel_size * std::sqrt(3.0) && accessor.probeLeaf(at)) {
        EXPECT_EQ(there < 0.0, distance < 0.0) << info.name;
      }
    }
    EXPECT_GT(active, 10) << info.name;
    // Nodes on the faces of larger bricks have these bricks' interpolant.
    EXPECT_LT(worst, 0.25) << info.name;
  }
}

/// Nodes beside the bricks, far from the surface or not, and also where the scene lies far from its own origin.
TEST(LocalLevelSet, NodesOfItsGridsThatHoldNoDistanceAreOnTheFieldsSide) {
  for (const char* name : {"tilted_torus", "machined_part"}) {
    Scene scene = find_scene(name)->make();
    const Field field = translate(std::get<Field>(scene.objects.front().source), {40.0, -7.0, 3.0});
    scene.objects.front().source = field;
    const std::vector<LevelSet> grids =
        local_level_sets(scene, {.kind = "level_set", .voxels = 256}, {{camera_of(scene, 0, 4, {300, 300})}, kFinest_px, {0.4}});
    FieldEvaluator evaluator(field);
    int inside = 0, outside = 0, wrong = 0;
    for (const LevelSet& grid : grids) {
      const auto& tree = grid.data().grid->tree();
      for (std::uint32_t leaf = 0; leaf < tree.nodeCount(0); ++leaf) {
        const auto& nodes = tree.getFirstNode<0>()[leaf];
        for (std::uint32_t n = 0; n < 512; n += 7) {
          if (nodes.isActive(n)) continue;
          const nanovdb::Coord at = nodes.offsetToGlobalCoord(n);
          const double value = evaluator.value(grid.info().world_from_index.point({at[0], at[1], at[2]}));
          // The grid's own space rounds otherwise.
          if (std::abs(value) < 1e-9) continue;
          ++(value < 0.0 ? inside : outside);
          wrong += (nodes.getValue(n) < 0.0f) != (value < 0.0);
        }
      }
    }
    EXPECT_GT(inside, 1000) << name;
    EXPECT_GT(outside, 1000) << name;
    EXPECT_EQ(wrong, 0) << name;
  }
}

TEST(LocalLevelSet, WhatHasNoFieldIsRefusedWithWhatWouldWork) {
  const Scene scene = find_scene("teacup")->make();
  try {
    build_local_model(scene, {.kind = "level_set"}, {{camera_of(scene, 0, 1, {300, 300})}, 0.25, {0.4}});
    FAIL() << "a mesh was modelled";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("mesh"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace limn
