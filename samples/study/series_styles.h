#pragma once
// How series are told apart: a model has the same colour and marker in every study.

#include <cstddef>
#include <string>
#include <vector>

namespace limn {

/// Of each series its style (chart_canvas.h), no two the same where there are fewer than 29.
std::vector<size_t> styles_of(const std::vector<std::string>& series);

}  // namespace limn
