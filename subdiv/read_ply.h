#pragma once

#include <string>
#include <string_view>

#include "subdiv/mesh.h"

namespace limn {

/// PLY from bytes, ASCII and binary of either byte order: vertices with normals and colours (stored as a screen shows them, sRGB), faces
/// of any size, triangle strips. Other elements and properties are skipped. Throws InputError for a damaged header, data that break off
/// and files without faces.
Mesh parse_ply(std::string_view bytes, const std::string& file, std::int64_t max_elements);

}  // namespace limn
