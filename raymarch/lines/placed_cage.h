#pragma once
// Internal: the limit surface of one cage, about the cage's own middle, so that nothing is lost far from the origin.

#include "raymarch/lines/surface_curves.h"

namespace limn {

struct PlacedCage {
  std::shared_ptr<const LimitSurface> surface;
  Affine solver_from_cage{};
};

PlacedCage place_cage(const LineTask& task, size_t object);

}  // namespace limn
