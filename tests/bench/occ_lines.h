#pragma once
// OpenCASCADE's hidden line removal on the same parts from the same sides, where its packages were there when the bench was built.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sdf/camera.h"
#include "tests/bench/line_parts.h"

namespace limn::bench {

/// Its version; nothing where the bench was built without it.
std::optional<std::string> occ_version();

enum class OccMethod {
  exact,     ///< HLRBRep_Algo, on the surfaces themselves.
  polygonal  ///< HLRBRep_PolyAlgo, on a mesh that lies within 0.05 px of them.
};
struct OccRun {
  std::vector<double> ms{};  ///< Of each view that was finished; making the part, and its mesh, is left out.
  bool finished = false;
};
/// `cameras` orthographic. In a process of its own, which is stopped after `limit_s`.
OccRun occ_lines(const SolidPart& part, std::span<const Camera> cameras, OccMethod method, double limit_s);

}  // namespace limn::bench
