#include "samples/study/shard.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace limn {
namespace {

/// Some views of one model.
struct Unit {
  size_t model = 0, first_view = 0, views = 0;
  double cost_ms = 0.0;
};

double view_ms(const Study& study, const StudyModel& model) {
  if (!model.refused.empty()) return 0.0;
  return study.looks() * model.cost.trace_ms + static_cast<double>(study.methods.size()) * study.measure_ms();
}

std::vector<Unit> units_of(const Study& study, int count) {
  const size_t views = study.cameras.size();
  double total = 0.0;
  for (const StudyModel& model : study.models) total += model.cost.build_ms + static_cast<double>(views) * view_ms(study, model);
  const double most = 0.5 * total / count;
  std::vector<Unit> units;
  for (size_t i = 0; i < study.models.size(); ++i) {
    const StudyModel& model = study.models[i];
    const double all = static_cast<double>(views) * view_ms(study, model);
    const double pieces = most > 0.0 ? std::ceil((model.cost.build_ms + all) / most) : 1.0;
    const auto parts = static_cast<size_t>(std::clamp(pieces, 1.0, static_cast<double>(views)));
    for (size_t part = 0; part < parts; ++part) {
      const size_t first = views * part / parts, last = views * (part + 1) / parts;
      units.push_back({i, first, last - first, model.cost.build_ms + static_cast<double>(last - first) * view_ms(study, model)});
    }
  }
  return units;
}

}  // namespace

// The heaviest first, each to the part with least to do (Graham 1969).
std::vector<int> shards_of(const Study& study, int count) {
  std::vector<Unit> units = units_of(study, count);
  std::stable_sort(units.begin(), units.end(), [](const Unit& a, const Unit& b) { return a.cost_ms > b.cost_ms; });
  std::vector<double> loads(static_cast<size_t>(count), 0.0);
  const size_t views = study.cameras.size();
  std::vector<int> part_of(study.models.size() * views, 1);
  for (const Unit& unit : units) {
    const auto least = std::min_element(loads.begin(), loads.end());
    *least += unit.cost_ms;
    for (size_t view = unit.first_view; view < unit.first_view + unit.views; ++view)
      part_of[unit.model * views + view] = static_cast<int>(least - loads.begin()) + 1;
  }
  std::vector<int> shards;
  for (const StudyCell& cell : study.cells) shards.push_back(part_of[cell.model * views + cell.view]);
  return shards;
}

std::vector<size_t> cells_of_shard(const Study& study, int shard, int count) {
  const std::vector<int> shards = shards_of(study, count);
  std::vector<size_t> cells;
  for (size_t i = 0; i < shards.size(); ++i) {
    if (shards[i] == shard) cells.push_back(i);
  }
  return cells;
}

std::vector<double> shard_costs(const Study& study, const std::vector<int>& shards, int count) {
  std::vector<double> costs(static_cast<size_t>(count), 0.0);
  std::set<std::pair<int, size_t>> built;
  std::set<std::array<size_t, 3>> seen;
  for (size_t i = 0; i < shards.size(); ++i) {
    const StudyCell& cell = study.cells[i];
    const StudyModel& model = study.models[cell.model];
    double& cost = costs[static_cast<size_t>(shards[i] - 1)];
    if (built.insert({shards[i], cell.model}).second) cost += model.cost.build_ms;
    if (!model.refused.empty()) continue;
    if (seen.insert({static_cast<size_t>(shards[i]), cell.model, cell.view}).second) cost += study.looks() * model.cost.trace_ms;
    cost += study.measure_ms();
  }
  return costs;
}

}  // namespace limn
