#pragma once
// Lines of level sets that fall to pieces: a grid turns a crease over a voxel or two, and where those cover several pixels an operator that
// compares neighbouring pixels finds the turn in some of them only.

#include "raymarch/border.h"

namespace limn {

/// "roberts: 3 pieces of line are shorter than 6 px …" where the ink on level sets falls to pieces; empty where it does not.
std::string broken_lines_note(const std::string& name, const BorderInput& input, const Image<float>& coverage);

}  // namespace limn
