// Outline of constant width from the exact Euclidean distance to the silhouette.

#include "raymarch/border/registry.h"
#include "raymarch/border/silhouette.h"

namespace limn {
namespace {

Border draw(const BorderInput& input, const Parameters& parameters) {
  const OutlineBand band = outline_band(parameters);
  const Silhouette silhouette = find_silhouette(input.gbuffer, parameters.choice("seeds") == "estimated");
  Border border;
  border.color = glm::vec3(parameters.vector3("color"));
  border.coverage = ink_band(silhouette, exact_squares(silhouette, band.reach_px()), band);
  add_silhouette_notes("distance", silhouette, border.notes);
  return border;
}

}  // namespace

BorderMethod distance_method() {
  return {{"distance", "outline of constant width around the silhouette, by the exact Euclidean distance transform",
           "Felzenszwalb and Huttenlocher 2012"},
          {"id", "NdotV"},
          outline_parameters(),
          [](const SceneModel&, const Scene&) { return std::string(); },
          draw};
}

}  // namespace limn
