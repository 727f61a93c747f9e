#include "raymarch/look.h"

namespace limn {

Look paper_look() {
  return {{"paper", "pale colours in two steps under soft brown lines, on cream paper", ""},
          {.shading = Shading::cel, .steps = 2},
          {{"contours",
            {{"width", {{2.6}}},
             {"inner_width", {{1.2}}},
             {"wobble", {{0.5}}},
             {"smooth", {{1.0}}},
             {"shortest", {{6.0}}},
             {"color", {{0.07, 0.035, 0.02}}}}}},
          glm::vec3(0.93f, 0.87f, 0.74f)};
}

}  // namespace limn
