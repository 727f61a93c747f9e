#pragma once
// The shapes that the command line's contract promises, with their parameters in their order.

#include <map>
#include <string>
#include <vector>

namespace limn::test {

inline const std::map<std::string, std::vector<std::string>>& contract_shapes() {
  static const std::map<std::string, std::vector<std::string>> shapes = {
      {"sphere", {"radius"}},
      {"ellipsoid", {"radii"}},
      {"box", {"half"}},
      {"rounded_box", {"half", "rounding"}},
      {"plane", {"normal", "offset"}},
      {"torus", {"major", "minor"}},
      {"capsule", {"a", "b", "radius"}},
      {"cylinder", {"radius", "half_height"}},
      {"cone", {"angle_deg", "height"}},
      {"superellipsoid", {"radii", "exponents"}},
      {"revolution", {"profile"}},
      {"gyroid", {"period", "thickness", "bound"}},
      {"metaballs", {"centers", "radii", "level"}},
      {"cyclide", {"a", "b", "d"}},
  };
  return shapes;
}

}  // namespace limn::test
