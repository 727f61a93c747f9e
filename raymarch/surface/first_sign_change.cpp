#include <cmath>

#include "raymarch/level_set/level_set_marcher.h"

namespace limn {
namespace {

double value_at(const std::array<double, 4>& c, double s) { return ((c[3] * s + c[2]) * s + c[1]) * s + c[0]; }
double slope_at(const std::array<double, 4>& c, double s) { return (3.0 * c[3] * s + 2.0 * c[2]) * s + c[1]; }

/// Places in (0, 1) where the slope vanishes, ascending: between them the cubic is monotone.
int turning_points(const std::array<double, 4>& c, std::array<double, 2>& places) {
  const double a = 3.0 * c[3], half_b = c[2], d = c[1];
  const double discriminant = half_b * half_b - a * d;
  if (!(discriminant > 0.0)) return 0;
  // The form without cancellation: q and its partner d / q (Press et al., Numerical Recipes, 5.6).
  const double q = -(half_b + std::copysign(std::sqrt(discriminant), half_b));
  const std::array<double, 2> candidates{a != 0.0 ? q / a : -1.0, q != 0.0 ? d / q : -1.0};
  int count = 0;
  for (const double s : candidates)
    if (s > 0.0 && s < 1.0) places[static_cast<size_t>(count++)] = s;
  if (count == 2 && places[0] > places[1]) std::swap(places[0], places[1]);
  return count;
}

/// The one root between `low`, on the old side, and `high`, on the new one: Newton's steps, replaced by bisection where they leave the
/// bracket or gain too little.
double bracketed_root(const std::array<double, 4>& c, double low, double high, bool inside) {
  double s = 0.5 * (low + high);
  for (int step = 0; step < 80; ++step) {
    const double value = value_at(c, s);
    if ((value < 0.0) == inside) {
      low = s;
    } else {
      high = s;
    }
    const double newton = s - value / slope_at(c, s);
    const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
    if (std::abs(next - s) <= 1e-15 || !(low < high)) return next;
    s = next;
  }
  return high;
}

}  // namespace

double first_sign_change(const std::array<double, 4>& c, bool inside) {
  if ((c[0] < 0.0) != inside) return 0.0;
  std::array<double, 2> turns{};
  const int count = turning_points(c, turns);
  double low = 0.0;
  for (int piece = 0; piece <= count; ++piece) {
    const double high = piece < count ? turns[static_cast<size_t>(piece)] : 1.0;
    if ((value_at(c, high) < 0.0) != inside) return bracketed_root(c, low, high, inside);
    low = high;
  }
  return -1.0;
}

}  // namespace limn
