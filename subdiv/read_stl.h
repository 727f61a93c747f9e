#pragma once

#include <string>
#include <string_view>

#include "subdiv/mesh.h"

namespace limn {

/// STL from bytes, ASCII (keywords in any case, several solids as groups) and binary (whatever its header begins with). Corners with equal
/// coordinates become one vertex, since the format has no indices; facet normals and colours are not kept. Throws InputError for files
/// that hold less than they announce, for damaged text (with the line) and for files without facets.
Mesh parse_stl(std::string_view bytes, const std::string& file, std::int64_t max_elements);

}  // namespace limn
