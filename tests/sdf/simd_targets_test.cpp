// Which SIMD targets the machine has, against what Highway's own library says.

#include <dlfcn.h>
#include <gtest/gtest.h>

#include "tests/simd_targets.h"

namespace limn {
namespace {

TEST(SimdTargets, AreThoseThatHighwaysLibraryFinds) {
  void* const library = ::dlopen("libhwy.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) GTEST_SKIP() << ::dlerror();
  const auto theirs = reinterpret_cast<std::int64_t (*)()>(::dlsym(library, "_ZN3hwy16SupportedTargetsEv"));
  ASSERT_NE(theirs, nullptr);
  EXPECT_EQ(hwy::SupportedTargets() & HWY_TARGETS, theirs() & HWY_TARGETS);
  ::dlclose(library);
}

size_t index_of(std::int64_t targets) {
  hwy::ChosenTarget chosen;
  chosen.Update(targets);
  return chosen.GetIndex();
}

TEST(SimdTargets, TheWidestIsChosenAndAnyOtherCanBeAskedFor) {
  const std::int64_t all = hwy::SupportedTargets() & HWY_TARGETS;
  std::vector<size_t> asked;
  test::for_each_simd_target([&](const char*) { asked.push_back(hwy::GetChosenTarget().GetIndex()); });
  // Lower bits are wider targets.
  std::vector<size_t> expected;
  for (std::int64_t left = all; left != 0; left &= left - 1) expected.push_back(index_of(left & -left));
  EXPECT_EQ(asked, expected);
  EXPECT_EQ(hwy::GetChosenTarget().GetIndex(), index_of(all & -all)) << "the widest one again";
}

}  // namespace
}  // namespace limn
