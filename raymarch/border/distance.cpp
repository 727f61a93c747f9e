// Outline of constant width from the exact Euclidean distance to the silhouette.

#include "raymarch/border.h"
#include "raymarch/border/outline.h"

namespace limn {
namespace {

Border draw(const BorderInput& input, const Parameters& parameters) { return draw_outline("distance", input, parameters, exact_squares); }

}  // namespace

BorderMethod distance_method() {
  return {{"distance", "outline of constant width around the silhouette, by the exact Euclidean distance transform",
           "Felzenszwalb and Huttenlocher 2012"},
          {"Z", "N", "NdotV", "id", "material"},
          outline_parameters(),
          [](const SceneModel&, const Scene&) { return std::string(); },
          draw};
}

}  // namespace limn
