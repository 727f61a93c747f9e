#pragma once
// Internal: a field's program as text, for debugging: a header with counts, one line a leaf, then one instruction a line. Instructions have
// no line numbers and nothing is an address, so that `diff` of two dumps shows what differs and nothing else. Numbers have the fewest
// digits that read back as the same double.
//   s1 = leaf 1
//   s0 = smooth_minimum s0 s1 0.25

#include <string>

#include "sdf/field_program.h"

namespace limn {

const char* name_of(FieldOperation operation);

std::string text_of(const FieldProgram& program);

/// "[a b c d; e f g h; i j k l]": x, y and z of the target are a row each, the last column is the translation.
std::string rows_text(const double (&rows)[3][4]);

}  // namespace limn
