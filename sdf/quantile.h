#pragma once
// Quantiles, each definition under its own name. They differ where a share falls between two values, and figures depend on which one was
// taken: callers keep theirs. `share` is in [0, 1]. All give NaN where there is no value. (The numbers of definitions are those of
// Hyndman and Fan 1996, "Sample quantiles in statistical packages".)

#include <span>
#include <vector>

namespace limn {

/// Of n sorted values: between the two about place share * (n - 1), linearly (definition 7). Its 0.5 is the textbook's median.
double interpolated_quantile(std::span<const double> sorted, double share);

/// The value at place floor(share * (n - 1)) of the sorted ones: of the two that `interpolated_quantile` lies between, the lower one.
double lower_quantile(std::vector<double> values, double share);

/// The smallest value that at least `share` of all values do not exceed (definition 1).
double nearest_rank_quantile(std::vector<double> values, double share);

/// The value in the middle; of an even number, the upper one of the two there.
double upper_median(std::vector<double> values);

/// A value that stands for a length, an area or a number of equal ones.
struct WeightedValue {
  double value = 0.0, weight = 0.0;
};

/// The smallest value such that those up to it have at least `share` of the weight.
double nearest_rank_quantile(std::span<const WeightedValue> sorted, double share);
/// The same of values in any order, which takes no longer than a few looks at each. Sums of weights are rounded in another order: where
/// those up to a value have the share to the last bit, either this value or the next one is found.
double nearest_rank_quantile_of(std::vector<WeightedValue> values, double share);

/// The last value before which lies at most `share` of the weight. Differs from the one above where values end exactly at the share: there
/// it is the next one.
double upper_quantile(std::span<const WeightedValue> sorted, double share);

}  // namespace limn
