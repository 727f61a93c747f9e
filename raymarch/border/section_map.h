#pragma once
// A section map: a colour for each pixel that changes where an artist wants a line and nowhere else. Edge methods read it as their custom
// source; GBuffer::custom holds one that the caller has made.

#include "raymarch/border.h"

namespace limn {

/// What tells one section from the next.
enum class SectionSource {
  vertex_colors,  ///< The mesh's vertex colours, interpolated over each face by mean value coordinates (Floater 2003).
  groups,         ///< The mesh's face groups: neighbours differ by 1 or more. Objects without a mesh are one group.
  position,       ///< Cells of a world grid: neighbouring cells differ by 1 in one component.
};

struct SectionMap {
  Image<glm::vec3> sections{};  ///< The G-buffer's size; 0 where nothing is hit.
  std::string missing{};        ///< Empty, or what the objects lack ("no object has vertex colours"): then the map is 0 everywhere.
};

/// `cell_size` (world, > 0) is read for `position` alone.
SectionMap section_map(const BorderInput& input, SectionSource source, double cell_size);

}  // namespace limn
