#pragma once
// A mesh as bytes, for the pipe between the helper program and us.

#include "sdf/guard.h"
#include "subdiv/mesh.h"

namespace limn {

void put_mesh(ByteWriter& writer, const Mesh& mesh);
/// What comes back has the right shape in memory only; call validate().
Mesh get_mesh(ByteReader& reader);

/// Display-referred (IEC 61966-2-1) to linear, for vertex colours of formats that store what a screen shows.
float linear_from_srgb(float value);
float srgb_from_linear(float value);

}  // namespace limn
