// Pieces of ink and holes in it, against the reference's.

#include <numeric>

#include "raymarch/metric.h"
#include "raymarch/metric/ink_mask.h"
#include "sdf/error.h"

namespace limn {
namespace {

struct Counts {
  int components = 0, holes = 0;
};

size_t root_of(std::vector<size_t>& parents, size_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

// Ink hangs together over corners, paper does not: so a closed line of ink parts its inside from its outside (Rosenfeld 1970). A frame of
// paper about the picture joins all that is outside.
Counts count(const Image<float>& coverage) {
  const Image<std::uint8_t> mask = ink_mask(coverage);
  Image<std::uint8_t> framed(mask.width + 2, mask.height + 2, 0);
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) framed.at(x + 1, y + 1) = mask.at(x, y);
  }
  std::vector<size_t> parents(framed.size());
  std::iota(parents.begin(), parents.end(), size_t{0});
  constexpr int steps[][2] = {{-1, 0}, {0, -1}, {-1, -1}, {1, -1}};
  for (int y = 0; y < framed.height; ++y) {
    for (int x = 0; x < framed.width; ++x) {
      const int neighbours = framed.at(x, y) ? 4 : 2;
      for (int k = 0; k < neighbours; ++k) {
        const int u = x + steps[k][0], v = y + steps[k][1];
        if (!framed.inside(u, v) || framed.at(u, v) != framed.at(x, y)) continue;
        parents[root_of(parents, framed.index(x, y))] = root_of(parents, framed.index(u, v));
      }
    }
  }
  Counts counts;
  for (size_t i = 0; i < parents.size(); ++i) {
    if (parents[i] == i) ++(framed.pixels[i] ? counts.components : counts.holes);
  }
  --counts.holes;
  return counts;
}

std::vector<MetricValue> measure(const MetricInput& input) {
  const Image<float>&ink = input.picture.border, &reference = input.reference.border;
  LIMN_CHECK(ink.width == reference.width && ink.height == reference.height);
  const Counts own = count(ink), wanted = count(reference);
  return {{"topology_components_difference", static_cast<double>(own.components - wanted.components), ""},
          {"topology_holes_difference", static_cast<double>(own.holes - wanted.holes), ""},
          {"topology_components", static_cast<double>(own.components), ""},
          {"topology_holes", static_cast<double>(own.holes), ""},
          {"topology_reference_components", static_cast<double>(wanted.components), ""},
          {"topology_reference_holes", static_cast<double>(wanted.holes), ""}};
}

}  // namespace

Metric topology_metric() {
  return {{"topology",
           "pieces of ink (8-connected, coverage of one half and more) and holes in it (4-connected), less the reference's; and the counts",
           "Rosenfeld 1970"},
          {"topology_components_difference", "topology_holes_difference", "topology_components", "topology_holes",
           "topology_reference_components", "topology_reference_holes"},
          true,
          measure,
          MetricSubject::ink};
}

}  // namespace limn
