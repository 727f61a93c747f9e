// A representation, for the test of this folder: the formula under another name.

#include "raymarch/surface.h"

namespace limn {

SurfaceDescriptor analytic_surface();

SurfaceDescriptor trial_surface() {
  SurfaceDescriptor surface = analytic_surface();
  surface.about = {"trial", "the formula, on trial", "limn"};
  surface.build = [](const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin) {
    Surface made = analytic_surface().build(object, settings, render_origin);
    made.info.kind = "trial";
    return made;
  };
  return surface;
}

}  // namespace limn
