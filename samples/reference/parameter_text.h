#pragma once
// Parameters as people read them, in lists and in the reference.

#include <string>

#include "sdf/descriptor.h"

namespace limn {

/// "0.4", "true", "outside": one of the parameter's numbers.
std::string value_text(const Parameter& parameter, double value);
/// "1, 0.7, 0.5"; after four "...".
std::string default_text(const Parameter& parameter);
/// "0 .. 1", "from 0", "true | false", "outside | inside", "any".
std::string range_text(const Parameter& parameter);

}  // namespace limn
