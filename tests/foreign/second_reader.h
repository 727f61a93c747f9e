#pragma once
// Mesh files as programs that are not ours read them: CGAL for .obj .off .ply .stl, assimp for glTF.

#include <filesystem>
#include <string>
#include <vector>

#include "subdiv/mesh.h"

namespace limn::foreign {

/// Polygons as another reader sees them; in world coordinates, in double where the reader keeps it.
struct Soup {
  std::vector<glm::dvec3> positions{};
  std::vector<std::vector<size_t>> faces{};
};

/// Empty `refusal` where the other reader read it.
struct SecondReading {
  Soup soup{};
  std::string reader{};
  std::string refusal{};
};
SecondReading read_by_other(const std::filesystem::path& file);

Soup soup_of(const Mesh& mesh);

/// As OFF BINARY, by CGAL.
void write_binary_off(const Soup& soup, const std::filesystem::path& file);

/// What two readers of one file must agree on.
struct Measures {
  size_t used_vertices = 0;  ///< Different positions that faces stand on.
  size_t faces = 0;          ///< With an area, counted once for each corner polygon.
  Box box{};                 ///< Of the corners of faces.
  double area = 0.0;         ///< Sum of the lengths of the faces' vector areas.
};
Measures measure(const Soup& soup);

}  // namespace limn::foreign
