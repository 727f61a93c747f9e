#include "sdf/tape_scalar.h"

#include "sdf/field_program.h"

namespace limn {
namespace {

template <class T>
T lane_of(TapeNumber number, const double* from, int i) {
  const auto component = [&](int k) { return from[k * kLanes + i]; };
  if constexpr (std::is_same_v<T, double>) {
    return component(0);
  } else if constexpr (std::is_same_v<T, Dual>) {
    Dual result{component(0), {component(1), 0.0, 0.0}};
    if (number == TapeNumber::gradient) result.gradient = {component(1), component(2), component(3)};
    return result;
  } else if constexpr (std::is_same_v<T, Jet>) {
    Jet result{component(0), {component(1), component(2), component(3)}, {}};
    for (int k = 0; k < 6; ++k) result.hessian[static_cast<size_t>(k)] = component(4 + k);
    return result;
  } else if constexpr (std::is_same_v<T, Interval>) {
    return {component(1), component(2)};
  } else {
    return {{component(1), component(2)}, {component(3), component(4)}};
  }
}

template <class T>
void put_lane(TapeNumber number, const T& from, int i, double* to) {
  const auto component = [&](int k) -> double& { return to[k * kLanes + i]; };
  if constexpr (std::is_same_v<T, double>) {
    component(0) = from;
  } else if constexpr (std::is_same_v<T, Dual>) {
    component(0) = from.value;
    for (int k = 0; k < (number == TapeNumber::gradient ? 3 : 1); ++k) component(1 + k) = from.gradient[static_cast<size_t>(k)];
  } else if constexpr (std::is_same_v<T, Jet>) {
    component(0) = from.value;
    for (int k = 0; k < 3; ++k) component(1 + k) = from.gradient[static_cast<size_t>(k)];
    for (int k = 0; k < 6; ++k) component(4 + k) = from.hessian[static_cast<size_t>(k)];
  } else if constexpr (std::is_same_v<T, Interval>) {
    component(1) = from.lower;
    component(2) = from.upper;
  } else {
    component(1) = from.value.lower;
    component(2) = from.value.upper;
    component(3) = from.slope.lower;
    component(4) = from.slope.upper;
  }
}

/// Calls `with` for each number type that makes up `number`.
template <class With>
void for_parts(TapeNumber number, const With& with) {
  if (number == TapeNumber::dual || number == TapeNumber::gradient) return with(Dual{});
  if (number == TapeNumber::jet) return with(Jet{});
  with(0.0);
  if (number == TapeNumber::bound) with(Interval{});
  if (number == TapeNumber::slope) with(Slope{});
}

}  // namespace

void shape_by_lane(const FieldLeaf& leaf, TapeNumber number, int lanes, const double* x, const double* y, const double* z, double* target) {
  for_parts(number, [&](auto kind) {
    using T = decltype(kind);
    T px[kLanes], py[kLanes], pz[kLanes], values[kLanes];
    for (int i = 0; i < lanes; ++i) {
      px[i] = lane_of<T>(number, x, i);
      py[i] = lane_of<T>(number, y, i);
      pz[i] = lane_of<T>(number, z, i);
    }
    std::get<ShapeFunction<T>>(leaf.functions->evaluate)(leaf.shape.get(), px, py, pz, values, static_cast<size_t>(lanes));
    for (int i = 0; i < lanes; ++i) put_lane(number, values[i], i, target);
  });
}

}  // namespace limn
