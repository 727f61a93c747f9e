#include "tests/bench/against.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include "sdf/error.h"
#include "sdf/quantile.h"

namespace limn::bench {
namespace {

using nlohmann::json;

struct Timed {
  bool ours = false;
  std::vector<double> before_ms{}, after_ms{};
};
using TimedRows = std::map<std::string, Timed>;

json read_document(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw InputError({file, "--against", file, "cannot be read", "a file that limn-bench wrote"});
  json document = json::parse(stream, nullptr, false);
  if (document.is_discarded() || !document.is_object() || !document.contains("rows") || !document["rows"].is_array())
    throw InputError({file, "--against", file, "holds no rows", "a file that limn-bench wrote"});
  return document;
}

std::string text(const json& row, const char* field) {
  const auto found = row.find(field);
  if (found == row.end()) return {};
  return found->is_string() ? found->get<std::string>() : found->dump();
}

/// What a row times: label and milliseconds. Rows of other kinds have none.
std::vector<std::pair<std::string, double>> times_of(const json& row) {
  std::vector<std::pair<std::string, double>> result;
  if (!row.is_object()) return result;
  const std::string where =
      fmt::format("{} {} {} thr", text(row, "object") + text(row, "scene"), text(row, "voxels"), text(row, "threads"));
  const auto add = [&](const std::string& contestant, const char* field) {
    if (row.contains(field) && row[field].is_number()) result.emplace_back(where + ": " + contestant, row[field].get<double>());
  };
  // The first revisions kept the kind of a row in `name` and the contestant's whole name in `contestant`.
  const std::string kind = row.contains("kind") ? text(row, "kind") : text(row, "name");
  if (kind == "convert") {
    add("limn mesh to level set", "ours_ms");
    add("OpenVDB meshToVolume", "openvdb_ms");
  } else if (kind == "image") {
    const std::string contestant = text(row, "contestant");
    add(contestant.starts_with("OpenCV") ? contestant : "limn " + contestant, "median_ms");
  } else if (kind == "march" || kind == "field") {
    add(row.contains("kind") ? text(row, "name") : text(row, "contestant"), "median_ms");
  }
  return result;
}

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> files;
  std::istringstream stream(list);
  for (std::string file; std::getline(stream, file, ',');) files.push_back(file);
  return files;
}

void take_document(const json& document, std::vector<double> Timed::*times, size_t round, TimedRows& rows) {
  for (const json& row : document["rows"]) {
    for (const auto& [label, ms] : times_of(row)) {
      Timed& timed = rows[label];
      timed.ours = label.find(": limn ") != std::string::npos;
      // A label that comes twice in one document (the floor beside several suites) counts once.
      if ((timed.*times).size() == round) (timed.*times).push_back(ms);
    }
  }
}

double ratio_of(const Timed& timed) {
  std::vector<double> ratios;
  for (size_t i = 0; i < timed.before_ms.size(); ++i) ratios.push_back(timed.after_ms[i] / timed.before_ms[i]);
  return upper_median(ratios);
}

}  // namespace

nlohmann::json compare_revisions(const std::string& before, const std::string& after, double limit, std::FILE* table) {
  const std::vector<std::string> before_files = split(before), after_files = split(after);
  if (before_files.empty() || before_files.size() != after_files.size())
    throw InputError({{}, "--against", before + " " + after, "not as many files before as after", "as many"});
  TimedRows rows;
  for (size_t round = 0; round < before_files.size(); ++round) {
    take_document(read_document(before_files[round]), &Timed::before_ms, round, rows);
    take_document(read_document(after_files[round]), &Timed::after_ms, round, rows);
  }
  json document = {
      {"limit", limit}, {"rounds", before_files.size()}, {"rows", json::array()}, {"slower", json::array()}, {"only_one", json::array()}};
  fmt::print(table, "{:72} {:>11} {:>11} {:>7}\n", "contestant", "before, ms", "after, ms", "ratio");
  size_t compared = 0;
  for (const auto& [label, timed] : rows) {
    if (timed.before_ms.size() != before_files.size() || timed.after_ms.size() != before_files.size()) {
      document["only_one"].push_back(label);
      continue;
    }
    const double ratio = ratio_of(timed);
    const bool slower = timed.ours && ratio > limit;
    compared += timed.ours;
    fmt::print(table, "{:72} {:11.2f} {:11.2f} {:7.3f}{}\n", label, upper_median(timed.before_ms), upper_median(timed.after_ms), ratio,
               slower ? "  SLOWER" : "");
    document["rows"].push_back({{"contestant", label},
                                {"ours", timed.ours},
                                {"before_ms", upper_median(timed.before_ms)},
                                {"after_ms", upper_median(timed.after_ms)},
                                {"ratio", ratio}});
    if (slower) document["slower"].push_back(label);
  }
  for (const json& label : document["only_one"]) fmt::print(table, "only in one revision: {}\n", label.get<std::string>());
  if (compared == 0)
    throw InputError({{}, "--against", before + " " + after, "no row of limn's is in all files", "files of the same suites and objects"});
  const size_t slower = document["slower"].size();
  document["verdict"] = slower == 0
                            ? fmt::format("none of limn's {} rows takes more than {:g} times as long as before", compared, limit)
                            : fmt::format("{} of limn's {} rows take more than {:g} times as long as before", slower, compared, limit);
  fmt::print(table, "{}\n", document["verdict"].get<std::string>());
  return document;
}

}  // namespace limn::bench
