// A study before it runs: which cells it has, what they are called, how they are shared out.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include "run_program.h"
#include "samples/experiment/cost.h"
#include "samples/study/key.h"
#include "samples/study/shard.h"
#include "sdf/error.h"

namespace limn {
namespace {

using Change = std::function<void(StudySpec&)>;

/// One cell, so that its key can be watched.
StudySpec one_cell(const std::string& input) {
  StudySpec spec;
  spec.experiment.input = input;
  spec.experiment.camera.size_px = glm::ivec2(64, 48);
  spec.experiment.surfaces = {"mesh"};
  spec.sweep.levels = {1};
  spec.sweep.normals = {NormalKind::vertex};
  spec.sweep.views = 1;
  spec.experiment.border.columns = {"rim"};
  return spec;
}

Study study_of(const StudySpec& spec) {
  StudySpec own = spec;
  if (!own.sweep.levels.empty()) own.experiment.surface.level = own.sweep.levels.back();
  return plan_study(own, load_input(own.experiment));
}

std::string key_of(const StudySpec& base, const Change& change = {}) {
  StudySpec spec = base;
  if (change) change(spec);
  const Study study = study_of(spec);
  EXPECT_EQ(study.cells.size(), 1u);
  return study.cells.front().key;
}

std::set<std::string> keys_of(const Study& study) {
  std::set<std::string> keys;
  for (const StudyCell& cell : study.cells) keys.insert(cell.key);
  return keys;
}

TEST(StudyPlan, CellsAreTheProductOfTheAxes) {
  StudySpec spec;
  spec.experiment.input = "ellipsoid";
  spec.sweep.levels = {0, 2, 3};
  spec.sweep.voxels = {16, 32};
  spec.sweep.normals = {NormalKind::flat, NormalKind::limit};
  spec.sweep.gradients = {"cell", "cubic"};
  spec.sweep.thresholds = {0.2, 0.4};
  spec.sweep.views = 5;
  spec.experiment.border.columns = {"rim", "sobel"};
  const Study study = study_of(spec);
  EXPECT_EQ(study.models.size(), 1u + 3u * 2u + 2u * 2u) << "the field, meshes, level sets";
  EXPECT_EQ(study.methods.size(), 3u) << "sobel has no threshold of N.V and is drawn once";
  EXPECT_EQ(study.cells.size(), 11u * 5u * 3u);
  EXPECT_EQ(keys_of(study).size(), study.cells.size());
  EXPECT_EQ(study.head.cells, static_cast<std::int64_t>(study.cells.size()));
}

TEST(StudyPlan, EachRepresentationVariesWhatItReadsAndNothingElse) {
  for (const char* input : {"ellipsoid", "rook"}) {
    StudySpec spec;
    spec.experiment.input = input;
    const Study study = study_of(spec);
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
  StudySpec spec = one_cell("rook");
  for (const int level : {1, 4, 5}) {
    spec.sweep.levels = {level};
    EXPECT_GT(study_of(spec).reference.level, level);
  }
}

TEST(StudyPlan, WhatCannotBeModelledOrWouldNotFitIsARefusedModelWithItsReason) {
  StudySpec spec = one_cell("rook");
  spec.experiment.surfaces = {"analytic"};
  EXPECT_FALSE(study_of(spec).models.front().refused.empty());
  spec = one_cell("ellipsoid");
  spec.sweep.levels = {8};
  spec.sweep.max_model_bytes = 10'000'000;
  EXPECT_NE(study_of(spec).models.front().refused.find("the default of max_memory leaves 10.0 MB"), std::string::npos);
  spec.experiment.limits.max_memory = 10'000'000;
  const StudyModel model = study_of(spec).models.front();
  EXPECT_NE(model.refused.find("max_memory leaves 10.0 MB"), std::string::npos) << model.refused;
  EXPECT_EQ(model.cost.build_ms, 0.0);
}

// A wall so thin that no sampling of a tessellation finds it closed.
TEST(StudyPlan, AShapeThatCannotBeTessellatedLeavesItsMeshesOutWithTheReason) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "limn-thin-shell.toml";
  std::ofstream(file) << "[[object]]\nname = \"skin\"\ncsg = \"difference\"\nshell = 0.002\n"
                         "of = [ { shape = \"box\", half = [1, 1, 1] }, { shape = \"sphere\", radius = 1.2 } ]\n";
  StudySpec spec;
  spec.experiment.input = file.string();
  spec.experiment.camera.size_px = glm::ivec2(64, 48);
  spec.sweep.views = 1;
  spec.sweep.voxels = {32};
  spec.sweep.gradients = {"central"};
  spec.sweep.levels = {1};
  spec.sweep.normals = {NormalKind::vertex};
  spec.experiment.surfaces = {"analytic", "level_set", "mesh", "mesh_level_set"};
  const Study study = study_of(spec);
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
  StudySpec spec = one_cell("ellipsoid");
  spec.experiment.border.columns = {"sobel"};
  spec.sweep.thresholds = {0.2};
  EXPECT_THROW(study_of(spec), InputError);
}

TEST(StudyKey, ChangesWithEverythingThatTheCellDependsOn) {
  const StudySpec base = one_cell("ellipsoid");
  const std::map<std::string, Change> changes = {
      {"none", [](StudySpec&) {}},
      {"scene", [](StudySpec& o) { o.experiment.input = "superellipsoid"; }},
      {"size", [](StudySpec& o) { o.experiment.camera.size_px = glm::ivec2(64, 49); }},
      {"eye", [](StudySpec& o) { o.experiment.camera.eye = glm::dvec3(3, 2, 4); }},
      {"eye by 1e-12", [](StudySpec& o) { o.experiment.camera.eye = glm::dvec3(3, 2, 4 + 1e-12); }},
      {"fov", [](StudySpec& o) { o.experiment.camera.fov_deg = 36; }},
      {"projection", [](StudySpec& o) { o.experiment.camera.ortho_height = 3; }},
      {"level", [](StudySpec& o) { o.sweep.levels = {2}; }},
      {"normals", [](StudySpec& o) { o.sweep.normals = {NormalKind::flat}; }},
      {"threshold", [](StudySpec& o) { o.sweep.thresholds = {0.41}; }},
      {"softness",
       [](StudySpec& o) {
         o.experiment.border.parameters = {{"softness", {{0.01}}}};
       }},
      {"method", [](StudySpec& o) { o.experiment.border.columns = {"sobel"}; }},
      {"flicker", [](StudySpec& o) { o.sweep.flicker = true; }},
      {"level set", [](StudySpec& o) { o.experiment.surfaces = {"level_set"}, o.sweep.voxels = {16}, o.sweep.gradients = {"cell"}; }},
      {"voxels", [](StudySpec& o) { o.experiment.surfaces = {"level_set"}, o.sweep.voxels = {17}, o.sweep.gradients = {"cell"}; }},
      {"gradient", [](StudySpec& o) { o.experiment.surfaces = {"level_set"}, o.sweep.voxels = {16}, o.sweep.gradients = {"cubic"}; }},
      {"half width",
       [](StudySpec& o) {
         o.experiment.surfaces = {"level_set"}, o.sweep.voxels = {16}, o.sweep.gradients = {"cell"},
         o.experiment.surface.half_width_voxels = 4;
       }},
  };
  std::map<std::string, std::string> seen;
  for (const auto& [name, change] : changes) {
    const std::string key = key_of(base, change);
    EXPECT_TRUE(seen.emplace(key, name).second) << name << " has the key of " << seen[key];
  }
  StudySpec cage = one_cell("rook");
  EXPECT_NE(key_of(cage), key_of(cage, [](StudySpec& o) { o.experiment.surface.scheme = Scheme::bilinear; }));
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
  const StudySpec base = one_cell("ellipsoid");
  const std::string key = key_of(base);
  EXPECT_EQ(key, key_of(base, [](StudySpec& o) { o.experiment.threads = 1; }));
  EXPECT_EQ(key, key_of(base, [](StudySpec& o) { o.sweep.max_model_bytes = 500'000'000; }));
  EXPECT_EQ(key, key_of(base, [](StudySpec& o) { o.sweep.voxels = {99}, o.sweep.gradients = {"cubic"}; })) << "a mesh reads neither";
  StudySpec wide = base;
  wide.sweep.levels = {0, 1, 2};
  wide.sweep.normals = {NormalKind::flat, NormalKind::vertex};
  wide.sweep.thresholds = {0.2, 0.4};
  wide.experiment.border.columns = {"sobel", "rim"};
  EXPECT_TRUE(keys_of(study_of(wide)).contains(key));
  EXPECT_NE(study_of(wide).head.id, study_of(base).head.id);
}

TEST(StudyCost, GrowsAsFacesVoxelsAndPixelsDo) {
  StudySpec spec = one_cell("ellipsoid");
  const auto cost = [&](const Change& change) {
    StudySpec own = spec;
    change(own);
    return study_of(own).models.front().cost;
  };
  // Differences: what a model or a picture takes at any size falls out.
  const auto growth = [](double a, double b, double c) { return (c - b) / (b - a); };
  const auto mesh = [&](int level) { return cost([level](StudySpec& o) { o.sweep.levels = {level}; }); };
  EXPECT_NEAR(double(mesh(5).bytes) / double(mesh(3).bytes), 16.0, 0.1);
  EXPECT_NEAR(growth(mesh(3).build_ms, mesh(4).build_ms, mesh(5).build_ms), 4.0, 1e-6);
  spec.experiment.surfaces = {"level_set"};
  spec.sweep.gradients = {"central"};
  const auto grid = [&](int voxels, int width_px = 64) {
    return cost([=](StudySpec& o) { o.sweep.voxels = {voxels}, o.experiment.camera.size_px = glm::ivec2(width_px, width_px * 3 / 4); });
  };
  EXPECT_NEAR(growth(grid(64).build_ms, grid(128).build_ms, grid(256).build_ms), 4.0, 1e-6);
  EXPECT_NEAR(growth(grid(64, 64).trace_ms, grid(64, 128).trace_ms, grid(64, 256).trace_ms), 4.0, 1e-6);
}

// Level sets of 256 voxels, built on two cores of an Intel Xeon with AVX-512 (limn render SCENE --surface level_set --verbose), ms.
TEST(StudyCost, FieldsOfManyPartsTakeWhatTheyTookWhereTheyWereMeasured) {
  const auto expected_ms = [](const std::string& scene) {
    const SceneInput input = load_input(one_cell(scene).experiment);
    SurfaceSettings settings;
    settings.kind = "level_set";
    settings.voxels = 256;
    return expected_cost(size_of(input.scene, settings, false), settings, 0.0).build_ms;
  };
  constexpr double kEllipsoid_ms = 26.0;
  const std::pair<const char*, double> measured[] = {{"superellipsoid", 117.0}, {"machined_part", 45.0}, {"gyroid", 184.0},
                                                     {"fused_spheres", 61.0},   {"passing_tori", 34.0},  {"honeycomb", 518.0}};
  const double ellipsoid = expected_ms("ellipsoid");
  for (const auto& [scene, ms] : measured) {
    const double share = expected_ms(scene) / ellipsoid / (ms / kEllipsoid_ms);
    EXPECT_GT(share, 0.5) << scene;
    EXPECT_LT(share, 2.0) << scene;
  }
}

TEST(StudyCost, LevelSetsOfMeshesWithHolesTakeLonger) {
  const TemporaryFolder folder;
  const auto build_ms = [&](const std::string& faces) {
    const std::string file = folder.file("tetrahedron.obj");
    std::ofstream(file) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n" << faces;
    SurfaceSettings settings;
    settings.kind = "mesh_level_set";
    return expected_cost(size_of(load_input(one_cell(file).experiment).scene, settings), settings, 0.0).build_ms;
  };
  const std::string three = "f 1 3 2\nf 1 2 4\nf 1 4 3\n";
  EXPECT_GT(build_ms(three), 2.0 * build_ms(three + "f 2 3 4\n"));
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

StudySpec some_study() {
  StudySpec spec;
  spec.experiment.input = *rc::gen::element<std::string>("ellipsoid", "rook", "teacup");
  spec.sweep.views = *rc::gen::inRange(1, 9);
  spec.sweep.levels = {0, 1, *rc::gen::inRange(2, 6)};
  spec.sweep.voxels = {16, *rc::gen::inRange(17, 300)};
  if (*rc::gen::arbitrary<bool>()) spec.experiment.border.columns = {"rim", "sobel"};
  return spec;
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
