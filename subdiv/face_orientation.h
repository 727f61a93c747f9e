#pragma once
// Which way round the faces of a mesh run.

#include <cstdint>
#include <span>

#include "subdiv/mesh.h"

namespace limn {

/// Turns every face round: its first corner stays (fans start there), the others come in reverse order, a corner's normal with it.
void turn_faces(Mesh& mesh);

/// Turns what is inside out: all faces where the parts together enclose a negative volume, then each part that does and is not the wall of
/// a cavity. Normals of the file's that pointed inwards with their faces are negated. Parts with holes count where their volume is sure to
/// 10 %, sheets and parts whose faces disagree on the outside never do. Returns the number of parts that were turned; 0: nothing was
/// touched.
std::int64_t turn_outwards(Mesh& mesh);

}  // namespace limn
