// Calls of many pictures take no more memory than those of a few.

#include <gtest/gtest.h>

#include "tests/samples/run_program.h"
#include "tests/temporary_folder.h"

namespace limn::test {
namespace {

double peak_bytes(const char* kind, int pictures, const std::string& size) {
  const TemporaryFolder folder;
  const RunResult result = run_limn({"render", "ellipsoid", "--surface", "analytic", "--size", size, "--samples", "1", kind,
                                     std::to_string(pictures), "-q", "-o", folder.file("a.png")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.peak_bytes;
}

TEST(MemoryGrowth, ManyPicturesTakeAsMuchAsAFew) {
  // Sizes whose layers are smaller than large pages and larger.
  for (const char* size : {"960x540", "1600x900"})
    for (const char* kind : {"--views", "--turntable"}) {
      const double few = peak_bytes(kind, 8, size), many = peak_bytes(kind, 80, size);
      EXPECT_GT(few, 1e6);
      EXPECT_LT(many, few + 12e6) << kind << " " << size;
    }
}

}  // namespace
}  // namespace limn::test
