// glTF and GLB, with all of their data inside: there are no files beside them.
#include "subdiv/read_gltf.h"
#include "tests/fuzz/fuzz_target.h"

namespace limn {
namespace {

constexpr std::int64_t kMostElements = 100'000;

void use(std::span<const std::byte> bytes) {
  const std::optional<Mesh> mesh = parse_gltf(bytes, "/nowhere", kMostElements);
  if (!mesh) return;
  validate(*mesh, "fuzz.gltf");
  fuzz::require(static_cast<std::int64_t>(mesh->vertex_count() + mesh->corner_vertices.size()) <= kMostElements, "more than allowed");
  triangulate(*mesh, NormalKind::vertex, true);
}

}  // namespace
}  // namespace limn

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  limn::fuzz::only_refused([&] { limn::use({reinterpret_cast<const std::byte*>(data), size}); });
  return 0;
}
