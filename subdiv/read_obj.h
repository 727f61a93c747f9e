#pragma once

#include <string>
#include <string_view>

#include "subdiv/mesh.h"

namespace limn {

/// Wavefront OBJ from text, in double precision: v (with colours), vn, f (negative indices, n-gons), g, o, usemtl, and the subdivision
/// tags `t crease | corner | interpolateboundary`. Everything else is skipped. Our own reader rather than a library's, because the
/// libraries read "nan" as 0, drop faces they do not like, cut n-gons at 255 corners and cannot say in which line the fault is.
/// Throws InputError with file:line.
Mesh parse_obj(std::string_view text, const std::string& file, std::int64_t max_elements);

}  // namespace limn
