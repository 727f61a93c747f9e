// What limn-read-vdb sends, had a file taken that helper over: the list of grids, a grid, all of them.
#include <cmath>
#include <vector>

#include "sdf/level_set_data.h"
#include "sdf/read_vdb.h"
#include "tests/fuzz/fuzz_target.h"

namespace limn {
namespace {

void use_grid(std::span<const std::byte> bytes) {
  const LevelSet level_set(level_set_from_answer(bytes, "fuzz.vdb"));
  fuzz::require(level_set.info().bounds.finite() && level_set.info().active_voxels > 0, "an accepted level set without a surface");
  const glm::dvec3 center = level_set.info().bounds.center();
  double value = 0.0;
  level_set_values(level_set, std::span(&center, 1), std::span(&value, 1));
  fuzz::require(std::isfinite(value), "an accepted level set with a value that is no number");
}

}  // namespace
}  // namespace limn

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  // The first byte says which of the three was asked for.
  // In memory of their own: answers begin at a page, and their elements lie where such may.
  const auto* const first = reinterpret_cast<const std::byte*>(data) + 1;
  const std::vector<std::byte> own(first, first + size - 1);
  const std::span<const std::byte> bytes(own);
  limn::fuzz::only_refused([&] {
    if (data[0] % 4 == 2) {
      limn::vdb_file_from_answer(bytes, "fuzz.vdb");
    } else if (data[0] % 4 == 0) {
      limn::grids_from_answer(bytes, "fuzz.vdb");
    } else {
      limn::use_grid(bytes);
    }
  });
  return 0;
}
