#pragma once
// The SIMD targets that a program was compiled for, one after the other.

#include "sdf/simd.h"
// clang-format off: which targets, before the header that asks.
#include <hwy/highway.h>
// clang-format on

#include <cstdint>

namespace limn::test {

/// Takes the widest target again when it goes.
class ChosenTarget {
 public:
  explicit ChosenTarget(std::int64_t target) { hwy::GetChosenTarget().Update(target); }
  ~ChosenTarget() { hwy::GetChosenTarget().Update(hwy::SupportedTargets()); }
  ChosenTarget(const ChosenTarget&) = delete;
  ChosenTarget& operator=(const ChosenTarget&) = delete;
};

/// Calls `with` with the name of each target, from the widest to the one that every machine has, while kernels run in it.
template <class With>
void for_each_simd_target(const With& with) {
  for (std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    const ChosenTarget chosen(target);
    with(hwy::TargetName(target));
  }
}

}  // namespace limn::test
