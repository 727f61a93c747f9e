// Internal: steps of a tape that choose among their operands, and what they note of it. Included once a SIMD target, after <hwy/highway.h>.
#if defined(LIMN_TAPE_CHOICES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_TAPE_CHOICES_INL_H
#undef LIMN_TAPE_CHOICES_INL_H
#else
#define LIMN_TAPE_CHOICES_INL_H
#endif

#include "sdf/tape_pass-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {

/// Lanes in which an operand has no influence.
struct Idle {
  LaneMask a, b;
};
template <class T>
HWY_INLINE Idle idle_of(const T& a, const T& b, const TapeStep& step, double margin) {
  const bool lesser = step.operation == TapeOperation::minimum || step.operation == TapeOperation::smooth_minimum;
  const bool smooth = step.operation == TapeOperation::smooth_minimum || step.operation == TapeOperation::smooth_maximum;
  const double gap = smooth ? step.constant * (1.0 + 1e-12) : 0.0;
  const LaneMask a_below = a.value.upper + gap < b.value.lower, b_below = b.value.upper + gap < a.value.lower;
  if (!step.sign_decides) return lesser ? Idle{b_below, a_below} : Idle{a_below, b_below};
  if (lesser) return {either(b_below, a.value.lower > reals(margin)), either(a_below, b.value.lower > reals(margin))};
  return {either(a_below, a.value.upper < reals(-margin)), either(b_below, b.value.upper < reals(-margin))};
}
HWY_INLINE void add(LaneMask mask, int part, std::uint16_t& bits) {
  bits = static_cast<std::uint16_t>(bits | bits_of(mask) << (part * kWidth));
}

template <class T>
HWY_INLINE T chosen(const T& a, const T& b, const TapeStep& step) {
  switch (step.operation) {
    case TapeOperation::minimum:
      return minimum(a, b);
    case TapeOperation::maximum:
      return maximum(a, b);
    case TapeOperation::smooth_minimum:
      return smooth_minimum(a, b, step.constant);
    default:
      return -smooth_minimum(-a, -b, step.constant);
  }
}

/// Of values, what TapeChoice says of bounds: lanes in which jets take one operand as it is, whatever the other.
HWY_INLINE void note_choice(const Reals& a, const Reals& b, const TapeStep& step, int part, TapeChoice& choice) {
  const bool lesser = step.operation == TapeOperation::minimum || step.operation == TapeOperation::smooth_minimum;
  const bool smooth = step.operation == TapeOperation::smooth_minimum || step.operation == TapeOperation::smooth_maximum;
  LaneMask of_a = lesser ? a < b : a > b, of_b = no(of_a);
  if (smooth) {
    // -smooth_minimum(-a, -b) is the greater one where there is no blend, and of equal ones b, as of two minima.
    const LaneMask apart = (reals(step.constant) - abs(a - b)) / reals(step.constant) <= reals(0.0);
    of_a = both(of_a, apart);
    of_b = both(of_b, apart);
  }
  add(of_b, part, choice.idle[0]);
  add(of_a, part, choice.idle[1]);
}

template <class T, bool kNotes, class Runner>
void run_choice(const Runner& runner, const TapeStep& step, TapeChoice* choice) {
  for (int part = 0; part < Runner::kUsed; ++part) {
    const T a = runner.read(step.a, part), b = runner.read(step.b, part);
    T result = chosen(a, b, step);
    if constexpr (kNotes) note_choice(a, b, step, part, *choice);
    if constexpr (kBounding<T>) {
      const Idle idle = idle_of(a, b, step, runner.pass.tape->margin);
      add(idle.a, part, choice->idle[0]);
      add(idle.b, part, choice->idle[1]);
      // Slopes are those of what pruning leaves.
      if constexpr (Kind<T>::kNumber == TapeNumber::slope) {
        if (step.sign_decides) result.slope = select(idle.b, a.slope, select(idle.a, b.slope, result.slope));
      }
    }
    runner.write(step.target, part, result);
  }
}

template <class T, bool kNotes, class Runner>
void run_absolute(const Runner& runner, const TapeStep& step, TapeChoice* choice) {
  for (int part = 0; part < Runner::kUsed; ++part) {
    const T a = runner.read(step.a, part);
    if constexpr (kBounding<T>) {
      add(a.value.upper < reals(0.0), part, choice->idle[0]);
      add(a.value.lower > reals(0.0), part, choice->idle[1]);
    }
    if constexpr (kNotes) {
      const LaneMask negative = a < reals(0.0);
      add(negative, part, choice->idle[0]);
      add(no(negative), part, choice->idle[1]);
    }
    runner.write(step.target, part, abs(a));
  }
}

/// As note_choice; of three where no two are equal.
HWY_INLINE void note_corner(const Reals& a, const Reals& b, const Reals& c, bool three, int part, TapeChoice& choice) {
  const Reals zero = reals(0.0);
  if (!three) {
    const LaneMask a_below = a <= zero, greater = a > b;
    add(both(a_below, no(greater)), part, choice.idle[0]);
    add(either(both(a_below, greater), both(no(a_below), b <= zero)), part, choice.idle[1]);
    return;
  }
  const Reals greatest = maximum(maximum(a, b), c);
  const LaneMask equal = either(LaneMask{hn::Eq(a.v, b.v)}, either(LaneMask{hn::Eq(b.v, c.v)}, LaneMask{hn::Eq(a.v, c.v)}));
  const auto idle = [&](const Reals& x) { return both(no(equal), both(x <= zero, x < greatest)); };
  add(idle(a), part, choice.idle[0]);
  add(idle(b), part, choice.idle[1]);
  add(idle(c), part, choice.idle[2]);
}

/// Of a distance to a corner only the greatest part matters where the others are negative.
template <class T, bool kNotes, class Runner>
void run_corner(const Runner& runner, const TapeStep& step, TapeChoice* choice) {
  const bool three = step.operation == TapeOperation::corner3;
  for (int part = 0; part < Runner::kUsed; ++part) {
    const T a = runner.read(step.a, part), b = runner.read(step.b, part);
    const T c = three ? runner.read(step.c, part) : a;
    if constexpr (kBounding<T>) {
      const Reals zero = reals(0.0);
      const Reals greatest = maximum(maximum(a.value.lower, b.value.lower), c.value.lower);
      const auto idle = [&](const T& x) { return both(x.value.upper <= zero, x.value.upper < greatest); };
      add(idle(a), part, choice->idle[0]);
      add(idle(b), part, choice->idle[1]);
      if (three) add(idle(c), part, choice->idle[2]);
    }
    if constexpr (kNotes) note_corner(a, b, c, three, part, *choice);
    runner.write(step.target, part, three ? corner_distance(a, b, c) : corner_distance(a, b));
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#endif
