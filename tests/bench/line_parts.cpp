#include "tests/bench/line_parts.h"

#include <cmath>
#include <numbers>

namespace limn::bench {
namespace {

using Kind = PartSolid::Kind;

SolidPart torus() { return {"torus", {{Kind::torus, {1.0, 0.38, 0.0}}}}; }

SolidPart hub() {
  SolidPart part{"hub", {{Kind::cylinder, {1.16, 0.14, 0.0}}, {Kind::cylinder, {0.44, 0.35, 0.0}, {0.0, 0.35, 0.0}}}};
  for (int i = 0; i < 6; ++i) {
    const double angle = (30.0 + 60.0 * i) * std::numbers::pi / 180.0;
    part.solids.push_back({Kind::cylinder, {0.12, 1.0, 0.0}, {0.8 * std::cos(angle), 0.0, 0.8 * std::sin(angle)}, true});
  }
  return part;
}

/// A plate with 161 hexagonal cells cut through it: straight edges by the thousand, most of them hidden.
SolidPart honeycomb() {
  constexpr double kPitch = 0.098;      // between the middles of neighbouring cells
  constexpr double kAcross = 0.041;     // from a cell's middle to its sides
  constexpr double kHalfHeight = 0.09;  // of the plate
  SolidPart part{"honeycomb", {{Kind::box, {1.18, kHalfHeight, 0.36}}}};
  // Seven rows of 23 cells, every other one moved by half a pitch.
  const double step = kPitch * std::sqrt(3.0) / 2.0;
  for (int row = 0; row < 7; ++row) {
    for (int i = 0; i < 23; ++i) {
      const glm::dvec3 center((i - 11 + (row % 2 == 0 ? 0.25 : -0.25)) * kPitch, 0.0, (row - 3) * step);
      part.solids.push_back({Kind::hexagon, {kAcross, 2.0 * kHalfHeight, 0.0}, center, true});
    }
  }
  return part;
}

}  // namespace

std::vector<SolidPart> line_parts() { return {torus(), hub(), fused_spheres_part(), honeycomb()}; }

}  // namespace limn::bench
