// What limn-read-mesh sends, had a file taken that helper over.
#include "subdiv/mesh_bytes.h"
#include "tests/fuzz/fuzz_target.h"

namespace limn {
namespace {

void use(std::span<const std::byte> bytes) {
  ByteReader reader(bytes, "fuzz.ply");
  const Mesh mesh = get_mesh(reader);
  validate(mesh, "fuzz.ply");
  fuzz::require(bounds(mesh).finite(), "an accepted mesh without bounds");
  triangulate(mesh, NormalKind::vertex, true);

  ByteWriter writer;
  put_mesh(writer, mesh);
  fuzz::require(writer.size() <= bytes.size(), "a mesh that holds more than was sent");
}

}  // namespace
}  // namespace limn

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  limn::fuzz::only_refused([&] { limn::use({reinterpret_cast<const std::byte*>(data), size}); });
  return 0;
}
