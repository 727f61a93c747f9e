#pragma once
// Internal: what ASCII and binary OFF files have in common.

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "subdiv/mesh.h"

namespace limn {

/// What the first word says of each vertex.
struct OffLayout {
  bool texture = false, color = false, normal = false, homogeneous = false, any_dimension = false;
};

/// [ST][C][N][4][n]OFF, in that order; false for any other word.
bool read_off_word(std::string_view word, OffLayout& layout);

/// A file as it was read: positions and faces in the mesh, colours and normals by vertex where the layout has them.
struct OffContents {
  Mesh mesh{};
  std::vector<glm::dvec3> colors{};
  std::vector<glm::vec3> normals{};
};

/// What a file may hold, and what it does hold of what its header promises. Both throw InputError.
struct OffLimits {
  const std::string& file;
  std::int64_t most = 0;  ///< Vertices and corners, together.
  std::int64_t elements = 0;

  OffLimits(const std::string& of, std::int64_t max_elements) : file(of), most(std::min<std::int64_t>(max_elements, INT32_MAX)) {}
  void count(std::int64_t more);
  [[noreturn]] void break_off(const char* what, std::int64_t read, std::int64_t promised) const;
};

/// Colours as light, normals by corner, faces repaired (subdiv/repair_faces.h).
Mesh finished(OffContents contents, const std::string& file);

/// The data of a file whose first line says BINARY.
struct OffBinary {
  OffLayout layout{};
  std::string_view data{};
};
std::optional<OffBinary> find_off_binary(std::string_view bytes);
Mesh parse_off_binary(const OffBinary& binary, const std::string& file, std::int64_t max_elements);

}  // namespace limn
