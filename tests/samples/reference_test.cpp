// docs/reference.md is what the program has, and the program has no key that it leaves out.

#include "samples/reference/reference.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "raymarch/border.h"
#include "run_program.h"
#include "samples/spec/surface_setting.h"

namespace limn {
namespace {

using nlohmann::json;

std::string text_of(const std::string& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

TEST(Reference, ThePageIsWhatTheProgramPrints) {
  const RunResult result = run_limn({"list", "reference"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, reference_page());
  EXPECT_TRUE(result.out == text_of(LIMN_SOURCE_DIR "/docs/reference.md"))
      << "docs/reference.md is older than the program: limn list reference > docs/reference.md";
}

/// The table of docs/methods.md has a row for each method, and both galleries its picture.
TEST(Reference, EveryMethodIsExplainedAndInTheGalleries) {
  const std::string methods = text_of(LIMN_SOURCE_DIR "/docs/methods.md"), readme = text_of(LIMN_SOURCE_DIR "/README.md");
  for (const std::string& name : border_methods().names()) {
    EXPECT_NE(methods.find(fmt::format("\n| `{}` | ", name)), std::string::npos)
        << "docs/methods.md has no row that says how it fails: " << name;
    const std::string picture = fmt::format("samples/pictures/methods/{}.png", name);
    EXPECT_NE(methods.find("(../" + picture + ")"), std::string::npos) << "not in the gallery of docs/methods.md: " << picture;
    EXPECT_NE(readme.find("(" + picture + ")"), std::string::npos) << "not in the gallery of README.md: " << picture;
    EXPECT_TRUE(std::filesystem::exists(LIMN_SOURCE_DIR "/" + picture)) << "limn-out/demo/methods has it after ./run demo: " << picture;
  }
}

TEST(Reference, EveryKeyThatSceneFilesAreReadForHasALine) {
  const std::regex asked("reader\\.(?:take|text|number|number_between|integer|numbers|vector3|color|tables)\\(\"(\\w+)\"");
  std::set<std::string> known = {"camera", "surface", "border", "object"};
  for (const DocumentedKey& key : scene_keys()) {
    known.insert(std::string(key.key));
    EXPECT_FALSE(key.help.empty()) << key.key;
  }
  int found = 0;
  std::set<std::string> read;
  for (const char* file : {"/samples/input/scene_file.cpp", "/samples/input/field_reader.cpp"}) {
    const std::string source = text_of(std::string(LIMN_SOURCE_DIR) + file);
    for (std::sregex_iterator at(source.begin(), source.end(), asked), end; at != end; ++at, ++found) {
      EXPECT_TRUE(known.contains((*at)[1])) << file << ": " << (*at)[1];
      read.insert((*at)[1]);
    }
  }
  EXPECT_GT(found, 30);
  // The settings of [surface] are read by their list: each is known, and complained about by its name.
  const TemporaryFolder folder;
  for (const SurfaceSetting& setting : surface_setting_list()) {
    folder.write("scene.toml", fmt::format("[surface]\n{} = [[\"no value\"]]\n[[object]]\nshape = \"sphere\"\n", setting.name));
    const RunResult run = run_limn({"info", folder.file("scene.toml")});
    EXPECT_EQ(run.exit_code, 2) << setting.name;
    EXPECT_NE(run.err.find(fmt::format("surface.{}", setting.name)), std::string::npos) << run.err;
    read.insert(setting.name);
  }
  for (const DocumentedKey& key : scene_keys()) EXPECT_TRUE(read.contains(std::string(key.key))) << key.key << " is read nowhere";
}

TEST(Reference, TheColumnsOfRowsAreTheirs) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_limn({"study", "ellipsoid", "--size", "48x36", "--views", "1", "--voxels", "16", "--surface", "level_set", "-o",
                      folder.file("s"), "-q"})
                .exit_code,
            0);
  std::set<std::string> known;
  std::string header;
  for (const DocumentedKey& column : row_columns()) {
    known.insert(std::string(column.key));
    header.append(header.empty() ? "" : ",").append(column.key);
  }
  const std::string csv = text_of(folder.file("s/rows.csv")), rows = text_of(folder.file("s/rows.jsonl"));
  for (const Parameter& parameter : find_border_method("rim").parameters) header += ",rim." + parameter.name;
  const auto sorted = [](const std::string& line) {
    std::multiset<std::string> names;
    std::istringstream stream(line);
    for (std::string name; std::getline(stream, name, ',');) names.insert(name);
    return names;
  };
  EXPECT_EQ(sorted(csv.substr(0, csv.find('\n'))), sorted(header));
  known.insert({"surface_parameters", "method_parameters"});  // where the journal keeps what the table has in columns
  const json row = json::parse(rows.substr(0, rows.find('\n')));
  for (const auto& [name, value] : row.items()) EXPECT_TRUE(known.contains(name)) << name;
  for (const SurfaceSetting& setting : surface_setting_list()) known.erase(setting.name);
  known.erase("local");                     // a surface parameter, too
  EXPECT_GE(row.size(), known.size() - 1);  // all but `failed`
}

void add_paths(const json& value, const std::string& path, std::set<std::string>& paths) {
  if (value.is_array()) {
    for (const json& one : value) add_paths(one, path.empty() ? "" : path + "[]", paths);
  } else if (value.is_object()) {
    for (const auto& [name, one] : value.items()) {
      const std::string below = path.empty() ? name : path + "." + name;
      paths.insert(below);
      add_paths(one, below, paths);
    }
  }
}

/// Where a document holds the same thing in several places, the first of them.
std::string first_place(const std::string& command, std::string path) {
  const auto become = [&path](const std::string& from, const std::string& to) {
    if (path.starts_with(from)) path = to + path.substr(from.size());
  };
  if (command == "compare") become("reference.", "cells[]."), become("reference_cells[].", "cells[].");
  if (command == "contours") become("frames[].", "views[]."), become("frames", "views");
  if (command == "plan" && path != "finest.built") become("finest.", "chosen."), become("rejected[].", "chosen.");
  if (command == "plan") become("rejected[].", "chosen.");
  return path;
}

bool is_documented(const std::string& command, const std::string& path, std::set<const DocumentedKey*>& used) {
  bool found = false;
  for (const DocumentedKey& one : json_keys()) {
    if (one.where != command && one.where != "every") continue;
    const std::string key(one.key);
    const bool all_below = key.ends_with(".*") && path.starts_with(key.substr(0, key.size() - 1));
    const bool holds_it = key.starts_with(path + ".") || key.starts_with(path + "[]");
    if (key == path || all_below) used.insert(&one);
    found = found || key == path || all_below || holds_it;
  }
  return found;
}

TEST(Reference, EveryValueOfJsonHasALineAndEveryLineAValue) {
  const TemporaryFolder folder;
  const std::vector<std::string> size = {"--size", "64x48"};
  const std::vector<std::pair<std::string, std::vector<std::string>>> calls = {
      {"export", {"export", "ellipsoid", "--voxels", "24", "-o", folder.file("v.vdb")}},
      {"export", {"export", "ellipsoid", "--level", "1", "-o", folder.file("e.obj")}},
      {"render", {"render", "ellipsoid", "--size", "64x48", "-o", folder.file("a.exr")}},
      {"render", {"render", "ellipsoid", "--size", "64x48", "--frames", "3", "-o", folder.file("b.png")}},
      {"render", {"render", "ellipsoid", "--size", "64x48", "--ortho", "3", "-o", folder.file("o.png")}},
      {"compare",
       {"compare", "ellipsoid", "--size", "64x48", "--voxels", "16", "--level", "1", "--max-differ", "90%", "-o", folder.file("c")}},
      {"compare", {"compare", "rook", "--size", "64x48", "--voxels", "16", "--level", "1", "-o", folder.file("c2")}},
      {"study", {"study", "ellipsoid", "--size", "64x48", "--voxels", "16", "--levels", "1", "--views", "1", "-o", folder.file("s")}},
      {"study",
       {"study", "ellipsoid", "--size", "64x48", "--voxels", "16,24", "--levels", "1", "--views", "1", "--shard", "1/2", "-o",
        folder.file("half")}},
      {"merge", {"merge", folder.file("half"), "-o", folder.file("merged")}},
      {"plan", {"plan", "ellipsoid", "--size", "64x48", "--tolerance", "2", "--views", "1"}},
      {"info", {"info", LIMN_TEST_DATA "/spot_damaged.obj"}},
      {"info", {"info", "gyroid"}},
      {"info", {"info", folder.file("v.vdb")}},
      {"info", {"info", folder.file("a.exr")}},
      {"stability", {"stability", "--case", "seams_of_balls", "--surface", "analytic", "-o", folder.file("st")}},
      {"judge",
       {"judge", folder.write("d.svg", "<svg viewBox='0 0 64 48'><path d='M1 1h9' stroke='#000'/></svg>"), "--against", "ellipsoid",
        "--max-missed", "1%"}},
      {"contours", {"contours", "passing_tori", "--size", "64x48", "-o", folder.file("lines.json")}},
      {"contours", {"contours", "passing_tori", "--size", "64x48", "--frames", "12", "--turn", "360", "-o", folder.file("frames.json")}},
      {"list", {"list", "methods"}},
  };
  std::set<const DocumentedKey*> used;
  const auto look_at = [&](const std::string& command, const json& document) {
    std::set<std::string> paths;
    add_paths(document, "", paths);
    for (const std::string& path : paths) EXPECT_TRUE(is_documented(command, first_place(command, path), used)) << command << ": " << path;
  };
  for (auto [command, arguments] : calls) {
    arguments.push_back("--json");
    const RunResult result = run_limn(arguments);
    ASSERT_LE(result.exit_code, 1) << result.err;
    look_at(command, result.json());
  }
  look_at("rows.json", json::parse(text_of(folder.file("c2/rows.json"))));
  look_at("lines.json", json::parse(text_of(folder.file("lines.json"))));
  // What small healthy inputs do not have.
  const std::set<std::string> rare = {"truth[].failed",         "failed",
                                      "surface.voxel_size",     "views[].conflicts[].what",
                                      "views[].conflicts[].px", "tracks.events[].beside_conflict",
                                      "uniform_triangles",  // of plans that chose a local model
                                      "curvature_triangles",    "uniform_bytes",
                                      "curvature_bytes",        "chains[].id"};
  for (const DocumentedKey& one : json_keys())
    EXPECT_TRUE(used.contains(&one) || rare.contains(std::string(one.key))) << one.where << ": " << one.key << " has no value";
}

}  // namespace
}  // namespace limn
