#pragma once
// A mesh as bytes, for the pipe between the helper program and us.

#include "sdf/color.h"
#include "sdf/guard.h"
#include "subdiv/mesh.h"

namespace limn {

void put_mesh(ByteWriter& writer, const Mesh& mesh);
/// What comes back has the right shape in memory only; call validate().
Mesh get_mesh(ByteReader& reader);

}  // namespace limn
