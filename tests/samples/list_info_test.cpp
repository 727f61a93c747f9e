#include <gtest/gtest.h>

#include "run_program.h"
#include "tests/contract_shapes.h"

namespace limn {
namespace {

using nlohmann::json;

class ListKind : public testing::TestWithParam<const char*> {};

TEST_P(ListKind, JsonHasWhatTheContractNames) {
  const RunResult result = run_limn({"list", GetParam(), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json document = result.json();
  ASSERT_TRUE(document.is_array());
  ASSERT_FALSE(document.empty());
  for (const json& entry : document) {
    EXPECT_FALSE(entry.at("name").get<std::string>().empty());
    EXPECT_FALSE(entry.at("help").get<std::string>().empty()) << entry.at("name");
    EXPECT_TRUE(entry.at("source").is_string());
    EXPECT_TRUE(entry.at("inputs").is_array());
    for (const json& parameter : entry.at("parameters")) {
      for (const char* key : {"name", "unit", "default", "min", "max", "help"})
        EXPECT_TRUE(parameter.contains(key)) << entry.at("name") << "." << key;
      EXPECT_FALSE(parameter.at("default").is_null()) << entry.at("name") << "." << parameter.at("name");
    }
  }
}

TEST_P(ListKind, TextNamesTheSameEntries) {
  const json document = run_limn({"list", GetParam(), "--json"}).json();
  const RunResult text = run_limn({"list", GetParam()});
  EXPECT_EQ(text.exit_code, 0);
  for (const json& entry : document) EXPECT_NE(text.out.find(entry.at("name").get<std::string>()), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(List, ListKind,
                         testing::Values("shapes", "surfaces", "gradients", "normals", "methods", "metrics", "lines", "scenes"));

TEST(List, EveryShapeOfTheContractIsThereWithItsParameters) {
  const json document = run_limn({"list", "shapes", "--json"}).json();
  for (const auto& [name, parameters] : test::contract_shapes()) {
    bool found = false;
    for (const json& entry : document) {
      if (entry.at("name") != name) continue;
      found = true;
      std::vector<std::string> names;
      for (const json& parameter : entry.at("parameters")) names.push_back(parameter.at("name"));
      EXPECT_EQ(names, parameters) << name;
    }
    EXPECT_TRUE(found) << name;
  }
}

void expect_info_shape(const json& document) {
  EXPECT_TRUE(document.at("kind").is_string());
  EXPECT_TRUE(document.contains("bounds"));
  EXPECT_TRUE(document.at("counts").is_object());
  for (const json& finding : document.at("audit")) {
    for (const char* key : {"check", "severity", "value", "message"}) EXPECT_TRUE(finding.contains(key)) << key;
  }
}

TEST(Info, JsonHasWhatTheContractNamesForEveryScene) {
  for (const json& scene : run_limn({"list", "scenes", "--json"}).json()) {
    const RunResult result = run_limn({"info", scene.at("name"), "--json"});
    ASSERT_EQ(result.exit_code, 0) << scene.at("name") << result.err;
    const json document = result.json();
    expect_info_shape(document);
    ASSERT_TRUE(document.at("bounds").is_object()) << scene.at("name");
    EXPECT_FALSE(document.at("audit").empty()) << scene.at("name");
  }
}

TEST(Info, CountsACubeAndFindsItClosed) {
  const TemporaryFolder folder;
  const std::string cube = folder.write("cube.obj",
                                        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                                        "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  const RunResult result = run_limn({"info", cube, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json document = result.json();
  expect_info_shape(document);
  EXPECT_EQ(document.at("kind"), "mesh");
  EXPECT_EQ(document.at("counts").at("vertices"), 8);
  EXPECT_EQ(document.at("counts").at("faces"), 6);
  EXPECT_EQ(document.at("counts").at("quads"), 6);
  EXPECT_EQ(document.at("bounds").at("upper"), json({1.0, 1.0, 1.0}));
  for (const json& finding : document.at("audit")) EXPECT_NE(finding.at("severity"), "error") << finding;
}

TEST(Info, ReportsAnOpenMeshAsAFault) {
  const TemporaryFolder folder;
  const std::string sheet = folder.write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  bool complained = false;
  const json document = run_limn({"info", sheet, "--json"}).json();
  for (const json& finding : document.at("audit")) {
    complained = complained || (finding.at("check").get<std::string>().find("open") != std::string::npos &&
                                finding.at("severity") != "info" && finding.at("value") == 4);
  }
  EXPECT_TRUE(complained);
}

TEST(Info, ListsTheGridsOfAVolume) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_limn({"export", "ellipsoid", "--voxels", "24", "-o", folder.file("egg.vdb"), "-q"}).exit_code, 0);
  const RunResult result = run_limn({"info", folder.file("egg.vdb"), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json document = result.json();
  expect_info_shape(document);
  EXPECT_EQ(document.at("kind"), "level_set");
  EXPECT_EQ(document.at("grids").size(), 1u);
  EXPECT_GT(document.at("counts").at("active_voxels"), 500);
}

}  // namespace
}  // namespace limn
