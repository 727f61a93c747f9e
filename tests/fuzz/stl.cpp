// STL as it comes from a file: read, checked, audited, triangulated.
#include "subdiv/audit.h"
#include "subdiv/read_stl.h"
#include "tests/fuzz/fuzz_target.h"

namespace limn {
namespace {

constexpr std::int64_t kMostElements = 100'000;

void use(std::string_view bytes) {
  const Mesh mesh = parse_stl(bytes, "fuzz.stl", kMostElements);
  validate(mesh, "fuzz.stl");
  mesh_facts(mesh);
  triangulate(mesh, NormalKind::vertex, true);
}

}  // namespace
}  // namespace limn

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  limn::fuzz::only_refused([&] { limn::use(limn::fuzz::text_of(data, size)); });
  return 0;
}
