#include "raymarch/truth/untouched_regions.h"

#include <algorithm>

#include "sdf/parallel.h"

namespace limn {
namespace {

std::vector<UntouchedRun> runs_of(const std::vector<std::uint8_t>& touched, size_t row, size_t width) {
  std::vector<UntouchedRun> runs;
  const size_t end = (row + 1) * width;
  for (size_t at = row * width; at < end;) {
    const size_t first = at;
    while (at < end && !touched[at]) ++at;
    if (at > first) runs.push_back({first, at});
    while (at < end && touched[at]) ++at;
  }
  return runs;
}

}  // namespace

std::vector<PixelRegion> untouched_regions(const std::vector<std::uint8_t>& touched, int width, int height) {
  const auto w = static_cast<size_t>(width);
  std::vector<std::vector<UntouchedRun>> rows(static_cast<size_t>(height));
  parallel_for(size_t{0}, rows.size(), [&](size_t row) { rows[row] = runs_of(touched, row, w); });
  std::vector<UntouchedRun> runs;
  std::vector<size_t> joined;  // to a run before it, or itself
  const auto root = [&](size_t run) {
    while (joined[run] != run) run = joined[run] = joined[joined[run]];
    return run;
  };
  size_t above = 0, end_above = 0;
  for (const std::vector<UntouchedRun>& row : rows) {
    const size_t first = runs.size();
    for (const UntouchedRun& run : row) {
      while (above < end_above && runs[above].last + w <= run.first) ++above;
      joined.push_back(runs.size());
      runs.push_back(run);
      for (size_t k = above; k < end_above && runs[k].first + w < run.last; ++k) {
        const size_t one = root(k), other = root(runs.size() - 1);
        joined[std::max(one, other)] = std::min(one, other);
      }
    }
    above = first, end_above = runs.size();
  }
  std::vector<PixelRegion> regions;
  std::vector<size_t> number(runs.size());
  for (size_t run = 0; run < runs.size(); ++run) {
    if (root(run) == run) number[run] = regions.size(), regions.emplace_back();
    regions[number[root(run)]].push_back(runs[run]);
  }
  return regions;
}

}  // namespace limn
