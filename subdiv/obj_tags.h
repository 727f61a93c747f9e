#pragma once
// Tags of subdivision cages in Wavefront OBJ, as OpenSubdiv's shapes have them: `t NAME integers/reals/strings values...`, with vertices
// and faces counted from 0.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "subdiv/mesh.h"

namespace limn {

/// What is left of tags that are not honoured: how often each name was met.
struct ObjTags {
  std::map<std::string, std::int64_t, std::less<>> unknown{};
};

/// Reads what follows `t` on a line: crease, corner, hole, interpolateboundary, creasemethod and smoothtriangles go into the mesh. The
/// rules of face-varying data (texture coordinates) change nothing that is drawn, and are skipped. The method of creasemethod and
/// smoothtriangles may stand without counts. `place` is FILE:LINE for InputError.
void read_obj_tag(std::string_view text, const std::string& place, Mesh& mesh, ObjTags& tags);

/// Sorts the holes, names what was not honoured in Mesh::warnings. Throws InputError for a hole that is no face of the mesh.
void finish_obj_tags(const ObjTags& tags, const std::string& file, Mesh& mesh);

}  // namespace limn
