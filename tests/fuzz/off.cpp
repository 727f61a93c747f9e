// OFF as it comes from a file.
#include "subdiv/read_off.h"
#include "tests/fuzz/mesh_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  limn::fuzz::only_refused([&] { limn::fuzz::use_mesh(limn::parse_off, data, size); });
  return 0;
}
