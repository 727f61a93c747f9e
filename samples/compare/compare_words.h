#pragma once
// Numbers of a cell in words, the same on the sheet and on the page.

#include <string>
#include <vector>

#include "samples/compare/comparison.h"

namespace limn {

/// 23456.0 -> "23,456".
std::string counted(double value);
/// "0.53 %".
std::string share_text(double share);
/// Two digits: "0.0034", "1.2", "104".
std::string short_number(double value);
/// "level set (256 voxels, central gradient)".
std::string full_title(const ComparedModel& model);
/// "rim on the level set", or "level set" where there is one method only.
std::string cell_title(const Comparison& comparison, const Cell& cell);
/// A few short lines for a caption.
std::vector<std::string> caption_lines(const Comparison& comparison, const Cell& cell);

}  // namespace limn
