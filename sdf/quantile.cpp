#include "sdf/quantile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limn {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double at_place(std::vector<double>& values, size_t place) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(place);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// In the order of the values, as the callers' own sums were: another order has other last bits.
double total(std::span<const WeightedValue> values) {
  double sum = 0.0;
  for (const WeightedValue& one : values) sum += one.weight;
  return sum;
}

}  // namespace

double interpolated_quantile(std::span<const double> sorted, double share) {
  if (sorted.empty()) return kNone;
  const double at = share * static_cast<double>(sorted.size() - 1);
  const size_t below = static_cast<size_t>(at), above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

double lower_quantile(std::vector<double> values, double share) {
  if (values.empty()) return kNone;
  return at_place(values, static_cast<size_t>(share * static_cast<double>(values.size() - 1)));
}

double nearest_rank_quantile(std::vector<double> values, double share) {
  if (values.empty()) return kNone;
  const double count = static_cast<double>(values.size()), rank = std::clamp(std::ceil(share * count), 1.0, count);
  return at_place(values, static_cast<size_t>(rank) - 1);
}

double upper_median(std::vector<double> values) { return values.empty() ? kNone : at_place(values, values.size() / 2); }

double nearest_rank_quantile(std::span<const WeightedValue> sorted, double share) {
  const double enough = share * total(sorted);
  double up_to = 0.0;
  for (const WeightedValue& one : sorted) {
    up_to += one.weight;
    if (up_to >= enough) return one.value;
  }
  return kNone;
}

double nearest_rank_quantile_of(std::vector<WeightedValue> values, double share) {
  constexpr std::ptrdiff_t kFew = 32;
  const auto by_value = [](const WeightedValue& a, const WeightedValue& b) { return a.value < b.value; };
  double enough = share * total(values);
  auto begin = values.begin(), end = values.end();
  // The half that the quantile is in is kept, until few are left.
  while (end - begin > kFew) {
    const auto middle = begin + (end - begin) / 2;
    std::nth_element(begin, middle, end, by_value);
    const double lower = total(std::span<const WeightedValue>(begin, middle));
    if (lower >= enough) {
      end = middle;
    } else {
      enough -= lower;
      begin = middle;
    }
  }
  std::sort(begin, end, by_value);
  double up_to = 0.0;
  for (auto one = begin; one != end; ++one) {
    up_to += one->weight;
    if (up_to >= enough) return one->value;
  }
  // Rounding has left a little of the last one's weight.
  return values.empty() ? kNone : std::prev(end)->value;
}

double upper_quantile(std::span<const WeightedValue> sorted, double share) {
  const double all = total(sorted);
  double before = 0.0, result = kNone;
  for (const WeightedValue& one : sorted) {
    if (before / all <= share) result = one.value;
    before += one.weight;
  }
  return result;
}

}  // namespace limn
