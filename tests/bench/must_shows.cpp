// The demands on the marchers, each with its bound and the figure of the run.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "tests/bench/march_suite.h"

namespace limn::bench {
namespace {

using nlohmann::json;

class Shown {
 public:
  explicit Shown(const json& rows) : rows_(rows) {
    for (const json& row : rows)
      if (row.value("kind", "") == "march") cases_.emplace(row["object"].get<std::string>(), row["voxels"].get<int>());
  }

  json take() { return std::move(shown_); }

  void at_least(int number, const std::string& what, double bound, std::optional<double> figure) {
    if (figure) add(number, what, fmt::format("at least {:g}", bound), *figure, *figure >= bound);
  }
  void at_most(int number, const std::string& what, double bound, std::optional<double> figure) {
    if (figure) add(number, what, fmt::format("at most {:g}", bound), *figure, *figure <= bound);
  }

  std::optional<double> value(const std::string& contestant, const std::string& object, int voxels, int threads, const char* field) const {
    for (const json& row : rows_) {
      if (row.value("kind", "") != "march" || row["contestant"] != contestant || row["object"] != object || row["voxels"] != voxels ||
          row["threads"] != threads || !row.contains(field) || !row[field].is_number())
        continue;
      return row[field].get<double>();
    }
    return std::nullopt;
  }
  std::optional<double> ms(const std::string& contestant, const std::string& object, int voxels, int threads = 2) const {
    return value(contestant, object, voxels, threads, "median_ms");
  }
  std::optional<double> field_ms(const std::string& scene, int threads = 2) const {
    for (const json& row : rows_)
      if (row.value("kind", "") == "field" && row["scene"] == scene && row["threads"] == threads) return row["median_ms"].get<double>();
    return std::nullopt;
  }
  static std::optional<double> ratio(std::optional<double> a, std::optional<double> b) {
    if (!a || !b || *b == 0.0) return std::nullopt;
    return *a / *b;
  }

  void speed();
  void accuracy();
  void growth();
  void grids();
  void analytic();
  void threads();
  void targets();
  void conversions();
  void sizes();

 private:
  void add(int number, const std::string& what, const std::string& bound, double figure, bool met) {
    shown_.push_back({{"number", number}, {"what", what}, {"bound", bound}, {"figure", figure}, {"met", met}});
  }

