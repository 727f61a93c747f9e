// Roberts: edges of the G-buffer's layers; the core is edge_sources.h.

#include "raymarch/border.h"
#include "raymarch/border/edge_sources.h"

namespace limn {

BorderMethod roberts_method() {
  return {{"roberts", "differences across the 2x2 neighbourhood of depth, normal, colour, id and a custom buffer",
           "Roberts 1963; modulation: limn"},
          {"Z", "N", "NdotV", "id", "material", "P", "custom"},
          edge_parameters(EdgeOperator::roberts),
          [](const SceneModel&, const Scene&) { return std::string(); },
          [](const BorderInput& input, const Parameters& parameters) {
            return draw_edges(EdgeOperator::roberts, "roberts", input, parameters);
          }};
}

}  // namespace limn
