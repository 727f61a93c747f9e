#include "raymarch/look.h"

namespace limn {

Look ink_look() {
  return {{"ink", "lines alone, drawn with a pen that is not quite steady and presses harder where the surface turns away slowly",
           "widths: Goodwin et al. 2007"},
          {.shading = Shading::none},
          {{"contours",
            {{"width", {{4.5}}},
             {"thin_width", {{1.3}}},
             {"threshold", {{0.5}}},
             {"width_from", {{}, "curvature"}},
             {"wobble", {{0.7}}},
             {"smooth", {{1.0}}},
             {"shortest", {{6.0}}},
             {"color", {{0.006, 0.006, 0.012}}}}}},
          glm::vec3(1.0f)};
}

}  // namespace limn
