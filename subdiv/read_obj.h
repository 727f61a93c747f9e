#pragma once

#include <string>
#include <string_view>

#include "subdiv/mesh.h"

namespace limn {

/// Wavefront OBJ from text (UTF-8, or UTF-16 with its mark), in double precision: v (two or three coordinates, colours), vn, f (negative
/// indices, n-gons), g, o, s, usemtl and the tags of subdiv/obj_tags.h. Points, lines and texture coordinates are skipped. What was
/// repaired, ignored or dropped is in Mesh::warnings. Our own reader rather than a library's, because the libraries read "nan" as 0, drop
/// faces without a word, cut n-gons at 255 corners and cannot say in which line the fault is. Throws InputError with file:line.
Mesh parse_obj(std::string_view bytes, const std::string& file, std::int64_t max_elements);

}  // namespace limn
