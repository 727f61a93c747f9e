#pragma once
// Internal: which SIMD targets limn is compiled for. Include before <hwy/highway.h> and <hwy/foreach_target.h>, in .cpp files only.
// Baseline x86-64 (SSE2), AVX2 and AVX-512, or whatever the architecture has (NEON); the widest one that the machine has is chosen when
// the program runs. No target fuses multiply and add (-ffp-contract=off, hn::Mul and hn::Add): all of them give the same bits.

#if !LIMN_SIMD
#define HWY_COMPILE_ONLY_EMU128 1  // Plain loops: what the others are checked against.
#else
// Vectors whose length is known only when the program runs cannot be members of structs: there NEON does it.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#endif
