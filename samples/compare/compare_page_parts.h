#pragma once
// The report page in parts.

#include "samples/compare/comparison.h"

namespace limn {

/// A section for each method with a card for each model: picture, difference, the worst place enlarged, numbers, what failed.
std::string matrix_html(const Comparison& comparison);
/// One row a picture, one column a number.
std::string table_html(const Comparison& comparison);

}  // namespace limn
