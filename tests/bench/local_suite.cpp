#include "tests/bench/local_suite.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "raymarch/local_model.h"
#include "raymarch/truth/proxy.h"
#include "samples/experiment/job.h"
#include "samples/output/output.h"
#include "samples/scenes/scenes.h"
#include "tests/plan_check.h"

namespace limn::bench {
namespace {

constexpr double kThreshold = 0.4;  // of the rim
constexpr double kShare = 0.01;     // of the border that rays may put beyond the tolerance: of uniform meshes and local ones alike
constexpr int kFinestLevel = 7;
constexpr std::int64_t kMaxUniformBytes = std::int64_t{1} << 30;  // about 5 million triangles
constexpr std::int64_t kMaxBytes = std::int64_t{4} << 30;

/// What rays say of a model's border.
struct Kept {
  double beyond = 0.0;        ///< The share of the true border that the model puts elsewhere.
  double false_border = 0.0;  ///< The share of the model's border that is far from every true one.
  /// More than of the reference, whose picture has border that truth does not know where sheets of the surface nearly touch.
  bool both(const Kept& reference) const { return beyond <= reference.beyond + kShare && false_border <= reference.false_border + kShare; }
};

struct View {
  int index = 0;
  PlanView plan{};
  SceneModel reference{};
  std::map<double, Kept> of_reference{};  ///< By tolerance.
};

Kept ask(const SceneModel& model, const View& view, double tolerance_px) {
  return {test::share_beyond(model, view.reference, view.plan, kThreshold, tolerance_px, PlanMetric::border),
          test::share_of_false_border(model, view.plan, kThreshold, tolerance_px, PlanMetric::border)};
}

std::vector<View> views_of(const Scene& scene, const LocalBenchSettings& settings) {
  CameraSettings camera = scene.camera;
  camera.width_px = settings.width_px;
  camera.height_px = settings.height_px;
  std::vector<View> views;
  for (int index = 0; index < settings.views; ++index) {
    if (settings.only_view && index != *settings.only_view) continue;
    View view{index, {}, {}, {}};
    view.plan.camera = camera_of_view(camera, {bounds(scene), {}}, {}, index, settings.views);
    view.plan.truth = solve_truth(scene, view.plan.camera, {}, {});
    view.reference = make_proxy(scene, view.plan.camera, kMaxBytes, 1.0).model;
    for (const double tolerance_px : settings.tolerances_px) view.of_reference[tolerance_px] = ask(view.reference, view, tolerance_px);
    views.push_back(std::move(view));
  }
  return views;
}

nlohmann::json local_row(const Scene& scene, const View& view, double tolerance_px) {
  const SceneModel model = build_local_model(scene, {.max_bytes = kMaxBytes}, {{view.plan.camera}, tolerance_px, {kThreshold}});
  double trace_ms = 0.0;
  const BorderErrors errors = measure_errors(model, view.plan, kThreshold, {}, trace_ms);
  const Kept kept = ask(model, view, tolerance_px);
  return {{"suite", "local"},
          {"scene", scene.name},
          {"view", view.index},
          {"tolerance_px", tolerance_px},
          {"triangles", total(model).triangles},
          {"build_ms", total(model).build_ms},
          {"border_p95_px", errors.border_px},
          {"share_beyond", kept.beyond},
          {"share_false", kept.false_border},
          {"reference_share_false", view.of_reference.at(tolerance_px).false_border},
          {"kept", kept.both(view.of_reference.at(tolerance_px)) && errors.border_px <= tolerance_px},
          {"uniform_triangles", nullptr},
          {"p95_triangles", nullptr}};
}

/// A mesh as fine everywhere, asked for one row's tolerance; true once nothing is left to ask.
bool ask_uniform(const SceneModel& model, int level, const View& view, double border_p95_px, nlohmann::json& row) {
  const double tolerance_px = row["tolerance_px"];
  if (row["p95_triangles"].is_null() && border_p95_px <= tolerance_px) row["p95_triangles"] = total(model).triangles;
  if (row["uniform_triangles"].is_null()) {
    const Kept kept = ask(model, view, tolerance_px);
    const bool both = kept.both(view.of_reference.at(tolerance_px));
    row[both ? "uniform_triangles" : "coarser_triangles"] = total(model).triangles;
    row[both ? "uniform_build_ms" : "coarser_build_ms"] = total(model).build_ms;
    row["uniform_level"] = level;
    row["uniform_share_beyond"] = kept.beyond;
    row["uniform_share_false"] = kept.false_border;
  }
  return !row["p95_triangles"].is_null() && !row["uniform_triangles"].is_null();
}

/// Looks for the coarsest levels that keep to each row's tolerance; a level is built once and asked in all views.
void find_uniform(const Scene& scene, const std::vector<View>& views, std::vector<nlohmann::json>& rows) {
  Scene bare = scene;
  for (SceneObject& object : bare.objects) object.level.reset();
  std::vector<char> done(rows.size(), 0);
  for (int level = 0; level <= kFinestLevel && std::count(done.begin(), done.end(), 0) > 0; ++level) {
    SceneModel model;
    try {
      model = build_model(bare, {.kind = "mesh", .level = level, .normals = NormalKind::limit, .max_bytes = kMaxUniformBytes});
    } catch (const InputError&) {
      return;  // larger than memory
    }
    for (const View& view : views) {
      double trace_ms = 0.0;
      const double border_px = measure_errors(model, view.plan, kThreshold, {}, trace_ms).border_px;
      for (size_t k = 0; k < rows.size(); ++k) {
        if (rows[k]["view"] == view.index && !done[k]) done[k] = ask_uniform(model, level, view, border_px, rows[k]);
      }
    }
  }
}

double median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  const size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

/// How many times fewer triangles a local mesh has than a mesh as fine everywhere that keeps to the tolerance. Where none that was built
/// does, at least so many times fewer than the finest of them.
double saving(const nlohmann::json& row) {
  const nlohmann::json& uniform = row["uniform_triangles"].is_null() ? row["coarser_triangles"] : row["uniform_triangles"];
  return uniform.get<double>() / row["triangles"].get<double>();
}

/// The same against the coarsest mesh that puts 95 % of the border within the tolerance, as a plan takes it.
double saving_by_p95(const nlohmann::json& row) {
  const nlohmann::json& uniform = row["p95_triangles"].is_null() ? row["coarser_triangles"] : row["p95_triangles"];
  return uniform.get<double>() / row["triangles"].get<double>();
}

/// Of triangles ~ tolerance^-exponent: the slope of the line through the logarithms, one for each view, their mean.
double exponent_of(const std::vector<nlohmann::json>& rows) {
  std::map<std::pair<std::string, int>, std::vector<glm::dvec2>> curves;
  for (const nlohmann::json& row : rows)
    curves[{row["scene"], row["view"]}].emplace_back(std::log(row["tolerance_px"].get<double>()), std::log(row["triangles"].get<double>()));
  double top = 0.0, bottom = 0.0;
  for (const auto& [view, points] : curves) {
    glm::dvec2 middle(0.0);
    for (const glm::dvec2& p : points) middle += p / static_cast<double>(points.size());
    for (const glm::dvec2& p : points) top -= (p.x - middle.x) * (p.y - middle.y), bottom += (p.x - middle.x) * (p.x - middle.x);
  }
  return bottom > 0.0 ? top / bottom : std::nan("");
}

/// What the rows of one tolerance come to.
std::string cells_of(const std::vector<nlohmann::json>& rows, double tolerance_px) {
  std::vector<double> triangles, savings, by_p95;
  int kept = 0, bounds = 0;
  for (const nlohmann::json& row : rows) {
    if (row["tolerance_px"] != tolerance_px) continue;
    triangles.push_back(row["triangles"]);
    savings.push_back(saving(row));
    by_p95.push_back(saving_by_p95(row));
    kept += row["kept"].get<bool>();
    bounds += row["uniform_triangles"].is_null();
  }
  return fmt::format(" | {}/{} | {:.0f} | {}{:.1f}x | {:.1f}x", kept, triangles.size(), median(triangles), bounds > 0 ? "> " : "",
                     median(savings), median(by_p95));
}

std::string line(const std::string& name, const std::vector<nlohmann::json>& rows, const LocalBenchSettings& settings) {
  std::string text = "| " + name;
  for (const double tolerance_px : settings.tolerances_px) text += cells_of(rows, tolerance_px);
  return text + fmt::format(" | {:.2f} |\n", exponent_of(rows));
}

std::string heading(const LocalBenchSettings& settings) {
  std::string names = "| scene", rule = "|---";
  for (const double tolerance_px : settings.tolerances_px) {
    names += fmt::format(" | {} px: kept | triangles | fewer | than a plan's", tolerance_px);
    rule += "|---|---|---|---";
  }
  return names + " | exponent |\n" + rule + "|---|\n";
}

}  // namespace

nlohmann::json bench_local(const LocalBenchSettings& settings) {
  std::vector<nlohmann::json> all;
  fmt::print(settings.table, "{}", heading(settings));
  for (const SceneDescriptor& descriptor : scenes()) {
    const auto& wanted = settings.scenes;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), descriptor.about.name) == wanted.end()) continue;
    Scene scene = descriptor.make();
    scene.name = descriptor.about.name;
    const std::vector<View> views = views_of(scene, settings);
    std::vector<nlohmann::json> rows;
    for (const View& view : views) {
      for (const double tolerance_px : settings.tolerances_px) rows.push_back(local_row(scene, view, tolerance_px));
    }
    find_uniform(scene, views, rows);
    for (const nlohmann::json& row : rows) fmt::print(stderr, "{}\n", row.dump());
    fmt::print(settings.table, "{}", line(scene.name, rows, settings));
    std::fflush(settings.table);
    all.insert(all.end(), rows.begin(), rows.end());
  }
  fmt::print(settings.table, "{}", line("all", all, settings));
  return all;
}

}  // namespace limn::bench
