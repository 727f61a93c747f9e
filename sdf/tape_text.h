#pragma once
// Internal: a tape as text, for debugging: a header with counts, one line a leaf, then one instruction a line. Instructions have no line
// numbers and nothing is an address, so that `diff` of two dumps shows what differs and nothing else. Numbers have the fewest digits that
// read back as the same double. Inside a shape the order is that in which the compiler evaluates the formula's operands: two compilers may
// differ in it.
//   r1 r2 _ = coordinates leaf 0          a register that nobody reads (TapeStep::axes) is left out
//   r3 = norm2 r1 r2 ; inside_shape       flags of the step stand behind the semicolon
//   r3 = add_constant r3 -0.5 ; inside_shape
//   r0 = minimum r0 r3 ; sign_decides

#include <span>
#include <string>

#include "sdf/tape.h"

namespace limn {

const char* name_of(TapeOperation operation);

std::string text_of(const FieldTape& tape);
/// The instructions alone: of a pruned tape, whose leaves are those of the whole one.
std::string text_of(std::span<const TapeStep> steps);

}  // namespace limn
