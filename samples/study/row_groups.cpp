#include "samples/study/row_groups.h"

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <string_view>
#include <tuple>
#include <unordered_map>

namespace limn {
namespace {

auto head_of(const StudyRow& row) {
  return std::tie(row.surface, row.surface_parameters, row.method, row.method_parameters, row.view, row.key);
}

bool row_less(const GroupedRow& a, const GroupedRow& b) {
  // Two rows of one metric are the same row written twice, its times aside.
  const auto tail = [](const StudyRow& row) { return std::make_tuple(std::cref(row.failed), row.time_ms(), row.bytes); };
  if (a.group != b.group) return a.group < b.group;
  if (const int order = a.row->metric.compare(b.row->metric); order != 0) return order < 0;
  return tail(*a.row) < tail(*b.row);
}

GroupedRows in_order(const std::vector<StudyRow>& rows) {
  GroupedRows result;
  std::unordered_multimap<std::string_view, size_t> groups_of_key;
  for (const StudyRow& row : rows) {
    const auto [first, last] = groups_of_key.equal_range(row.key);
    auto found = std::find_if(first, last, [&](const auto& one) { return head_of(*result.groups[one.second].row) == head_of(row); });
    if (found == last) {
      found = groups_of_key.emplace(row.key, result.groups.size());
      result.groups.push_back({.row = &row});
    }
    result.rows.push_back({&row, found->second});
  }
  std::vector<size_t> order(result.groups.size()), place(order.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(),
            [&](size_t a, size_t b) { return head_of(*result.groups[a].row) < head_of(*result.groups[b].row); });
  std::vector<RowGroup> groups;
  for (const size_t k : order) {
    place[k] = groups.size();
    groups.push_back(result.groups[k]);
  }
  result.groups = std::move(groups);
  for (GroupedRow& row : result.rows) row.group = place[row.group];
  std::sort(result.rows.begin(), result.rows.end(), row_less);
  return result;
}

// Those that tell one drawing from another, and the threshold: what is the same everywhere is in the call.
struct DrawingNames {
  std::map<std::string, std::map<std::string, std::set<std::string>>> values{};  ///< By method and parameter.

  explicit DrawingNames(const std::vector<RowGroup>& groups) {
    for (const RowGroup& group : groups) {
      for (const auto& [name, value] : group.row->method_parameters) values[group.row->method][name].insert(value);
    }
  }
  std::string parameters(const StudyRow& row) const {
    std::string text;
    for (const auto& [name, value] : row.method_parameters) {
      if (name != "threshold" && values.at(row.method).at(name).size() < 2) continue;
      text += (text.empty() ? "" : ", ") + spaced(name) + " " + value;
    }
    return text;
  }
};

void name_groups(std::vector<RowGroup>& groups) {
  const DrawingNames names(groups);
  for (RowGroup& group : groups) {
    const StudyRow& row = *group.row;
    group.series = series_of(row);
    group.resolution = resolution_text(row);
    group.drawing = {row.method, names.parameters(row)};
    const auto threshold = row.method_parameters.find("threshold");
    if (threshold != row.method_parameters.end()) group.drawing.threshold = std::strtod(threshold->second.c_str(), nullptr);
  }
}

}  // namespace

GroupedRows grouped_rows(const std::vector<StudyRow>& rows) {
  GroupedRows result = in_order(rows);
  name_groups(result.groups);
  return result;
}

}  // namespace limn
