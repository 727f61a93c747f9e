#include "samples/commands/info_dump.h"

#include <fmt/format.h>

#include <algorithm>

#include "raymarch/level_set/brick_text.h"
#include "raymarch/scene/scene_extent.h"
#include "raymarch/surface.h"
#include "raymarch/surface/model_parts.h"
#include "samples/commands/common.h"
#include "samples/experiment/job.h"
#include "samples/experiment/no_effect.h"
#include "sdf/error.h"
#include "sdf/field_program_text.h"
#include "sdf/tape_text.h"

namespace limn {
namespace {

/// The representation that computes with what is dumped.
std::string kind_of(const SceneObject& object, const DumpOptions& dump) {
  if (dump.what != "bricks") return "analytic";
  return std::holds_alternative<MeshSource>(object.source) ? "mesh_level_set" : "level_set";
}

std::string object_text(const SceneObject& object, const DumpOptions& dump, const SurfaceSettings& settings, const glm::dvec3& origin) {
  if (dump.what != "bricks") {
    const Field field = translate(std::get<Field>(object.source), -origin);
    return dump.what == "tape" ? text_of(FieldTape(field)) : text_of(field.program());
  }
  const Surface surface = find_surface(settings.kind).build(object, settings, origin);
  if (!surface.bricks) {
    if (dump.brick) throw InputError({"", "brick", std::to_string(*dump.brick), "no such brick", "nothing: rays walk this grid"});
    return "no bricks: too many, or values that 16 bits do not tell apart; rays walk the grid\n";
  }
  return dump.brick ? text_of_brick(*surface.bricks, static_cast<size_t>(*dump.brick)) : text_of(*surface.bricks);
}

std::vector<std::string> different(std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

void check_dump(const DumpOptions& dump, const Scene& scene, const std::vector<std::string>& reasons) {
  if (dump.brick && dump.what != "bricks") throw InputError({"", "brick", "", "has no effect on a " + dump.what + "; leave it out", ""});
  if (dump.brick && scene.objects.size() > 1)
    throw InputError({"", "brick", std::to_string(*dump.brick), "several objects have a brick of that number", "a scene of one object"});
  if (std::none_of(reasons.begin(), reasons.end(), [](const std::string& reason) { return reason.empty(); }))
    throw InputError({"", "dump", dump.what, reasons.empty() ? "the scene is empty" : reasons.front(), ""});
}

}  // namespace

std::string dump_text(const Options& options, SceneInput input) {
  const DumpOptions& dump = options.dump;
  SurfaceSettings settings = surface_settings(options.spec, input);
  const Scene& scene = input.scene;
  std::vector<std::string> kinds, reasons;
  for (const SceneObject& object : scene.objects) {
    kinds.push_back(kind_of(object, dump));
    reasons.push_back(find_surface(kinds.back()).unsupported(object));
  }
  check_dump(dump, scene, reasons);
  refuse_undumped(options.spec.surface, input, kinds);
  check_extent(scene);
  if (dump.what == "bricks") check_cost(options, scene, settings, {}, {.kinds = different(kinds)});
  const glm::dvec3 origin = render_origin_of(scene);
  std::string text = fmt::format("render_origin: [{} {} {}]\n", origin.x, origin.y, origin.z);
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    settings.kind = kinds[i];
    text += fmt::format("object {}: {}\n", i, scene.objects[i].name);
    text += reasons[i].empty() ? object_text(scene.objects[i], dump, settings, origin) : "nothing to dump: " + reasons[i] + "\n";
  }
  return text;
}

}  // namespace limn
