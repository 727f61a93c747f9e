// Sobel: edges of the G-buffer's layers; the core is edge_sources.h.

#include "raymarch/border.h"
#include "raymarch/border/edge_sources.h"

namespace limn {

BorderMethod sobel_method() {
  return {
      {"sobel", "3x3 gradients of depth, normal, colour, id and a custom buffer", "Sobel and Feldman 1968; modulation: limn"},
      {"Z", "N", "NdotV", "id", "material", "P", "custom"},
      edge_parameters(EdgeOperator::sobel),
      [](const SceneModel&, const Scene&) { return std::string(); },
      [](const BorderInput& input, const Parameters& parameters) { return draw_edges(EdgeOperator::sobel, "sobel", input, parameters); }};
}

}  // namespace limn
