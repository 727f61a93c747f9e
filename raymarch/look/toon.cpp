#include "raymarch/look.h"

namespace limn {

Look toon_look() {
  return {{"toon",
           "colours in three steps from shadow to light, a light rim on the lit side, and lines that are thick where the surface turns "
           "away slowly",
           "cel shading: Lake et al. 2000"},
          {.shading = Shading::cel, .steps = 3, .rim_light = 0.3},
          {{"contours", {{"width", {{3.5}}}, {"inner_width", {{1.4}}}, {"smooth", {{1.0}}}, {"shortest", {{6.0}}}}}},
          glm::vec3(1.0f)};
}

}  // namespace limn
