#pragma once
// Internal: the edges of wide ink.

#include <vector>

#include "samples/judge/ink_thinning.h"
#include "samples/judge/judge_lines.h"
#include "sdf/image.h"

namespace limn {

/// Where the coverage is one half, within the mask: closed lines, and open ones that end at the mask's border or the picture's.
std::vector<InkLine> edges_of_ink(const Image<float>& coverage, const InkMask& mask);

}  // namespace limn
