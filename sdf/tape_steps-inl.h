// Internal: runs the steps of a tape, for any number of lanes' numbers. Included once a SIMD target, after <hwy/highway.h>.
#if defined(LIMN_TAPE_STEPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_TAPE_STEPS_INL_H
#undef LIMN_TAPE_STEPS_INL_H
#else
#define LIMN_TAPE_STEPS_INL_H
#endif

#include <algorithm>
#include <concepts>
#include <span>

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

/// `Used` vectors of a register's lanes are filled. Only numbers of one component have more than sixteen lanes.
template <class T, int Used>
struct Runner {
  static_assert(Used <= kParts || Kind<T>::kComponents == 1);
  static constexpr int kUsed = Used;
  static constexpr int kSize = Kind<T>::kComponents * std::max(kLanes, Used* kWidth);
  const Pass& pass;
  double* registers;

  HWY_INLINE double* at(std::uint32_t index, int part) const { return registers + index * kSize + part * kWidth; }
  HWY_INLINE T read(std::uint32_t index, int part) const {
    T a;
    get(at(index, part), a);
    return a;
  }
  HWY_INLINE void write(std::uint32_t index, int part, const T& a) const { put(a, at(index, part)); }
  /// Of jets without second derivatives what else they have.
  HWY_INLINE LaneGradient read_flat(std::uint32_t index, int part) const {
    LaneGradient a;
    get(at(index, part), a);
    return a;
  }
  HWY_INLINE void write_flat(const TapeStep& step, int part, const LaneGradient& a) const {
    double* const to = at(step.target, part);
    put(a, to);
    for (int i = LaneGradient::kComponents; !step.bare && i < LaneJet::kComponents; ++i) store(reals(0.0), to + i * kLanes);
  }
};

#define LIMN_STEP(expression)                        \
  for (int part = 0; part < Runner::kUsed; ++part) { \
    const T a = runner.read(step.a, part);           \
    runner.write(step.target, part, expression);     \
  }                                                  \
  break
#define LIMN_STEP2(expression)                                            \
  for (int part = 0; part < Runner::kUsed; ++part) {                      \
    const T a = runner.read(step.a, part), b = runner.read(step.b, part); \
    runner.write(step.target, part, expression);                          \
  }                                                                       \
  break
#define LIMN_STEP3(expression)                                            \
  for (int part = 0; part < Runner::kUsed; ++part) {                      \
    const T a = runner.read(step.a, part), b = runner.read(step.b, part); \
    const T c = runner.read(step.c, part);                                \
    runner.write(step.target, part, expression);                          \
  }                                                                       \
  break

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

#define LIMN_FLAT(expression)                              \
  for (int part = 0; part < Runner::kUsed; ++part) {       \
    const LaneGradient a = runner.read_flat(step.a, part); \
    runner.write_flat(step, part, expression);             \
  }                                                        \
  return true
#define LIMN_FLAT2(expression)                             \
  for (int part = 0; part < Runner::kUsed; ++part) {       \
    const LaneGradient a = runner.read_flat(step.a, part); \
    const LaneGradient b = runner.read_flat(step.b, part); \
    expression;                                            \
  }                                                        \
  return true

/// A step of jets without second derivatives, which are not read then; false where it is run like any other.
template <class Runner>
bool run_flat(const Runner& runner, const TapeStep& step) {
  switch (step.operation) {
    case TapeOperation::negate:
      LIMN_FLAT(-a);
    case TapeOperation::add_constant:
      LIMN_FLAT(a + step.constant);
    case TapeOperation::multiply_constant:
      LIMN_FLAT(a * step.constant);
    case TapeOperation::add:
      LIMN_FLAT2(runner.write_flat(step, part, a + b));
    case TapeOperation::subtract:
      LIMN_FLAT2(runner.write_flat(step, part, a - b));
    case TapeOperation::norm2:
      LIMN_FLAT2(runner.write(step.target, part, norm_of<LaneJet, 2, LaneGradient>({&a, &b})));
    case TapeOperation::norm3:
      LIMN_FLAT2(const LaneGradient c = runner.read_flat(step.c, part);
                 runner.write(step.target, part, norm_of<LaneJet, 3, LaneGradient>({&a, &b, &c})));
    default:  // as runs_flat() has it
      return false;
  }
}
#undef LIMN_FLAT
#undef LIMN_FLAT2

