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

}  // namespace

std::vector<SolidPart> line_parts() { return {torus(), hub(), fused_spheres_part(), honeycomb_part()}; }

}  // namespace limn::bench
