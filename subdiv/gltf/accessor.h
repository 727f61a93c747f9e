#pragma once
// Internal: the numbers that an accessor of a glTF document names.

#include <cstdint>
#include <vector>

#include "subdiv/gltf/document.h"

namespace limn::gltf {

/// `components` numbers for each of `count` elements. Integers that are marked as normalised are 0 to 1 or -1 to 1.
struct Elements {
  size_t count = 0;
  int components = 0;
  std::vector<double> values{};
  glm::dvec3 vec3(size_t i) const { return {values[i * stride()], values[i * stride() + 1], values[i * stride() + 2]}; }
  size_t stride() const { return static_cast<size_t>(components); }
};

/// SCALAR 1, VEC2 2, VEC3 3, VEC4 4; 0 where the accessor is missing or of another type. Asks for nothing else.
int components_of(const Document& document, std::uint64_t accessor);
/// How many elements it has; 0 where it is missing.
std::uint64_t count_of(const Document& document, std::uint64_t accessor);

/// Refuses what does not lie within its buffer. `where` names what asks for it.
Elements read_elements(Document& document, std::uint64_t accessor, const std::string& where);
/// The same for indices: one unsigned whole number each.
std::vector<std::uint32_t> read_indices(Document& document, std::uint64_t accessor, const std::string& where);

}  // namespace limn::gltf