  const json& rows_;
  std::set<std::pair<std::string, int>> cases_;
  json shown_ = json::array();
};

bool same_picture(const json& a, const json& b) {
  constexpr const char* kKeys[] = {"kind", "contestant", "object", "scene", "voxels"};
  return std::all_of(std::begin(kKeys), std::end(kKeys), [&](const char* key) { return a.value(key, json()) == b.value(key, json()); });
}

bool held_to_speed(int voxels) { return voxels == 256 || voxels == 1024; }

void Shown::speed() {
  struct Peer {
    const char *key, *name;
    double bound;
  };
  constexpr Peer kPeers[] = {{"openvdb", "OpenVDB", 40.0},
                             {"nanovdb", "NanoVDB", 20.0},
                             {"embree.grid", "Embree on the grid's mesh", 5.0},
                             {"embree.original", "Embree on the original mesh", 3.0}};
  for (const auto& [object, voxels] : cases_) {
    if (!held_to_speed(voxels)) continue;
    for (const Peer& peer : kPeers)
      at_least(1, fmt::format("{} {}: times faster than {}", object, voxels, peer.name), peer.bound,
               ratio(ms(peer.key, object, voxels), ms("limn.central", object, voxels)));
    at_most(1, fmt::format("{} {}: mesh over Embree on the same triangles, time", object, voxels), 1.0,
            ratio(ms("limn.mesh", object, voxels), ms("embree.original", object, voxels)));
  }
}

void Shown::accuracy() {
  for (const auto& [object, voxels] : cases_) {
    const auto of = [&, &o = object, v = voxels](const char* field) { return value("limn.central", o, v, 2, field); };
    if (voxels == 256 && (object == "sphere" || object == "torus")) {
      at_most(2, fmt::format("{} {}: normal p99 of central, degrees", object, voxels), 0.02, of("normal_p99_deg"));
      at_most(2, fmt::format("{} {}: depth p99, voxels", object, voxels), 0.02, of("depth_p99_voxels"));
    }
    if (!held_to_speed(voxels)) continue;
    at_most(2, fmt::format("{} {}: hits through the surface", object, voxels), 0.0, of("through"));
    at_most(2, fmt::format("{} {}: farthest wrong hit or miss, px", object, voxels), 0.05, of("farthest_wrong_px"));
    at_most(2, fmt::format("{} {}: cubic normals over central, time", object, voxels), 1.5,
            ratio(ms("limn.cubic", object, voxels), ms("limn.central", object, voxels)));
  }
}

void Shown::growth() {
  for (const auto& [object, voxels] : cases_) {
    if (voxels != 128) continue;
    at_most(3, fmt::format("{}: time at 1024 voxels over 128", object), 1.4,
            ratio(ms("limn.central", object, 1024), ms("limn.central", object, 128)));
  }
}

void Shown::grids() {
  for (const json& row : rows_) {
    if (row.value("kind", "") != "grid" || !held_to_speed(row["voxels"])) continue;
    const std::string where = fmt::format("{} {}", row["object"].get<std::string>(), row["voxels"].get<int>());
    at_most(3, where + ": ray-ready memory over OpenVDB's", 0.55,
            row["ray_ready_bytes"].get<double>() / row["openvdb_bytes"].get<double>());
    at_most(3, where + ": preparing over NanoVDB's conversion, time", 2.0,
            row["ray_ready_ms"].get<double>() / row["nanovdb_conversion_ms"].get<double>());
  }
}

void Shown::analytic() {
  for (const auto& [object, voxels] : cases_) {
    if (object != "sphere") continue;
    at_most(4, "analytic sphere over the closed-form SIMD sphere, time", 3.0,
            ratio(ms("limn.analytic", object, voxels), ms("floor.sphere", object, voxels)));
    break;
  }
  at_most(4, "field sphere over the closed-form SIMD sphere, time", 3.0, ratio(field_ms("sphere"), field_ms("floor.sphere")));
  at_most(4, "field ellipsoid over the closed-form SIMD sphere, time", 3.0, ratio(field_ms("ellipsoid"), field_ms("floor.sphere")));
  at_most(4, "union of 1000 spheres over one of 10, time", 6.0, ratio(field_ms("spheres_1000"), field_ms("spheres_10")));
  at_most(4, "CSG of 20 primitives over the memory-write floor, time", 12.0, ratio(field_ms("csg_20"), field_ms("floor.write")));
  for (const json& row : rows_) {
    if (row.value("kind", "") != "field" || !row.contains("farthest_wrong_px")) continue;
    at_most(4, fmt::format("field {}: farthest wrong hit or miss, px", row["scene"].get<std::string>()), 0.05,
            row["farthest_wrong_px"].get<double>());
  }
}

void Shown::threads() {
  for (const auto& [object, voxels] : cases_) {
    for (const char* contestant : {"limn.central", "limn.analytic", "limn.mesh"})
      at_least(5, fmt::format("{} {}: {} on two threads, times faster", object, voxels, contestant), 1.9,
               ratio(ms(contestant, object, voxels, 1), ms(contestant, object, voxels, 2)));
  }
  for (const char* scene : {"sphere", "ellipsoid", "spheres_10", "spheres_1000", "csg_20"})
    at_least(5, fmt::format("field {} on two threads, times faster", scene), 1.9, ratio(field_ms(scene, 1), field_ms(scene, 2)));
  double different = 0.0;
  bool some = false;
  for (const json& a : rows_) {
    if (!a.contains("checksum") || a["threads"] != 1) continue;
    some = true;
    for (const json& b : rows_)
      different += b.contains("checksum") && b["threads"] == 2 && same_picture(a, b) && a["checksum"] != b["checksum"];
  }
  if (some) at_most(5, "pictures that differ between one thread and two", 0.0, different);
}

void Shown::targets() {
  std::optional<double> worst;
  for (const json& row : rows_)
    if (row.value("kind", "") == "simd") worst = std::max(worst.value_or(0.0), row["worst_ulps"].get<double>());
  at_most(5, "SIMD targets: farthest from the widest one, ulp", 0.0, worst);
}

void Shown::conversions() {
  for (const json& row : rows_) {
    if (row.value("kind", "") != "convert") continue;
    const std::string where = fmt::format("{} {}", row["object"].get<std::string>(), row["voxels"].get<int>());
    at_most(6, where + ": mesh to level set over meshToVolume, time", 1.0, row["ours_ms"].get<double>() / row["openvdb_ms"].get<double>());
    // Where holes are closed the value is no distance to the triangles.
    if (row.value("open", false)) continue;
    at_most(6, where + ": largest error over meshToVolume's", 1.0,
            row["ours_error_voxels"].get<double>() / row["openvdb_error_voxels"].get<double>());
  }
}

/// Of what is refined twice more: 16 times is linear.
void Shown::sizes() {
  std::map<std::string, std::vector<const json*>> calls;
  for (const json& row : rows_)
    if (row.value("kind", "") == "growth") calls[row["input"].get<std::string>() + ": " + row["what"].get<std::string>()].push_back(&row);
  for (const auto& [call, of] : calls) {
    // The parts that do not grow weigh where there is little to do.
    constexpr double kFaces = 2e5;
    const json *small = nullptr, *large = of.back();
    for (const json* row : of)
      if (small == nullptr && (*row)["units"].get<double>() >= kFaces) small = row;
    if (small == nullptr || small == large || call.starts_with("field") || call.find("assimp") != std::string::npos) continue;
    const double units = (*large)["units"].get<double>() / (*small)["units"].get<double>();
    for (const char* field : {"cpu_s", "peak_bytes"})
      at_most(7, fmt::format("{}, {} times the faces, {}", call, std::round(units), field), 18.0 / 16.0 * units,
              (*large)[field].get<double>() / (*small)[field].get<double>());
    if ((*large)["units"].get<double>() < 4e6) continue;
    if (call == "ply: render, mesh") {
      at_most(7, call + ", 4.4 M quads, processor seconds", 6.0, (*large)["cpu_s"].get<double>());
      at_most(7, call + ", 4.4 M quads, GB", 1.5, 1e-9 * (*large)["peak_bytes"].get<double>());
    }
    if (call == "ply: render, mesh_level_set, 512 voxels")
      at_most(7, call + ", 4.4 M quads, processor seconds", 20.0, (*large)["cpu_s"].get<double>());
    if (call.ends_with(": info")) at_most(7, call + ", 4.4 M quads, processor seconds", 15.0, (*large)["cpu_s"].get<double>());
  }
}

}  // namespace

nlohmann::json must_shows(const nlohmann::json& rows) {
  Shown shown(rows);
  shown.speed();
  shown.accuracy();
  shown.growth();
  shown.grids();
  shown.analytic();
  shown.threads();
  shown.targets();
  shown.conversions();
  shown.sizes();
  json all = shown.take();
  std::stable_sort(all.begin(), all.end(), [](const json& a, const json& b) { return a["number"].get<int>() < b["number"].get<int>(); });
  return all;
}

void print_must_shows(const nlohmann::json& shown, std::FILE* table) {
  if (shown.empty()) return;
  int met = 0;
  fmt::print(table, "\n{:3} {:72} {:>14} {:>10}\n", "", "what must be shown", "bound", "figure");
  for (const json& one : shown) {
    met += one["met"].get<bool>();
    fmt::print(table, "{:3} {:72} {:>14} {:10.4g}  {}\n", one["number"].get<int>(), one["what"].get<std::string>(),
               one["bound"].get<std::string>(), one["figure"].get<double>(), one["met"].get<bool>() ? "met" : "MISSED");
  }
  fmt::print(table, "{} of {} met\n", met, shown.size());
}

}  // namespace limn::bench
