// A look, for the test of this folder: one colour and the ink of the method on trial.

#include "raymarch/look.h"

namespace limn {

Look trial_look() {
  return {{"trial", "flat colour under a rim, on trial", "limn"},
          {.shading = Shading::flat},
          {{"rim", {{"threshold", {{0.6}}}}}},
          glm::vec3(0.0f, 0.0f, 1.0f)};
}

}  // namespace limn
