#include "samples/study/record.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "samples/spec/flags.h"
#include "samples/spec/utf8.h"
#include "samples/study/whole_number.h"
#include "sdf/error.h"
#include "sdf/output_file.h"
#include "sdf/version.h"

namespace limn {
namespace {

// A truth that may lie farther off than this is exact in method only: what is measured against it is not.
constexpr double kExactBound_px = 0.1;

namespace fs = std::filesystem;

Json to_json(const TruthRecord& truth) {
  Json json = {{"view", truth.view}, {"threshold", truth.threshold}};
  if (!truth.failed.empty()) {
    json["failed"] = truth.failed;
    return json;
  }
  json["from"] = truth.from;
  json["exact"] = truth.exact;
  json["bound_px"] = number_or_null(truth.bound_px);
  json["notes"] = truth.notes;
  return json;
}

int whole(const Json& json, const char* name) {
  const Json& value = json.at(name);
  if (const std::optional<int> number = whole_number<int>(value)) return *number;
  throw Json::type_error::create(302, fmt::format("{} is not a whole number", name), &value);
}

TruthRecord truth_from(const Json& json) {
  TruthRecord truth;
  truth.view = whole(json, "view");
  truth.threshold = json.at("threshold").get<double>();
  truth.failed = json.value("failed", "");
  if (!truth.failed.empty()) return truth;
  truth.from = json.at("from").get<std::string>();
  truth.exact = json.at("exact").get<bool>();
  truth.bound_px = json.at("bound_px").is_null() ? std::numeric_limits<double>::quiet_NaN() : json.at("bound_px").get<double>();
  truth.notes = json.at("notes").get<std::vector<std::string>>();
  return truth;
}

Json to_json(const StudyRecord& record) {
  const StudyHead& head = record.head;
  Json json = {{"id", head.id},         {"limn", record.version},          {"format", record.format}, {"input", head.input},
               {"scene", head.scene},   {"input_hash", record.input_hash}, {"call", head.call},       {"truth", head.truth},
               {"exact", head.exact},   {"pictures", record.pictures},     {"views", head.views},     {"surfaces", head.surfaces},
               {"shard", record.shard}, {"shards", record.shards},         {"truths", Json::array()}, {"cells", Json::array()}};
  json["warnings"] = head.warnings;
  json["parameters"] = head.parameters;
  json["machine"] = head.machine;
  for (const TruthRecord& truth : record.truths) json["truths"].push_back(to_json(truth));
  for (const PlannedCell& cell : record.cells) json["cells"].push_back({{"key", cell.key}, {"text", cell.text}});
  return json;
}

double largest_bound_px(const std::vector<TruthRecord>& truths) {
  double bound_px = 0.0;
  for (const TruthRecord& truth : truths) bound_px = std::max(bound_px, truth.bound_px);
  return bound_px;
}

// Keys name files (the thumbnails) and the scene a folder: whoever hands us a part must not choose where we write.
bool is_key(const std::string& key) {
  return !key.empty() && key.size() <= 64 &&
         std::all_of(key.begin(), key.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; });
}

bool stays_in_place(const StudyRecord& record) {
  const std::string& scene = record.head.scene;
  return scene != "." && scene != ".." && scene.find('/') == std::string::npos && scene.find('\0') == std::string::npos &&
         std::all_of(record.cells.begin(), record.cells.end(), [](const PlannedCell& cell) { return is_key(cell.key); });
}

StudyRecord record_from(const Json& json) {
  StudyRecord record;
  StudyHead& head = record.head;
  head.id = json.at("id").get<std::string>();
  record.version = json.at("limn").get<std::string>();
  record.format = whole(json, "format");
  head.input = json.at("input").get<std::string>();
  head.scene = json.at("scene").get<std::string>();
  record.input_hash = json.at("input_hash").get<std::string>();
  head.call = json.at("call").get<std::string>();
  head.truth = json.at("truth").get<std::string>();
  head.exact = json.at("exact").get<bool>();
  record.pictures = json.at("pictures").get<std::string>();
  head.views = whole(json, "views");
  head.surfaces = json.at("surfaces").get<std::vector<std::string>>();
  record.shard = whole(json, "shard");
  record.shards = whole(json, "shards");
  head.warnings = json.value("warnings", std::vector<std::string>{});
  head.parameters = json.value("parameters", std::vector<std::string>{});
  head.machine = json.value("machine", std::string{});
  for (const Json& truth : json.at("truths")) record.truths.push_back(truth_from(truth));
  if (!head.exact) head.truth_within_px = largest_bound_px(record.truths);
  for (const Json& cell : json.at("cells")) record.cells.push_back({cell.at("key").get<std::string>(), cell.at("text").get<std::string>()});
  head.cells = static_cast<std::int64_t>(record.cells.size());
  return record;
}

}  // namespace

