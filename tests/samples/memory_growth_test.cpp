// Calls of many pictures take no more memory than those of a few, pictures of several samples no more than those of one, and level sets of
// meshes little more while they are made than they keep.

#include <gtest/gtest.h>

#include "tests/samples/run_program.h"
#include "tests/temporary_folder.h"

namespace limn::test {
namespace {

double peak_bytes(const std::string& size, int samples, const std::vector<std::string>& more) {
  const TemporaryFolder folder;
  std::vector<std::string> call{"render", "ellipsoid",         "--size", size, "--samples", std::to_string(samples), "-q",
                                "-o",     folder.file("a.png")};
  call.insert(call.end(), more.begin(), more.end());
  const RunResult result = run_limn(call);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.peak_bytes;
}

TEST(MemoryGrowth, ManyPicturesTakeAsMuchAsAFew) {
  // Sizes whose layers are smaller than large pages and larger.
  for (const char* size : {"960x540", "1600x900"})
    for (const char* kind : {"--views", "--turntable"}) {
      const double few = peak_bytes(size, 1, {"--surface", "analytic", kind, "8"}),
                   many = peak_bytes(size, 1, {"--surface", "analytic", kind, "80"});
      EXPECT_GT(few, 1e6);
      EXPECT_LT(many, few + 12e6) << kind << " " << size;
    }
}

TEST(MemoryGrowth, EightSamplesTakeAsMuchAsOne) {
  const std::vector<std::string> formula{"--surface", "analytic"};
  const double one = peak_bytes("1920x1080", 1, formula), eight = peak_bytes("1920x1080", 8, formula);
  EXPECT_GT(one, 1e6);
  EXPECT_LT(eight, one + 12e6);  // sums of the whole picture would be 33 MB
}

TEST(MemoryGrowth, OfLargeMeshesNoListsAreMadeForEightSamplesAtOnce) {
  // On one thread: of two, how many tiles wait at once differs from call to call, by up to 15 MB where others use the machine.
  const std::vector<std::string> mesh{"--surface", "mesh", "--level", "5", "--threads", "1"};
  const double one = peak_bytes("640x400", 1, mesh), eight = peak_bytes("640x400", 8, mesh);
  EXPECT_GT(one, 60e6);
  EXPECT_LT(eight, one + 12e6);  // lists for eight would be 80 MB
}

TEST(MemoryGrowth, BlocksOfAMeshsLevelSetAreGivenBackWhileItsGridIsWritten) {
  // Of more threads each holds a piece of its own. 197 MB are kept of the larger one; with all blocks beside the whole grid it takes 280 MB
  // more than the smaller one.
  const auto peak = [](const char* voxels) {
    return peak_bytes("64x64", 1, {"--surface", "mesh_level_set", "--level", "3", "--voxels", voxels, "--threads", "2"});
  };
  const double small = peak("128"), large = peak("1024");
  EXPECT_GT(large, small + 150e6);
  EXPECT_LT(large, small + 250e6);
}

}  // namespace
}  // namespace limn::test
