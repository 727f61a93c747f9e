// Inside is inside: the sign of a level set well away from the surface.

#include "samples/input/world_model.h"
#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"
#include "sdf/error.h"
#include "sdf/shape.h"

namespace limn {
namespace {

LevelSet level_set_of(const StabilityStage& stage, std::vector<std::string>& said) {
  SurfaceSettings settings = stage.settings;
  std::vector<std::string> warnings;
  LevelSet made = world_level_set(stage.scene, settings, warnings);
  add_said(warnings, said);
  add_said(made.info().warnings, said);
  return made;
}

StabilityFinding run(CaseContext& context, const MethodCall*, const Parameters& with) {
  StabilityFinding finding;
  const LevelSet grid = level_set_of(context.stage(), finding.said);
  const Field truth = context.truth_field();
  const Box box = dilate(truth.traits().bounds, 4.0 * grid.info().voxel_size);
  const double clear = with.number("clear_voxels") * grid.info().voxel_size;
  std::vector<glm::dvec3> points(static_cast<size_t>(with.integer("points")));
  StabilityRandom random = context.random();
  for (glm::dvec3& point : points) {
    for (int axis = 0; axis < 3; ++axis) point[axis] = box.lower[axis] + random.next() * box.size()[axis];
  }
  std::vector<double> found(points.size()), wanted(points.size());
  level_set_values(grid, points, found);
  FieldEvaluator(truth).values(std::span<const glm::dvec3>(points), wanted);
  std::int64_t wrong = 0, looked = 0;
  std::string first;
  for (size_t i = 0; i < points.size(); ++i) {
    if (std::abs(wanted[i]) <= clear) continue;
    ++looked;
    if ((found[i] < 0.0) == (wanted[i] < 0.0)) continue;
    if (wrong++ == 0)
      first = fmt::format(", the first at ({:.3g}, {:.3g}, {:.3g}): {:.3g} instead of {:.3g}", points[i].x, points[i].y, points[i].z,
                          found[i], wanted[i]);
  }
  finding.number = static_cast<double>(wrong);
  finding.message = fmt::format("{} of {} points have the wrong sign{}", wrong, looked, first);
  finding.picture = picture_of(context.stage(), context.views().front());
  return finding;
}

}  // namespace

StabilityCheck sign_right_check() {
  return {{"sign_right", "random points at which the level set says inside where outside is true, or the other way round", "limn"},
          "points",
          false,
          {stability_number("clear_voxels", 1.0, "voxels", "points nearer to the surface are not looked at"),
           stability_whole("points", 20000, 1, 10'000'000, "that are looked at")},
          run};
}

}  // namespace limn
