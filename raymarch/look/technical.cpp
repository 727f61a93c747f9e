#include "raymarch/look.h"

namespace limn {

Look technical_look() {
  return {{"technical", "outlines thick, edges thin, hidden lines dashed, on white", "ISO 128"},
          {.shading = Shading::none},
          {{"contours", {{"width", {{2.4}}}, {"inner_width", {{1.3}}}, {"hidden", {{1.0}}}, {"smooth", {{1.0}}}, {"shortest", {{6.0}}}}}},
          glm::vec3(1.0f)};
}

}  // namespace limn
