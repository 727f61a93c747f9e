#pragma once
// Internal: which of a, b and c the steps of a tape read.

#include "sdf/tape.h"

namespace limn {

/// Whether jets without second derivatives are read without them (run_flat).
inline bool runs_flat(TapeOperation operation) {
  switch (operation) {
    case TapeOperation::negate:
    case TapeOperation::add_constant:
    case TapeOperation::multiply_constant:
    case TapeOperation::add:
    case TapeOperation::subtract:
    case TapeOperation::norm2:
    case TapeOperation::norm3:
      return true;
    default:
      return false;
  }
}

inline int operands(TapeOperation operation) {
  switch (operation) {
    case TapeOperation::coordinates:
    case TapeOperation::constant:
      return 0;
    case TapeOperation::narrow:
    case TapeOperation::copy:
    case TapeOperation::negate:
    case TapeOperation::square:
    case TapeOperation::absolute:
    case TapeOperation::sine:
    case TapeOperation::cosine:
    case TapeOperation::add_constant:
    case TapeOperation::multiply_constant:
      return 1;
    case TapeOperation::shape:
    case TapeOperation::norm3:
    case TapeOperation::corner3:
      return 3;
    default:
      return 2;
  }
}

}  // namespace limn
