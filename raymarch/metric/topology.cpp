// Pieces of ink and holes in it, against the reference's.

#include <bit>
#include <cstdint>
#include <vector>

#include "raymarch/metric.h"
#include "raymarch/metric/ink_mask.h"
#include "sdf/error.h"

namespace limn {
namespace {

struct Counts {
  int components = 0, holes = 0;
};

/// Pixels first .. last - 1 of a row that are all ink or all paper.
struct Run {
  int first = 0, last = 0;
  bool ink = false;
};

std::uint32_t root_of(std::vector<std::uint32_t>& parents, std::uint32_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

/// The first pixel from `x` on, before `width`, whose ink is `ink`; `width` where there is none.
int next_of(const std::uint64_t* row, int width, int x, bool ink) {
  while (x < width) {
    const std::uint64_t word = ink ? row[x / 64] : ~row[x / 64], rest = word >> (x % 64);
    if (rest != 0) return x + std::countr_zero(rest);  // beyond the row there is no ink: no farther than `width`
    x = (x / 64 + 1) * 64;
  }
  return width;
}

/// A row between paper, whose first pixel is 1: `row` may be null, for one of paper alone.
void add_runs(const std::uint64_t* row, int width, std::vector<Run>& runs) {
  int first = 0;
  for (int x = row != nullptr ? next_of(row, width, 0, true) : width; x < width;) {
    const int end = next_of(row, width, x, false);
    runs.push_back({first, x + 1, false});
    runs.push_back({x + 1, end + 1, true});
    first = end + 1;
    x = next_of(row, width, end, true);
  }
  runs.push_back({first, width + 2, false});
}

/// Joins runs of one row, [first, middle), with those of the next, [middle, end).
void join_rows(const std::vector<Run>& runs, size_t first, size_t middle, std::vector<std::uint32_t>& parents) {
  for (size_t a = first, b = middle; a < middle && b < runs.size();) {
    const int reach = runs[a].ink ? 1 : 0;  // over corners
    if (runs[a].ink == runs[b].ink && runs[a].first < runs[b].last + reach && runs[b].first < runs[a].last + reach)
      parents[root_of(parents, static_cast<std::uint32_t>(b))] = root_of(parents, static_cast<std::uint32_t>(a));
    // The next pair in which the one that ends first has been left; over corners both kinds of neighbours of an end are looked at.
    if (runs[a].last < runs[b].last || (runs[a].last == runs[b].last && !runs[a].ink))
      ++a;
    else
      ++b;
  }
}

// Ink hangs together over corners, paper does not: so a closed line of ink parts its inside from its outside (Rosenfeld 1970). A frame of
// paper about the picture joins all that is outside.
Counts count(const Image<float>& coverage) {
  const InkBits ink = ink_bits(coverage);
  std::vector<Run> runs;
  std::vector<std::uint32_t> parents;
  size_t before = 0, row = 0;
  for (int y = -1; y <= ink.height; ++y) {
    const bool framed = y < 0 || y == ink.height;
    before = row;
    row = runs.size();
    add_runs(framed ? nullptr : ink.row(y), ink.width, runs);
    while (parents.size() < runs.size()) parents.push_back(static_cast<std::uint32_t>(parents.size()));
    join_rows(runs, before, row, parents);
  }
  Counts counts;
  for (std::uint32_t i = 0; i < parents.size(); ++i) {
    if (parents[i] == i) ++(runs[i].ink ? counts.components : counts.holes);
  }
  --counts.holes;
  return counts;
}

std::vector<MetricValue> measure(const MetricInput& input) {
  const Image<float>&ink = input.picture.border, &reference = input.reference.border;
  LIMN_CHECK(ink.width == reference.width && ink.height == reference.height);
  const Counts own = count(ink), wanted = count(reference);
  return {{"topology_components_difference", static_cast<double>(own.components - wanted.components), ""},
          {"topology_holes_difference", static_cast<double>(own.holes - wanted.holes), ""},
          {"topology_components", static_cast<double>(own.components), ""},
          {"topology_holes", static_cast<double>(own.holes), ""},
          {"topology_reference_components", static_cast<double>(wanted.components), ""},
          {"topology_reference_holes", static_cast<double>(wanted.holes), ""}};
}

}  // namespace

Metric topology_metric() {
  return {{"topology",
           "pieces of ink (8-connected, coverage of one half and more) and holes in it (4-connected), less the reference's; and the counts",
           "Rosenfeld 1970"},
          {"topology_components_difference", "topology_holes_difference", "topology_components", "topology_holes",
           "topology_reference_components", "topology_reference_holes"},
          true,
          measure,
          MetricSubject::ink};
}

}  // namespace limn
