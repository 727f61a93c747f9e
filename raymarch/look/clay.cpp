#include "raymarch/look.h"

namespace limn {

Look clay_look() {
  return {{"clay", "one matt colour in soft light, hollows darker, without lines", "screen-space ambient occlusion: Crytek 2007"},
          {.shading = Shading::soft, .occlusion = 0.8, .color = glm::vec3(0.62f, 0.55f, 0.50f)},
          {},
          glm::vec3(0.84f, 0.83f, 0.81f)};
}

}  // namespace limn
