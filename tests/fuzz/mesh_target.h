#pragma once
// Mesh files as they come, as far as a render takes them before they meet a surface: read, checked, audited, triangulated.

#include "subdiv/mesh_audit.h"
#include "tests/fuzz/fuzz_target.h"

namespace limn::fuzz {

inline constexpr std::int64_t kMostElements = 100'000;

/// `parse`: parse_off and its like.
template <class Parse>
Mesh use_mesh(Parse&& parse, const std::uint8_t* data, std::size_t size) {
  Mesh mesh = parse(text_of(data, size), "fuzz", kMostElements);
  validate(mesh, "fuzz");
  mesh_facts(mesh);
  triangulate(mesh, NormalKind::vertex, true);
  return mesh;
}

}  // namespace limn::fuzz
