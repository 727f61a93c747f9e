#include "tests/bench/fields_suite.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <mutex>

#include "raymarch/gbuffer.h"
#include "tests/bench/contestant.h"
#include "tests/bench/field_scenes.h"
#include "tests/bench/timing.h"
#include "tests/raymarch/field_walk.h"

namespace limn::bench {
namespace {

using nlohmann::json;

struct Case {
  std::string scene{};
  Camera camera{};
  std::optional<Field> field{};  ///< None: a floor.
  Contestant contestant{};
  int every = 1;  ///< One ray in so many is walked.
};

Case field_case(const std::string& name, const std::string& about, const Field& field, int width_px, int height_px, int every) {
  Scene scene;
  scene.objects.push_back({.name = name, .source = field});
  scene.camera.width_px = width_px;
  scene.camera.height_px = height_px;
  const Camera camera = resolve_camera(scene.camera, bounds(scene));
  return {name, camera, field, limn_surface("limn.analytic", "limn " + about, scene, {.kind = "analytic"}, camera, Drawn::grid), every};
}

std::vector<Case> all_cases(const FieldsBenchSettings& settings) {
  const int width = settings.width_px, height = settings.height_px;
  constexpr int kCsgSide_px = 1024;
  // Strides without a factor in common with the widths: all columns are met.
  std::vector<Case> cases;
  cases.push_back(field_case("sphere", "sphere", sphere_field(), width, height, 7));
  cases.push_back(field_case("ellipsoid", "ellipsoid", ellipsoid_field(), width, height, 7));
  cases.push_back(field_case("spheres_10", "union of 10 spheres", random_spheres(10), width, height, 17));
  cases.push_back(field_case("spheres_1000", "union of 1000 spheres", random_spheres(1000), width, height, 307));
  cases.push_back(field_case("csg_20", "CSG of 20, 1024 x 1024", csg_of_twenty(), kCsgSide_px, kCsgSide_px, 17));
  const Camera camera = cases.front().camera;
  cases.push_back({"floor.sphere", camera, {}, closed_form_sphere(camera, glm::dvec3(0.0), 1.0)});
  cases.push_back({"floor.write", camera, {}, write_floor(camera)});
  return cases;
}

/// What walks along single rays see otherwise. Lengths in pixels at that depth.
struct Checked {
  std::int64_t rays = 0, wrong = 0;
  double farthest_wrong_px = 0.0, worst_depth_px = 0.0;
  std::vector<double> normals_deg{};
};

void check_pixel(const Case& it, const Frame& frame, size_t i, const RayForms<double>& forms, FieldEvaluator& evaluator, Checked& checked) {
  const Box& box = it.field->traits().bounds;
  const glm::dvec3 o = forms.eye, d = forms.direction(static_cast<int>(i) % frame.width, static_cast<int>(i) / frame.width);
  const double middle = glm::dot(box.center() - o, d), reach = 1.01 * box.radius(), pixel = middle / it.camera.focal_px;
  const double truth = test::walk_field(evaluator, o, d, middle - reach, middle + reach, {.extent = box.radius()});
  const double t = static_cast<double>(frame.distance[i]);
  ++checked.rays;
  if (std::isfinite(t) != std::isfinite(truth)) {
    ++checked.wrong;
    const double off = test::deepest(evaluator, o, d, middle - reach, middle + reach, true);
    checked.farthest_wrong_px = std::max(checked.farthest_wrong_px, std::abs(off) / pixel);
  } else if (std::isfinite(t)) {
    const double apart = std::abs(t - truth);
    if (apart > pixel) {
      // One of the two passes what the other hits: how deep the later one has been by then.
      ++checked.wrong;
      const double off = test::deepest(evaluator, o, d, std::min(t, truth) - 0.5 * pixel, std::min(t, truth) + 0.5 * pixel, true);
      checked.farthest_wrong_px = std::max(checked.farthest_wrong_px, std::abs(off) / pixel);
      return;
    }
    checked.worst_depth_px = std::max(checked.worst_depth_px, apart / pixel);
    const glm::dvec3 normal = glm::normalize(evaluator.jet(o + truth * d).gradient), drawn(frame.normal_at(i));
    checked.normals_deg.push_back(glm::degrees(2.0 * std::asin(std::min(1.0, 0.5 * glm::length(normal - drawn)))));
  }
}

Checked check(const Case& it, const Frame& frame) {
  const RayForms<double> forms = ray_forms(it.camera);
  tbb::enumerable_thread_specific<FieldEvaluator> evaluators([&] { return FieldEvaluator(*it.field); });
  tbb::enumerable_thread_specific<Checked> parts;
  const auto every = static_cast<size_t>(it.every);
  tbb::parallel_for(size_t{0}, (frame.pixels() + every - 1) / every,
                    [&](size_t k) { check_pixel(it, frame, k * every, forms, evaluators.local(), parts.local()); });
  Checked all;
  for (const Checked& part : parts) {
    all.rays += part.rays;
    all.wrong += part.wrong;
    all.farthest_wrong_px = std::max(all.farthest_wrong_px, part.farthest_wrong_px);
    all.worst_depth_px = std::max(all.worst_depth_px, part.worst_depth_px);
    all.normals_deg.insert(all.normals_deg.end(), part.normals_deg.begin(), part.normals_deg.end());
  }
  std::sort(all.normals_deg.begin(), all.normals_deg.end());
  return all;
}

void add_accuracy(const Case& it, const Frame& frame, json& row) {
  std::int64_t hits = 0;
  for (size_t i = 0; i < frame.pixels(); ++i) hits += std::isfinite(frame.distance[i]);
  const Checked checked = check(it, frame);
  row["hits"] = hits;
  row["walked_rays"] = checked.rays;
  row["wrong_hits"] = checked.wrong;
  row["farthest_wrong_px"] = checked.farthest_wrong_px;
  row["worst_depth_px"] = checked.worst_depth_px;
  const size_t n = checked.normals_deg.size();
  row["normal_p99_deg"] = n == 0 ? 0.0 : checked.normals_deg[(n - 1) * 99 / 100];
}

void print_header(std::FILE* table) {
  fmt::print(table, "{:16} {:>3} {:42} {:>9} {:>9} {:>8} {:>9} {:>8} {:>6} {:>8} {:>10} {:>10}\n", "scene", "thr", "contestant",
             "median ms", "min ms", "/write", "hits", "walked", "wrong", "off px", "depth px", "normal p99");
}

void print_row(const json& row, double write_ms, std::FILE* table) {
  fmt::print(table, "{:16} {:3} {:42} {:9.2f} {:9.2f} {:8.2f}", row["scene"].get<std::string>(), row["threads"].get<int>(),
             row["name"].get<std::string>(), row["median_ms"].get<double>(), row["min_ms"].get<double>(),
             row["median_ms"].get<double>() / write_ms);
  if (row.contains("hits"))
    fmt::print(table, " {:9} {:8} {:6} {:8.5f} {:10.6f} {:10.6f}", row["hits"].get<std::int64_t>(), row["walked_rays"].get<std::int64_t>(),
               row["wrong_hits"].get<std::int64_t>(), row["farthest_wrong_px"].get<double>(), row["worst_depth_px"].get<double>(),
               row["normal_p99_deg"].get<double>());
  fmt::print(table, "\n");
  std::fflush(table);
}

json rows_of(const std::vector<Case>& cases, const std::vector<Times>& times, int threads) {
  json rows = json::array();
  for (size_t c = 0; c < cases.size(); ++c) {
    const Case& it = cases[c];
    json row = {{"kind", "field"},
                {"scene", it.scene},
                {"threads", threads},
                {"contestant", it.contestant.key},
                {"name", it.contestant.name},
                {"median_ms", times[c].median_ms()},
                {"min_ms", times[c].sorted_ms.front()},
                {"max_ms", times[c].sorted_ms.back()}};
    if (it.field) {
      Frame frame(it.camera.width_px, it.camera.height_px);
      it.contestant.take(frame);
      row["checksum"] = checksum(frame);
      // Pictures do not depend on the number of threads (the checksum tells), so that one of them is checked.
      if (threads == 2) add_accuracy(it, frame, row);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

nlohmann::json bench_fields(const FieldsBenchSettings& settings) {
  const std::vector<Case> cases = all_cases(settings);
  std::vector<std::function<void()>> works;
  for (const Case& it : cases) works.push_back(it.contestant.draw);
  json rows = json::array();
  print_header(settings.table);
  for (const int threads : {1, 2}) {
    const std::vector<Times> times = time_interleaved(works, settings.runs, threads);
    for (json& row : rows_of(cases, times, threads)) {
      print_row(row, times.back().median_ms(), settings.table);
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace limn::bench
