// A study before it runs: which cells it has, what they are called, how they are shared out.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include "run_program.h"
#include "samples/study/cost.h"
#include "samples/study/key.h"
#include "samples/study/shard.h"
#include "sdf/error.h"

namespace limn {
namespace {

using Change = std::function<void(Options&)>;

/// One cell, so that its key can be watched.
Options one_cell(const std::string& input) {
  Options options;
  options.input = input;
  options.size_px = glm::ivec2(64, 48);
  options.surfaces = {"mesh"};
  options.study.levels = {1};
  options.study.normals = {NormalKind::vertex};
  options.study.views = 1;
  options.compared_methods = {"rim"};
  return options;
}

Study study_of(const Options& options) {
  Options own = options;
  if (!own.study.levels.empty()) own.level = own.study.levels.back();
  return plan_study(own, load_input(own));
}

std::string key_of(const Options& base, const Change& change = {}) {
  Options options = base;
  if (change) change(options);
  const Study study = study_of(options);
  EXPECT_EQ(study.cells.size(), 1u);
  return study.cells.front().key;
}

std::set<std::string> keys_of(const Study& study) {
  std::set<std::string> keys;
  for (const StudyCell& cell : study.cells) keys.insert(cell.key);
  return keys;
}

TEST(StudyPlan, CellsAreTheProductOfTheAxes) {
  Options options;
  options.input = "ellipsoid";
  options.study.levels = {0, 2, 3};
  options.study.voxels = {16, 32};
  options.study.normals = {NormalKind::flat, NormalKind::limit};
  options.study.gradients = {"cell", "cubic"};
  options.study.thresholds = {0.2, 0.4};
  options.study.views = 5;
  options.compared_methods = {"rim", "sobel"};
  const Study study = study_of(options);
  EXPECT_EQ(study.models.size(), 1u + 3u * 2u + 2u * 2u) << "the field, meshes, level sets";
  EXPECT_EQ(study.methods.size(), 3u) << "sobel has no threshold of N.V and is drawn once";
  EXPECT_EQ(study.cells.size(), 11u * 5u * 3u);
  EXPECT_EQ(keys_of(study).size(), study.cells.size());
  EXPECT_EQ(study.head.cells, static_cast<std::int64_t>(study.cells.size()));
}

TEST(StudyPlan, EachRepresentationVariesWhatItReadsAndNothingElse) {
  for (const char* input : {"ellipsoid", "rook"}) {
    Options options;
    options.input = input;
    const Study study = study_of(options);
    for (const StudyModel& model : study.models) {
      std::set<std::string> names;
      for (const auto& [name, value] : model.parameters) names.insert(name);
      const std::map<std::string, std::set<std::string>> expected = {{"analytic", {}},
                                                                     {"mesh", {"level", "normals"}},
                                                                     {"level_set", {"gradient", "voxels"}},
                                                                     {"mesh_level_set", {"gradient", "level", "voxels"}}};
      EXPECT_EQ(names, expected.at(model.surface)) << model.surface;
      EXPECT_TRUE(model.refused.empty()) << model.refused;
    }
  }
}

TEST(StudyPlan, AReferenceIsFinerThanAnyLevelOfTheSweep) {
  Options options = one_cell("rook");
  for (const int level : {1, 4, 5}) {
    options.study.levels = {level};
    EXPECT_GT(study_of(options).reference.level, level);
  }
}

TEST(StudyPlan, WhatCannotBeModelledOrWouldNotFitIsARefusedModelWithItsReason) {
  Options options = one_cell("rook");
  options.surfaces = {"analytic"};
  EXPECT_FALSE(study_of(options).models.front().refused.empty());
  options = one_cell("ellipsoid");
  options.study.levels = {8};
  options.study.max_bytes = 10'000'000;
  EXPECT_NE(study_of(options).models.front().refused.find("the default of --max-memory leaves 10.0 MB"), std::string::npos);
  options.max_memory = 10'000'000;
  const StudyModel model = study_of(options).models.front();
  EXPECT_NE(model.refused.find("--max-memory leaves 10.0 MB"), std::string::npos) << model.refused;
  EXPECT_EQ(model.cost.build_ms, 0.0);
}

// A wall so thin that no sampling of a tessellation finds it closed.
TEST(StudyPlan, AShapeThatCannotBeTessellatedLeavesItsMeshesOutWithTheReason) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "limn-thin-shell.toml";
  std::ofstream(file) << "[[object]]\nname = \"skin\"\ncsg = \"difference\"\nshell = 0.002\n"
                         "of = [ { shape = \"box\", half = [1, 1, 1] }, { shape = \"sphere\", radius = 1.2 } ]\n";
  Options options;
  options.input = file.string();
  options.size_px = glm::ivec2(64, 48);
  options.study.views = 1;
  options.study.voxels = {32};
  options.study.gradients = {"central"};
  options.study.levels = {1};
  options.study.normals = {NormalKind::vertex};
  options.surfaces = {"analytic", "level_set", "mesh", "mesh_level_set"};
  const Study study = study_of(options);
  ASSERT_EQ(study.models.size(), 4u);
  for (const StudyModel& model : study.models) {
    if (model.surface.starts_with("mesh"))
      EXPECT_NE(model.refused.find("skin cannot be tessellated: "), std::string::npos) << model.surface << ": " << model.refused;
    else
      EXPECT_EQ(model.refused, "") << model.surface;
  }
  std::filesystem::remove(file);
}

TEST(StudyPlan, AThresholdThatNoMethodHasIsRefused) {
  Options options = one_cell("ellipsoid");
  options.compared_methods = {"sobel"};
  options.study.thresholds = {0.2};
  EXPECT_THROW(study_of(options), InputError);
}

TEST(StudyKey, ChangesWithEverythingThatTheCellDependsOn) {
  const Options base = one_cell("ellipsoid");
  const std::map<std::string, Change> changes = {
      {"none", [](Options&) {}},
      {"scene", [](Options& o) { o.input = "superellipsoid"; }},
      {"size", [](Options& o) { o.size_px = glm::ivec2(64, 49); }},
      {"eye", [](Options& o) { o.eye = glm::dvec3(3, 2, 4); }},
      {"eye by 1e-12", [](Options& o) { o.eye = glm::dvec3(3, 2, 4 + 1e-12); }},
      {"fov", [](Options& o) { o.fov_deg = 36; }},
      {"projection", [](Options& o) { o.ortho_height = 3; }},
      {"level", [](Options& o) { o.study.levels = {2}; }},
      {"normals", [](Options& o) { o.study.normals = {NormalKind::flat}; }},
      {"threshold", [](Options& o) { o.study.thresholds = {0.41}; }},
      {"softness",
       [](Options& o) {
         o.sets = {{"softness", "0.01"}};
       }},
      {"method", [](Options& o) { o.compared_methods = {"sobel"}; }},
      {"flicker", [](Options& o) { o.study.flicker = true; }},
      {"level set", [](Options& o) { o.surfaces = {"level_set"}, o.study.voxels = {16}, o.study.gradients = {"cell"}; }},
      {"voxels", [](Options& o) { o.surfaces = {"level_set"}, o.study.voxels = {17}, o.study.gradients = {"cell"}; }},
      {"gradient", [](Options& o) { o.surfaces = {"level_set"}, o.study.voxels = {16}, o.study.gradients = {"cubic"}; }},
      {"half width",
       [](Options& o) { o.surfaces = {"level_set"}, o.study.voxels = {16}, o.study.gradients = {"cell"}, o.half_width_voxels = 4; }},
  };
  std::map<std::string, std::string> seen;
  for (const auto& [name, change] : changes) {
    const std::string key = key_of(base, change);
    EXPECT_TRUE(seen.emplace(key, name).second) << name << " has the key of " << seen[key];
  }
  Options cage = one_cell("rook");
  EXPECT_NE(key_of(cage), key_of(cage, [](Options& o) { o.scheme = Scheme::bilinear; }));
}

TEST(StudyKey, ChangesWithTheInputsContentAndNotWithItsName) {
  const TemporaryFolder folder;
  const std::string text = "[[object]]\nshape = \"ellipsoid\"\nradii = [1.0, 0.7, 0.5]\n";
  const std::string key = key_of(one_cell(folder.write("a.toml", text)));
  EXPECT_EQ(key, key_of(one_cell(folder.write("b.toml", text))));
  std::filesystem::create_directory(folder.path() / "elsewhere");
  EXPECT_EQ(key, key_of(one_cell(folder.write("elsewhere/a.toml", text))));
  EXPECT_NE(key, key_of(one_cell(folder.write("a.toml", "[[object]]\nshape = \"ellipsoid\"\nradii = [1.0, 0.7, 0.501]\n"))));
  const std::string tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  const std::string scene = folder.write("m.toml", "[[object]]\nmesh = \"t.obj\"\nscheme = \"loop\"\n");
  folder.write("t.obj", tetrahedron);
  const std::string mesh_key = key_of(one_cell(scene));
  folder.write("t.obj", "v 0 0 0.001\n" + tetrahedron.substr(8));
  EXPECT_NE(mesh_key, key_of(one_cell(scene))) << "a file that the scene names has changed";
}

TEST(StudyKey, DoesNotDependOnHowTheStudyIsRunNorOnItsOtherCells) {
  const Options base = one_cell("ellipsoid");
  const std::string key = key_of(base);
  EXPECT_EQ(key, key_of(base, [](Options& o) { o.threads = 1; }));
  EXPECT_EQ(key, key_of(base, [](Options& o) { o.study.shard = 2, o.study.shards = 5; }));
  EXPECT_EQ(key, key_of(base, [](Options& o) { o.outputs = {"elsewhere"}, o.quiet = true, o.study.fresh = true; }));
  EXPECT_EQ(key, key_of(base, [](Options& o) { o.study.max_bytes = 500'000'000; }));
  EXPECT_EQ(key, key_of(base, [](Options& o) { o.study.voxels = {99}, o.study.gradients = {"cubic"}; })) << "a mesh reads neither";
  Options wide = base;
  wide.study.levels = {0, 1, 2};
  wide.study.normals = {NormalKind::flat, NormalKind::vertex};
  wide.study.thresholds = {0.2, 0.4};
  wide.compared_methods = {"sobel", "rim"};
  EXPECT_TRUE(keys_of(study_of(wide)).contains(key));
  EXPECT_NE(study_of(wide).head.id, study_of(base).head.id);
}

TEST(StudyCost, GrowsAsFacesVoxelsAndPixelsDo) {
  Options options = one_cell("ellipsoid");
  const auto cost = [&](const Change& change) {
    Options own = options;
    change(own);
    return study_of(own).models.front().cost;
  };
  // Differences: what a model or a picture takes at any size falls out.
  const auto growth = [](double a, double b, double c) { return (c - b) / (b - a); };
  const auto mesh = [&](int level) { return cost([level](Options& o) { o.study.levels = {level}; }); };
  EXPECT_NEAR(double(mesh(5).bytes) / double(mesh(3).bytes), 16.0, 0.1);
  EXPECT_NEAR(growth(mesh(3).build_ms, mesh(4).build_ms, mesh(5).build_ms), 4.0, 1e-6);
  options.surfaces = {"level_set"};
  options.study.gradients = {"central"};
  const auto grid = [&](int voxels, int width_px = 64) {
    return cost([=](Options& o) { o.study.voxels = {voxels}, o.size_px = glm::ivec2(width_px, width_px * 3 / 4); });
  };
  EXPECT_NEAR(growth(grid(64).build_ms, grid(128).build_ms, grid(256).build_ms), 4.0, 1e-6);
  EXPECT_NEAR(growth(grid(64, 64).trace_ms, grid(64, 128).trace_ms, grid(64, 256).trace_ms), 4.0, 1e-6);
}

TEST(StudyCost, TheLedgerLearnsHowFastTheMachineIs) {
  CostLedger ledger;
  ledger.plan("build", 1e6);
  ledger.plan("trace", 1e6);
  EXPECT_DOUBLE_EQ(ledger.remaining_ms(), 2e6);
  ledger.done("build", 5e5, 1e6);
  EXPECT_NEAR(ledger.remaining_ms(), 5e5 * 2.0 + 1e6 * 2.0, 0.01e6) << "half as fast as thought, at what was not tried yet too";
  ledger.done("trace", 5e5, 2.5e5);
  EXPECT_NEAR(ledger.remaining_ms(), 5e5 * 2.0 + 5e5 * 0.5, 0.01e6);
  ledger.drop("trace", 5e5);
  ledger.done("build", 5e5, 1e6);
  EXPECT_DOUBLE_EQ(ledger.remaining_ms(), 0.0);
  EXPECT_DOUBLE_EQ(ledger.spent_ms(), 2.25e6);
  CostLedger other;
  other.plan("build", 1e6);
  other.learn("build", 1.0, 50.0);
  EXPECT_LT(other.remaining_ms(), 1.6e6) << "a moment's work says little";
}

Options some_study() {
  Options options;
  options.input = *rc::gen::element<std::string>("ellipsoid", "rook", "teacup");
  options.study.views = *rc::gen::inRange(1, 9);
  options.study.levels = {0, 1, *rc::gen::inRange(2, 6)};
  options.study.voxels = {16, *rc::gen::inRange(17, 300)};
  if (*rc::gen::arbitrary<bool>()) options.compared_methods = {"rim", "sobel"};
  return options;
}

RC_GTEST_PROP(StudyShards, PartitionTheCells, ()) {
  const Study study = study_of(some_study());
  const int count = *rc::gen::inRange(1, 40);
  std::vector<int> times(study.cells.size(), 0);
  for (int shard = 1; shard <= count; ++shard) {
    for (const size_t cell : cells_of_shard(study, shard, count)) ++times[cell];
  }
  RC_ASSERT(std::all_of(times.begin(), times.end(), [](int n) { return n == 1; }));
}

RC_GTEST_PROP(StudyShards, AreBalancedAndDoNotBuildEveryModelEverywhere, ()) {
  const Study study = study_of(some_study());
  const int count = *rc::gen::inRange(2, 12);
  const std::vector<int> shards = shards_of(study, count);
  const std::vector<double> costs = shard_costs(study, shards, count);
  double sum = 0.0, whole = 0.0, heaviest_view = 0.0;
  for (const double cost : costs) sum += cost;
  for (const double cost : shard_costs(study, std::vector<int>(study.cells.size(), 1), 1)) whole += cost;
  for (const StudyModel& model : study.models) {
    heaviest_view = std::max(heaviest_view,
                             model.cost.build_ms + study.looks() * model.cost.trace_ms + double(study.methods.size()) * study.measure_ms());
  }
  // Greedy scheduling is off by less than its largest piece (Graham 1969), which is half a share or a single view.
  const double piece = std::max(0.5 * whole / count + heaviest_view, heaviest_view);
  RC_ASSERT(*std::max_element(costs.begin(), costs.end()) <= sum / count + piece);
  std::map<size_t, std::set<int>> built;
  for (size_t i = 0; i < shards.size(); ++i) built[study.cells[i].model].insert(shards[i]);
  for (const auto& [model, parts] : built) {
    const double cost =
        study.models[model].cost.build_ms +
        double(study.cameras.size()) * (study.models[model].cost.trace_ms + double(study.methods.size()) * study.measure_ms());
    if (cost < 0.5 * whole / count) RC_ASSERT(parts.size() == 1);
  }
}

}  // namespace
}  // namespace limn
