#pragma once
// Internal: the field of a list of operations.

#include "sdf/vm/vm_program.h"
#include "sdf/vm_field.h"

namespace limn::vm {

/// As vm_field; `file` is what messages call it.
VmField field_of(const Program& read, const std::string& file);

}  // namespace limn::vm
