#pragma once

#include "sdf/error.h"

namespace limn {

/// More memory than somebody allows: LevelSetSettings::max_bytes and its like, or the process's own limit. Who set the limit knows how to
/// say so.
class SizeError : public InputError {
 public:
  using InputError::InputError;
};

}  // namespace limn
