#pragma once
// A mesh as bytes, as the helper program sends it to us.

#include "sdf/color.h"
#include "sdf/guard.h"
#include "subdiv/mesh.h"

namespace limn {

void put_mesh(ByteWriter& writer, const Mesh& mesh);
/// Frees each array when it is written, so that a large mesh is hardly ever held twice.
void put_mesh(ByteWriter& writer, Mesh&& mesh);
/// What comes back has the right shape in memory only; call validate().
Mesh get_mesh(ByteReader& reader);

}  // namespace limn