/// `kNotes`: of values, too, what choices say.
template <class T, int Used, bool kNotes = false>
void run_steps(const Pass& pass, std::span<const TapeStep> steps, double* registers) {
  using Runner = Runner<T, Used>;
  const Runner runner{pass, registers};
  TapeChoice* choice = pass.choices;
  for (const TapeStep& step : steps) {
    if constexpr (std::same_as<T, LaneJet>)
      if (step.flat && run_flat(runner, step)) continue;
    switch (step.operation) {
      case TapeOperation::coordinates:
        for (int axis = 0; axis < 3; ++axis) {
          if (!(step.axes >> axis & 1)) continue;
          for (int part = 0; part < Runner::kUsed; ++part) {
            const std::uint32_t target = step.target + static_cast<std::uint32_t>(axis);
            if constexpr (std::same_as<T, LaneJet>)
              if (step.bare) {
                LaneGradient x;
                coordinate(pass, pass.tape->leaves[step.leaf], axis, part * kWidth, x);
                put(x, runner.at(target, part));
                continue;
              }
            T x;
            coordinate(pass, pass.tape->leaves[step.leaf], axis, part * kWidth, x);
            runner.write(target, part, x);
          }
        }
        break;
      case TapeOperation::shape:
        for (int part = 0; part < Used; part += kParts)
          shape_by_lane(*pass.tape->leaves[step.leaf].leaf, Kind<T>::kNumber, std::min(Used, kParts) * kWidth, runner.at(step.a, part),
                        runner.at(step.b, part), runner.at(step.c, part), runner.at(step.target, part));
        break;
      case TapeOperation::narrow:
        if constexpr (kBounding<T>) {
          for (int part = 0; part < Runner::kUsed; ++part) {
            T a = runner.read(step.a, part);
            narrow(pass, pass.tape->leaves[step.leaf], part * kWidth, a);
            runner.write(step.target, part, a);
          }
        }
        break;
      case TapeOperation::constant:
        for (int part = 0; part < Runner::kUsed; ++part) runner.write(step.target, part, constant_of<T>(step.constant));
        break;
      case TapeOperation::copy:
        LIMN_STEP(a);
      case TapeOperation::negate:
        LIMN_STEP(-a);
      case TapeOperation::square:
        LIMN_STEP(square(a));
      case TapeOperation::absolute:
        run_absolute<T, kNotes>(runner, step, choice);
        break;
      case TapeOperation::sine:
        LIMN_STEP(sine(a));
      case TapeOperation::cosine:
        LIMN_STEP(cosine(a));
      case TapeOperation::add_constant:
        LIMN_STEP(a + step.constant);
      case TapeOperation::multiply_constant:
        LIMN_STEP(a * step.constant);
      case TapeOperation::add:
        LIMN_STEP2(a + b);
      case TapeOperation::subtract:
        LIMN_STEP2(a - b);
      case TapeOperation::multiply:
        LIMN_STEP2(a * b);
      case TapeOperation::norm2:
        LIMN_STEP2(norm(a, b));
      case TapeOperation::norm3:
        LIMN_STEP3(norm(a, b, c));
      case TapeOperation::corner2:
      case TapeOperation::corner3:
        run_corner<T, kNotes>(runner, step, choice);
        break;
      case TapeOperation::power_norm:
        LIMN_STEP2(power_norm(a, b, step.constant));
      case TapeOperation::minimum:
      case TapeOperation::maximum:
      case TapeOperation::smooth_minimum:
      case TapeOperation::smooth_maximum:
        run_choice<T, kNotes>(runner, step, choice);
        break;
    }
    if constexpr (kBounding<T> || kNotes) ++choice;
  }
}
#undef LIMN_STEP
#undef LIMN_STEP2
#undef LIMN_STEP3

/// Sixteens of values that go through the steps together: one waits for roots and memory where the next one need not.
constexpr int kTogether = 4;

/// Values at kTogether times as many points.
inline const double* run_values_together(const Pass& pass, std::span<const TapeStep> steps, TapeScratch& scratch) {
  double* const registers = scratch.registers(registers_used(pass.tape->registers) * static_cast<size_t>(kTogether * kLanes));
  run_steps<Reals, kTogether * kParts>(pass, steps, registers);
  return registers;
}

template <class T>
const double* run_tape(Pass& pass, std::span<const TapeStep> steps, TapeScratch& scratch) {
  double* const registers = scratch.registers(registers_used(pass.tape->registers) * static_cast<size_t>(Kind<T>::kComponents * kLanes));
  if constexpr (kBounding<T>) {
    scratch.choices.assign(steps.size(), {});
    pass.choices = scratch.choices.data();
    constexpr int kHalf = kParts > 1 ? kParts / 2 : 1;
    if (pass.beams->lanes <= kHalf * kWidth) {
      run_steps<T, kHalf>(pass, steps, registers);
      return registers;
    }
  }
  run_steps<T, kParts>(pass, steps, registers);
  return registers;
}

/// Values alone, for what they say of the steps' choices: TapeScratch::choices.
inline void note_choices(Pass& pass, std::span<const TapeStep> steps, TapeScratch& scratch) {
  scratch.choices.assign(steps.size(), {});
  pass.choices = scratch.choices.data();
  run_steps<Reals, kParts, true>(
      pass, steps, scratch.registers(registers_used(pass.tape->registers) * static_cast<size_t>(Kind<Reals>::kComponents * kLanes)));
}

HWY_INLINE void take(const double* from, LaneArray& to) {
  for (int i = 0; i < kLanes; i += kWidth) store(load(from + i), to.lane + i);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#endif
