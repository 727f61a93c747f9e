#include "samples/study/report_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sdf/level_set.h"
#include "sdf/quantile.h"

namespace limn {
namespace {

ModelPoint point_of(size_t model, std::vector<std::pair<double, const ReportCell*>> values) {
  std::sort(values.begin(), values.end(),
            [](const auto& a, const auto& b) { return std::make_pair(a.first, a.second->view) < std::make_pair(b.first, b.second->view); });
  ModelPoint point;
  point.model = model;
  std::vector<double> errors, times, least, largest;
  for (const auto& [value, cell] : values) {
    errors.push_back(value);
    times.push_back(cell->time_ms);
    least.push_back(cell->time_low_ms);
    largest.push_back(cell->time_high_ms);
    point.bytes = std::max(point.bytes, cell->bytes);
    point.cells.push_back(cell);
  }
  for (std::vector<double>* of : {&times, &least, &largest}) std::sort(of->begin(), of->end());
  point.low = errors.front();
  point.low_quartile = interpolated_quantile(errors, 0.25);
  point.median = interpolated_quantile(errors, 0.5);
  point.high_quartile = interpolated_quantile(errors, 0.75);
  point.high = errors.back();
  point.time_ms = interpolated_quantile(times, 0.5);
  point.time_low_ms = interpolated_quantile(least, 0.5);
  point.time_high_ms = interpolated_quantile(largest, 0.5);
  return point;
}

// Order of the angle between the interpolated normal and the surface's, as the theory of interpolation has it; averaged vertex normals lie
// between: 1 on jittered meshes, 2 where the mesh is symmetric.
std::optional<ExpectedOrder> normal_order(const ReportModel& model) {
  const auto value = [&](const char* name) {
    const auto found = model.parameters.find(name);
    return found == model.parameters.end() ? std::string() : found->second;
  };
  if (model.surface == "mesh") {
    if (value("normals") == "flat") return ExpectedOrder{1.0, 1.0};
    if (value("normals") == "vertex") return ExpectedOrder{1.0, 2.0};
    if (value("normals") == "limit") return ExpectedOrder{2.0, 2.0};
  }
  // A grid made from a mesh that stays as it is converges to that mesh, which is no smooth surface.
  if (model.surface == "level_set") {
    const GradientDescriptor* const gradient = gradients().look_up(value("gradient"));
    if (gradient != nullptr) return ExpectedOrder{static_cast<double>(gradient->order), static_cast<double>(gradient->order)};
  }
  return std::nullopt;
}

// What fronts are made of.
struct Choices {
  std::vector<double> costs{}, errors{};
  Choices(const std::vector<ModelPoint>& points, Cost cost) {
    for (const ModelPoint& point : points) {
      costs.push_back(cost_of(point, cost));
      errors.push_back(point.median);
    }
  }
};

}  // namespace

std::vector<ModelPoint> points_of(const ReportData& data, size_t drawing, const std::string& metric, std::optional<int> view) {
  std::vector<std::vector<std::pair<double, const ReportCell*>>> values(data.models.size());
  for (const ReportCell& cell : data.cells) {
    if (cell.drawing != drawing || (view && cell.view != *view)) continue;
    const auto found = cell.values.find(metric);
    if (found != cell.values.end() && std::isfinite(found->second)) values[cell.model].emplace_back(std::abs(found->second), &cell);
  }
  std::vector<ModelPoint> points;
  for (size_t model = 0; model < values.size(); ++model) {
    if (!values[model].empty()) points.push_back(point_of(model, std::move(values[model])));
  }
  return points;
}

double cost_of(const ModelPoint& point, Cost cost) { return cost == Cost::time ? point.time_ms : static_cast<double>(point.bytes); }

std::vector<size_t> pareto_front(std::span<const double> costs, std::span<const double> errors) {
  std::vector<size_t> order;
  for (size_t i = 0; i < costs.size(); ++i) {
    if (std::isfinite(costs[i]) && std::isfinite(errors[i])) order.push_back(i);
  }
  std::sort(order.begin(), order.end(),
            [&](size_t a, size_t b) { return std::make_tuple(costs[a], errors[a], a) < std::make_tuple(costs[b], errors[b], b); });
  std::vector<size_t> front;
  for (const size_t i : order) {
    if (front.empty() || errors[i] < errors[front.back()]) front.push_back(i);
  }
  return front;
}

std::vector<size_t> pareto_front(const std::vector<ModelPoint>& points, Cost cost) {
  const Choices choices(points, cost);
  return pareto_front(choices.costs, choices.errors);
}

std::vector<std::vector<size_t>> beating_groups(std::span<const double> costs, std::span<const double> errors,
                                                std::span<const size_t> groups) {
  const auto beats = [&](size_t a, size_t b) {
    if (costs[a] == costs[b] && errors[a] == errors[b]) return a < b;
    return costs[a] <= costs[b] && errors[a] <= errors[b];
  };
  std::vector<std::vector<size_t>> beating(costs.size());
  for (size_t i = 0; i < costs.size(); ++i) {
    for (size_t other = 0; other < costs.size(); ++other) {
      if (other != i && beats(other, i)) beating[i].push_back(groups[other]);
    }
    std::sort(beating[i].begin(), beating[i].end());
    beating[i].erase(std::unique(beating[i].begin(), beating[i].end()), beating[i].end());
  }
  return beating;
}

std::vector<std::vector<size_t>> beating_series(const ReportData& data, const std::vector<ModelPoint>& points, Cost cost) {
  const Choices choices(points, cost);
  std::vector<size_t> series;
  series.reserve(points.size());
  for (const ModelPoint& point : points) series.push_back(data.models[point.model].series);
  return beating_groups(choices.costs, choices.errors, series);
}

std::optional<OrderFit> fit_order(std::span<const double> resolutions, std::span<const double> errors, double floor) {
  std::vector<double> x, y;
  for (size_t i = 0; i < resolutions.size(); ++i) {
    if (!(resolutions[i] > 0.0 && std::isfinite(resolutions[i]) && errors[i] > floor && std::isfinite(errors[i]))) continue;
    x.push_back(std::log(resolutions[i]));
    y.push_back(std::log(errors[i]));
  }
  if (x.size() < 3) return std::nullopt;
  const double count = static_cast<double>(x.size());
  const double mean_x = std::accumulate(x.begin(), x.end(), 0.0) / count, mean_y = std::accumulate(y.begin(), y.end(), 0.0) / count;
  double xx = 0.0, xy = 0.0;
  for (size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  if (xx < 1e-6) return std::nullopt;
  const auto [finest, coarsest] = std::minmax_element(x.begin(), x.end());
  return OrderFit{xy / xx, std::exp(mean_y - xy / xx * mean_x), x.size(), std::exp(*finest), std::exp(*coarsest)};
}

std::optional<OrderFit> fit_order(const ReportData& data, const std::vector<ModelPoint>& points, size_t series, const std::string& metric) {
  std::vector<double> resolutions, errors;
  for (const ModelPoint& point : points) {
    if (data.models[point.model].series != series) continue;
    resolutions.push_back(data.models[point.model].resolution);
    errors.push_back(point.median);
  }
  const ReportMetric* about = data.find_metric(metric);
  return fit_order(resolutions, errors, about != nullptr && about->unit == "px" ? data.fit_floor_px() : 0.0);
}

std::string OrderFit::text() const { return fmt::format("order {:.2f}{}", order, converges() ? "" : ": does not converge"); }

std::string ExpectedOrder::text() const { return low == high ? fmt::format("{}", low) : fmt::format("{} to {}", low, high); }

std::optional<ExpectedOrder> expected_order(const ReportData& data, size_t series, const std::string& metric, double threshold) {
  const auto model = std::find_if(data.models.begin(), data.models.end(), [&](const ReportModel& one) { return one.series == series; });
  if (model == data.models.end()) return std::nullopt;
  const std::optional<ExpectedOrder> normal = normal_order(*model);
  if (!normal || metric.find("normal_error") != std::string::npos) return normal;
  const ReportMetric* about = data.find_metric(metric);
  const bool is_distance = about != nullptr ? is_border_distance(*about) : metric.find("displacement") != std::string::npos;
  if (!is_distance || metric.ends_with("_mean")) return std::nullopt;
  // The silhouette knows positions alone: of order 2 even for flat facets.
  if (metric.find("silhouette") != std::string::npos || threshold == 0.0) return ExpectedOrder{2.0, 2.0};
  return ExpectedOrder{std::min(normal->low, 2.0), std::min(normal->high, 2.0)};
}

}  // namespace limn