std::string machine_text() {
  std::ifstream file("/proc/cpuinfo");
  std::string name = "an unknown processor";
  for (std::string line; std::getline(file, line);) {
    const size_t colon = line.find(':');
    if (!line.starts_with("model name") || colon == std::string::npos) continue;
    name = valid_utf8(line.substr(std::min(colon + 2, line.size())));
    break;
  }
  double load = 0.0;
  const bool known = getloadavg(&load, 1) == 1;
  return fmt::format("{}, {} threads{}", name, tbb::this_task_arena::max_concurrency(),
                     known ? fmt::format(", load {:.1f} when it began", load) : "");
}

StudyRecord record_of(const Study& study) {
  StudyRecord record;
  record.head = study.head;
  record.head.machine = machine_text();
  record.version = kVersion;
  record.input_hash = study.input_hash;
  record.pictures = study.reference_words;
  for (const StudyCell& cell : study.cells) record.cells.push_back({cell.key, cell_text(study, cell)});
  add_truths({}, record);
  return record;
}

void add_truths(const std::vector<TruthRecord>& truths, StudyRecord& record) {
  const auto order = [](const TruthRecord& a, const TruthRecord& b) {
    return std::pair(a.view, a.threshold) < std::pair(b.view, b.threshold);
  };
  for (const TruthRecord& truth : truths) {
    const auto at = std::lower_bound(record.truths.begin(), record.truths.end(), truth, order);
    if (at == record.truths.end() || order(truth, *at)) record.truths.insert(at, truth);
  }
  StudyHead& head = record.head;
  head.exact = true;
  std::string failed, from;
  double bound_px = 0.0;
  for (const TruthRecord& truth : record.truths) {
    if (!truth.failed.empty()) {
      failed = truth.failed;
      continue;
    }
    head.exact = head.exact && truth.exact && truth.bound_px <= kExactBound_px;
    if (from.empty() || truth.bound_px > bound_px) from = truth.from;
    bound_px = std::max(bound_px, truth.bound_px);
  }
  head.truth = "pictures against " + record.pictures;
  if (!from.empty()) head.truth = fmt::format("{}, within {:.2g} px; {}", from, bound_px, head.truth);
  if (!failed.empty()) head.truth += fmt::format("; no truth for some borders: {}", failed);
  if (from.empty()) head.exact = false;
  head.truth_within_px = head.exact ? 0.0 : largest_bound_px(record.truths);
}

fs::path record_file(const fs::path& folder) { return folder / "study.json"; }

void write_record(const StudyRecord& record, const fs::path& folder) {
  write_whole(record_file(folder), to_json(record).dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::optional<StudyRecord> read_record(const fs::path& folder) {
  const fs::path file = record_file(folder);
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return std::nullopt;
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_record(text.str(), file);
}

StudyRecord parse_record(std::string_view text, const fs::path& file) {
  const Json json = Json::parse(text, nullptr, false);
  const InputError foreign({file.string(), "", "", "not written by limn study; choose another folder, or start over (fresh = true)", ""});
  if (!json.is_object()) throw foreign;
  try {
    StudyRecord record = record_from(json);
    if (!stays_in_place(record)) throw foreign;
    return record;
  } catch (const Json::exception&) {
    throw foreign;
  }
}

std::string difference(const StudyRecord& there, const StudyRecord& here) {
  if (there.head.id == here.head.id) return "";
  if (there.version != here.version || there.format != here.format)
    return fmt::format("limn {} (rows of format {}) there, limn {} (rows of format {}) here", there.version, there.format, here.version,
                       here.format);
  if (there.head.scene != here.head.scene) return fmt::format("the scene is {} there, {} here", there.head.scene, here.head.scene);
  if (there.input_hash != here.input_hash) return "the input's content is another";
  const auto old_settings = settings_of_call(there.head.call), new_settings = settings_of_call(here.head.call);
  for (const auto& [name, value] : new_settings) {
    const auto found = old_settings.find(name);
    if (found == old_settings.end()) return fmt::format("no {} there, {} here", name, value);
    if (found->second != value) return fmt::format("{} {} there, {} here", name, found->second, value);
  }
  for (const auto& [name, value] : old_settings) {
    if (!new_settings.contains(name)) return fmt::format("{} {} there, none here", name, value);
  }
  return "what pictures are held against: " + there.pictures + " there, " + here.pictures + " here";
}

}  // namespace limn
