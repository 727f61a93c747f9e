#include "tests/bench/march_suite.h"

#include <fmt/format.h>
#include "sdf/simd.h"
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <cstring>

#include "tests/bench/bench_cases.h"
#include "tests/bench/timing.h"

namespace limn::bench {
namespace {

using nlohmann::json;

/// In JSON there is no infinity.
json number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

struct Truths {
  TruePicture grid, original;
  const TruePicture& of(Drawn drawn) const { return drawn == Drawn::original ? original : grid; }
};

Truths truths_of(const BenchObject& object, const BenchCase& it) {
  if (object.field) {
    const TruePicture closed = true_picture(object.closed_form, it.camera);
    return {closed, closed};
  }
  return {true_picture(true_grid_surface(it.level_set), it.camera), true_picture(true_mesh(object.mesh), it.camera)};
}

json row_of(const Contestant& contestant, const BenchCase& it, int threads, const Times& times, const Truths& truths, Frame& frame) {
  json row = {{"kind", "march"},
              {"object", it.object},
              {"voxels", it.voxels},
              {"threads", threads},
              {"contestant", contestant.key},
              {"name", contestant.name},
              {"median_ms", times.median_ms()},
              {"min_ms", times.sorted_ms.front()},
              {"max_ms", times.sorted_ms.back()}};
  contestant.take(frame);
  if (contestant.role == Role::ours) row["checksum"] = checksum(frame);
  if (contestant.drawn == Drawn::nothing) return row;
  const Accuracy accuracy = judge(frame, truths.of(contestant.drawn), it.camera, it.voxel_size);
  row["hits"] = accuracy.hits;
  row["wrong_hits"] = accuracy.wrong_hits;
  row["farthest_wrong_px"] = number(accuracy.farthest_wrong_px);
  row["through"] = accuracy.through;
  row["normal_p99_deg"] = accuracy.normal_p99_deg;
  row["depth_p99_voxels"] = accuracy.depth_p99_voxels;
  return row;
}

void print_header(std::FILE* table) {
  fmt::print(table, "{:16} {:>6} {:>3} {:42} {:>9} {:>9} {:>8} {:>9} {:>7} {:>8} {:>7} {:>10} {:>10}\n", "object", "voxels", "thr",
             "contestant", "median ms", "min ms", "/central", "hits", "wrong", "off px", "through", "normal p99", "depth p99");
}

void print_row(const json& row, double central_ms, std::FILE* table) {
  fmt::print(table, "{:16} {:6} {:3} {:42} {:9.2f} {:9.2f} {:8.2f}", row["object"].get<std::string>(), row["voxels"].get<int>(),
             row["threads"].get<int>(), row["name"].get<std::string>(), row["median_ms"].get<double>(), row["min_ms"].get<double>(),
             row["median_ms"].get<double>() / central_ms);
  if (row.contains("hits"))
    fmt::print(table, " {:9} {:7} {:8.4f} {:7} {:10.5f} {:10.5f}", row["hits"].get<std::int64_t>(), row["wrong_hits"].get<std::int64_t>(),
               row["farthest_wrong_px"].is_null() ? -1.0 : row["farthest_wrong_px"].get<double>(), row["through"].get<std::int64_t>(),
               row["normal_p99_deg"].get<double>(), row["depth_p99_voxels"].get<double>());
  fmt::print(table, "\n");
  std::fflush(table);
}

std::vector<Contestant> contestants_of(const BenchCase& it) {
  std::vector<Contestant> all = limn_contestants(it);
  for (const auto& more : {vdb_peers(it), embree_peers(it), floors(it)}) all.insert(all.end(), more.begin(), more.end());
  return all;
}

json march_rows(const std::vector<Contestant>& contestants, const BenchCase& it, const Truths& truths, const MarchBenchSettings& settings) {
  json rows = json::array();
  Frame frame(settings.width_px, settings.height_px);
  std::vector<std::function<void()>> works;
  for (const Contestant& contestant : contestants) works.push_back(contestant.draw);
  for (const int threads : {1, 2}) {
    const std::vector<Times> times = time_interleaved(works, settings.runs, threads);
    for (size_t c = 0; c < contestants.size(); ++c) {
      rows.push_back(row_of(contestants[c], it, threads, times[c], truths, frame));
      print_row(rows.back(), times[0].median_ms(), settings.table);
    }
  }
  return rows;
}

json grid_row(const BenchCase& it, std::FILE* table) {
  GridCost cost = vdb_cost(it);
  add_our_cost(it, cost);
  fmt::print(table, "{:16} {:6}     grid: OpenVDB {:.1f} MB, NanoVDB {:.1f} MB in {:.1f} ms; ray-ready {:.1f} MB in {:.1f} ms\n", it.object,
             it.voxels, cost.openvdb_bytes * 1e-6, cost.nanovdb_bytes * 1e-6, cost.nanovdb_conversion_ms, cost.ours_bytes * 1e-6,
             cost.ours_ms);
  return {{"kind", "grid"},
          {"object", it.object},
          {"voxels", it.voxels},
          {"openvdb_bytes", cost.openvdb_bytes},
          {"nanovdb_bytes", cost.nanovdb_bytes},
          {"nanovdb_conversion_ms", cost.nanovdb_conversion_ms},
          {"ray_ready_bytes", cost.ours_bytes},
          {"ray_ready_ms", cost.ours_ms}};
}

/// Units in the last place between two floats of one sign; infinite ones equal themselves.
double ulps_between(float a, float b) {
  const auto order = [](float x) {
    std::int32_t bits = 0;
    std::memcpy(&bits, &x, sizeof bits);
    return static_cast<std::int64_t>(bits < 0 ? std::numeric_limits<std::int32_t>::min() - bits : bits);
  };
  return static_cast<double>(std::llabs(order(a) - order(b)));
}

/// The same picture with each SIMD target that the program holds and the machine has, beside the widest one's.
json simd_rows(const std::vector<Contestant>& contestants, const BenchCase& it, std::FILE* table) {
  json rows = json::array();
  const std::int64_t all = hwy::SupportedTargets() & HWY_TARGETS;
  for (const Contestant& contestant : contestants) {
    if (contestant.role != Role::ours) continue;
    Frame widest(it.camera.width_px, it.camera.height_px), narrow(it.camera.width_px, it.camera.height_px);
    contestant.draw();
    contestant.take(widest);
    for (std::int64_t target = 1; target > 0 && target <= all; target <<= 1) {
      // Lower bits are the better targets.
      if (!(all & target) || (all & (target - 1)) == 0) continue;
      hwy::GetChosenTarget().Update(all & ~(target - 1));
      contestant.draw();
      hwy::GetChosenTarget().Update(hwy::SupportedTargets());
      contestant.take(narrow);
      double worst = 0.0;
      for (size_t i = 0; i < widest.pixels(); ++i) worst = std::max(worst, ulps_between(widest.distance[i], narrow.distance[i]));
      for (size_t i = 0; i < 3 * widest.pixels(); ++i) worst = std::max(worst, ulps_between(widest.normal[i], narrow.normal[i]));
      fmt::print(table, "{:16} {:6}     {} with {}: {} ulp from the widest target\n", it.object, it.voxels, contestant.name,
                 hwy::TargetName(target), worst);
      rows.push_back({{"kind", "simd"},
                      {"object", it.object},
                      {"voxels", it.voxels},
                      {"contestant", contestant.key},
                      {"target", hwy::TargetName(target)},
                      {"worst_ulps", worst}});
    }
  }
  return rows;
}

void append(json& rows, json more) {
  for (json& row : more) rows.push_back(std::move(row));
}

}  // namespace

nlohmann::json bench_march(const MarchBenchSettings& settings) {
  std::vector<BenchObject> objects;
  std::vector<std::string> names = settings.objects;
  if (names.empty())
    names = settings.meshes.empty() ? std::vector<std::string>{"sphere", "torus", "rook"} : std::vector<std::string>{"sphere", "torus"};
  for (const std::string& name : names) objects.push_back(bench_object(name));
  for (const std::string& file : settings.meshes) objects.push_back(bench_mesh_file(file));
  const std::vector<int> resolutions = settings.voxels.empty() ? std::vector<int>{128, 256, 1024} : settings.voxels;
  json rows = json::array();
  print_header(settings.table);
  for (const int voxels : resolutions) {
    for (const BenchObject& object : objects) {
      const BenchCase it = bench_case(object, voxels, settings.width_px, settings.height_px);
      const std::vector<Contestant> contestants = contestants_of(it);
      append(rows, march_rows(contestants, it, truths_of(object, it), settings));
      rows.push_back(grid_row(it, settings.table));
      if (voxels == resolutions.front()) append(rows, simd_rows(contestants, it, settings.table));
    }
  }
  return rows;
}

}  // namespace limn::bench
