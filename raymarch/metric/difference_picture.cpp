#include <algorithm>

#include "raymarch/metric.h"
#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {

Image<glm::vec4> difference_picture(const Image<float>& border, const Image<float>& reference) {
  LIMN_CHECK(border.width == reference.width && border.height == reference.height);
  constexpr glm::vec3 white(1.0f), grey(0.4f), blue(0.02f, 0.1f, 0.85f), red(0.85f, 0.03f, 0.02f);
  Image<glm::vec4> picture(border.width, border.height);
  parallel_for(size_t{0}, border.size(), [&](size_t i) {
    const float common = std::min(border.pixels[i], reference.pixels[i]);
    const float missing = reference.pixels[i] - common, false_ink = border.pixels[i] - common;
    const float paper = 1.0f - common - missing - false_ink;
    picture.pixels[i] = glm::vec4(paper * white + common * grey + missing * blue + false_ink * red, 1.0f);
  });
  return picture;
}

}  // namespace limn
