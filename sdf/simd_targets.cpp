// Which SIMD targets the machine has: the functions of Highway's library that its headers ask for. The library measures the clock for 4 ms
// whenever a program starts, as long as all else that a call starts with; with these it need not be linked.

#include <cstdarg>
#include <cstdio>
#include <cstdlib>

#include "sdf/simd.h"
// clang-format off: which targets, before the header that asks.
#include <hwy/highway.h>
// clang-format on

#if HWY_ARCH_X86
#include <cpuid.h>
#endif

namespace {

#if HWY_ARCH_X86
/// Two of AVX2's companions that not every compiler's __builtin_cpu_supports() knows by name (Intel 64 and IA-32 manual, volume 2, CPUID).
bool has_lzcnt_and_f16c() {
  constexpr unsigned kF16c = 1u << 29, kLzcnt = 1u << 5;
  unsigned a = 0, b = 0, c = 0, d = 0, extended = 0;
  if (__get_cpuid(1, &a, &b, &c, &d) == 0 || __get_cpuid(0x80000001u, &a, &b, &extended, &d) == 0) return false;
  return (c & kF16c) != 0 && (extended & kLzcnt) != 0;
}

std::int64_t targets_of_machine() {
  __builtin_cpu_init();  // asks, too, whether the operating system keeps the wide registers
  const bool with_fma = __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  if (!(__builtin_cpu_supports("avx2") && with_fma && has_lzcnt_and_f16c())) return HWY_STATIC_TARGET;
  const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512vl") &&
                    __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  return HWY_STATIC_TARGET | HWY_AVX2 | (wide ? HWY_AVX3 : 0);
}
#else
/// What the compiler may take for granted anywhere, as NEON on 64-bit ARM.
std::int64_t targets_of_machine() { return HWY_STATIC_TARGET; }
#endif

}  // namespace

namespace hwy {

/// Where one of Highway's own checks fails: they are there in debug builds and under sanitizers.
void Abort(const char* file, int line, const char* format, ...) {
  std::fprintf(stderr, "%s:%d: ", file, line);
  std::va_list arguments;
  va_start(arguments, format);
  std::vfprintf(stderr, format, arguments);
  va_end(arguments);
  std::fputc('\n', stderr);
  std::abort();
}

std::int64_t SupportedTargets() { return targets_of_machine() | HWY_EMU128 | HWY_SCALAR; }

ChosenTarget& GetChosenTarget() {
  static ChosenTarget chosen;
  return chosen;
}

}  // namespace hwy
