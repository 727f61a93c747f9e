#pragma once

#include <string>
#include <string_view>

#include "subdiv/mesh.h"

namespace limn {

/// Geomview's OFF from bytes, ASCII or binary: with normals, colours or texture coordinates of vertices (NOFF, COFF, STOFF in any
/// combination), with homogeneous coordinates (4OFF) or up to three dimensions (nOFF), without its first word; comments anywhere. Colours
/// of faces are read past. Throws InputError with the line.
Mesh parse_off(std::string_view bytes, const std::string& file, std::int64_t max_elements);

}  // namespace limn
