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

#include "sdf/error.h"
#include "sdf/tape_choices-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {

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
  /// Of a jet all but its second derivatives, which it has none of.
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

#define LIMN_FLAT(expression)                              \
  for (int part = 0; part < Runner::kUsed; ++part) {       \
    const LaneGradient a = runner.read_flat(step.a, part); \
    runner.write_flat(step, part, expression);             \
  }                                                        \
  break
#define LIMN_FLAT2(expression)                             \
  for (int part = 0; part < Runner::kUsed; ++part) {       \
    const LaneGradient a = runner.read_flat(step.a, part); \
    const LaneGradient b = runner.read_flat(step.b, part); \
    expression;                                            \
  }                                                        \
  break

/// A step of jets without second derivatives, which are not read: one of those of which runs_flat() is true.
template <class Runner>
void run_flat(const Runner& runner, const TapeStep& step) {
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
    default:
      LIMN_CHECK(!step.flat);  // no other is marked so
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
      if (step.flat) {
        run_flat(runner, step);
        continue;
      }
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
