#pragma once
// A number type that records what is done to it. Include sdf/number.h.

#include <cstdint>
#include <vector>

#include "sdf/number.h"
#include "sdf/tape.h"

namespace limn {

/// One step for each value; 0, 1 and 2 are the point's coordinates. Steps name values here, not registers.
struct Recording {
  std::vector<TapeStep> steps{};
  static constexpr std::uint32_t kCoordinates = 3;
  std::uint32_t append(TapeStep step) {
    step.target = static_cast<std::uint32_t>(steps.size()) + kCoordinates;
    steps.push_back(step);
    return step.target;
  }
};

/// A recorded value, or a constant where nothing is recorded yet.
struct Recorded {
  Recording* recording = nullptr;
  std::uint32_t id = 0;
  double value = 0.0;
};

template <>
inline Recorded constant<Recorded>(double x) {
  return {nullptr, 0, x};
}

namespace recorded {
inline std::uint32_t id_in(Recording& recording, const Recorded& a) {
  if (a.recording) return a.id;
  return recording.append({.operation = TapeOperation::constant, .constant = a.value});
}
inline Recorded one(TapeOperation operation, const Recorded& a, double constant = 0.0) {
  return {a.recording, a.recording->append({.operation = operation, .a = a.id, .constant = constant}), 0.0};
}
inline Recorded two(TapeOperation operation, const Recorded& a, const Recorded& b, double constant = 0.0) {
  Recording& r = a.recording ? *a.recording : *b.recording;
  const std::uint32_t ia = id_in(r, a), ib = id_in(r, b);
  return {&r, r.append({.operation = operation, .a = ia, .b = ib, .constant = constant}), 0.0};
}
inline Recorded three(TapeOperation operation, const Recorded& a, const Recorded& b, const Recorded& c) {
  Recording& r = a.recording ? *a.recording : b.recording ? *b.recording : *c.recording;
  const std::uint32_t ia = id_in(r, a), ib = id_in(r, b), ic = id_in(r, c);
  return {&r, r.append({.operation = operation, .a = ia, .b = ib, .c = ic}), 0.0};
}
}  // namespace recorded

inline Recorded operator-(const Recorded& a) { return recorded::one(TapeOperation::negate, a); }
inline Recorded operator+(const Recorded& a, double b) { return recorded::one(TapeOperation::add_constant, a, b); }
inline Recorded operator-(const Recorded& a, double b) { return recorded::one(TapeOperation::add_constant, a, -b); }
inline Recorded operator*(const Recorded& a, double b) { return recorded::one(TapeOperation::multiply_constant, a, b); }
inline Recorded operator+(const Recorded& a, const Recorded& b) { return recorded::two(TapeOperation::add, a, b); }
inline Recorded operator-(const Recorded& a, const Recorded& b) { return recorded::two(TapeOperation::subtract, a, b); }
inline Recorded operator*(const Recorded& a, const Recorded& b) { return recorded::two(TapeOperation::multiply, a, b); }
inline Recorded square(const Recorded& a) { return recorded::one(TapeOperation::square, a); }
inline Recorded abs(const Recorded& a) { return recorded::one(TapeOperation::absolute, a); }
inline Recorded sine(const Recorded& a) { return recorded::one(TapeOperation::sine, a); }
inline Recorded cosine(const Recorded& a) { return recorded::one(TapeOperation::cosine, a); }
inline Recorded minimum(const Recorded& a, const Recorded& b) { return recorded::two(TapeOperation::minimum, a, b); }
inline Recorded maximum(const Recorded& a, const Recorded& b) { return recorded::two(TapeOperation::maximum, a, b); }
inline Recorded norm(const Recorded& a, const Recorded& b) { return recorded::two(TapeOperation::norm2, a, b); }
inline Recorded norm(const Recorded& a, const Recorded& b, const Recorded& c) { return recorded::three(TapeOperation::norm3, a, b, c); }
inline Recorded corner_distance(const Recorded& a, const Recorded& b) { return recorded::two(TapeOperation::corner2, a, b); }
inline Recorded corner_distance(const Recorded& a, const Recorded& b, const Recorded& c) {
  return recorded::three(TapeOperation::corner3, a, b, c);
}
inline Recorded power_norm(const Recorded& a, const Recorded& b, double power) {
  return recorded::two(TapeOperation::power_norm, a, b, power);
}
inline Recorded smooth_minimum(const Recorded& a, const Recorded& b, double radius) {
  return recorded::two(TapeOperation::smooth_minimum, a, b, radius);
}

}  // namespace limn
