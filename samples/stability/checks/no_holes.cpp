// Rays against a march in many more steps, in double precision: what that hits must be hit, what it misses missed.

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"
#include "sdf/error.h"
#include "sdf/parallel.h"
#include "sdf/shape.h"

namespace limn {
namespace {

/// The least value along each ray of the picture. `values` writes those of a batch of world points.
template <class Values>
Image<double> least_along_rays(const StabilityView& view, const Box& box, int steps, const Values& values) {
  Image<double> least(view.camera.width_px, view.camera.height_px, std::numeric_limits<double>::infinity());
  const glm::dvec3 middle = box.center();
  const double radius = 1.001 * box.radius();
  parallel_for(0, least.height, [&](int y) {
    std::vector<glm::dvec3> points(static_cast<size_t>(steps) + 1);
    std::vector<double> found(points.size());
    for (int x = 0; x < least.width; ++x) {
      const CameraRay ray = camera_ray(view.camera, x + 0.5, y + 0.5);
      const double along = glm::dot(middle - ray.origin, ray.direction);
      const double off = glm::length(ray.origin + along * ray.direction - middle);
      if (off >= radius) continue;
      const double half = std::sqrt(radius * radius - off * off), first = std::max(0.0, along - half), last = along + half;
      if (last <= first) continue;
      for (int i = 0; i <= steps; ++i) points[static_cast<size_t>(i)] = ray.origin + (first + (last - first) * i / steps) * ray.direction;
      values(points, found);
      for (const double value : found) least.at(x, y) = std::min(least.at(x, y), value);
    }
  });
  return least;
}

Image<double> least_values(const Scene& scene, const StabilityView& view, int steps) {
  const Box box = bounds(scene);
  if (!box.finite()) throw InputError({scene.name, "object", "", "no bounds to march in", "a bounded scene"});
  if (const auto* volume = std::get_if<LevelSetSource>(&scene.objects.front().source)) {
    const Affine object_from_world = inverse(scene.objects.front().world_from_object);
    return least_along_rays(view, box, steps, [&](std::vector<glm::dvec3>& points, std::vector<double>& found) {
      for (glm::dvec3& point : points) point = object_from_world.point(point);
      level_set_values(volume->level_set, points, found);
    });
  }
  std::vector<Field> fields;
  for (const SceneObject& object : scene.objects) {
    const auto* field = std::get_if<Field>(&object.source);
    if (field == nullptr) throw InputError({scene.name, "object", "", "no field to march through", "shapes, or a [[reference]] of shapes"});
    fields.push_back(*field);
  }
  const Field all = combine(Csg::union_, fields);
  return least_along_rays(view, box, steps, [&](const std::vector<glm::dvec3>& points, std::vector<double>& found) {
    FieldEvaluator evaluator(all);
    evaluator.values(std::span<const glm::dvec3>(points), found);
  });
}

StabilityFinding run(CaseContext& context, const MethodCall*, const Parameters& with) {
  const Scene& scene = context.truth_scene();
  const Box box = bounds(scene);
  const double voxel = total(context.stage().model).voxel_size;
  const double slack = with.number("slack") * box.radius() + with.number("slack_voxels") * voxel;
  const int steps = with.integer("steps");
  // Between two steps the value may fall by half of what a step can change it by.
  const double between = 2.002 * box.radius() / steps;
  Worst worst;
  for (const StabilityView& view : context.views()) {
    const Image<double> least = least_values(scene, view, steps);
    std::int64_t holes = 0, false_hits = 0;
    std::string first;
    for (size_t i = 0; i < least.size(); ++i) {
      const bool hit = view.seen.id.pixels[i] != 0;
      const bool hole = !hit && least.pixels[i] < -slack, wrong = hit && least.pixels[i] > slack + between;
      if ((hole || wrong) && holes + false_hits == 0) {
        const auto width = static_cast<size_t>(view.seen.width);
        first = fmt::format(", the first at ({}, {}) where the value falls to {:.3g}", i % width, i / width, least.pixels[i]);
      }
      holes += hole;
      false_hits += wrong;
    }
    const HitCounts hits = count_hits(view.seen);
    worst.see(
        static_cast<double>(holes + false_hits + hits.out_of_steps),
        fmt::format("{} holes and {} false hits beside {} hits, against {} steps a ray{}", holes, false_hits, hits.hits, steps, first),
        context.stage(), view);
  }
  return worst.take();
}

}  // namespace

StabilityCheck no_holes_check() {
  return {{"no_holes", "pixels where a march in far more steps hits and the surface is missed, or the other way round", "limn"},
          "pixels",
          false,
          {stability_number("slack", 1e-6, "", "how deep the finer march must get, and how near it must come, in radii of the scene"),
           stability_number("slack_voxels", 0.0, "voxels", "the same in voxels, added"),
           stability_whole("steps", 2000, 10, 1'000'000, "of the finer march, across the scene")},
          run};
}

}  // namespace limn
