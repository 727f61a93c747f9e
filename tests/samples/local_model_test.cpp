// Local models: no crack, no more triangles than promised, and the border where it belongs, asked by rays on both sides of the true one.

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <random>

#include "raymarch/local_model.h"
#include "raymarch/mesh/polygons.h"
#include "raymarch/surface/object_mesh.h"
#include "samples/experiment/job.h"
#include "samples/scenes/scenes.h"
#include "subdiv/import.h"
#include "tests/local_check.h"
#include "tests/plan_check.h"
#include "tests/random_seed.h"
#include "tests/raymarch/awkward_cages.h"
#include "tests/samples/run_program.h"
#include "tests/samples/scene_camera.h"
#include "tests/temporary_folder.h"

namespace limn {
using namespace test;
namespace {

/// Edges that have not exactly one face on each side.
size_t open_edges(const Mesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> passed;
  size_t first = 0;
  for (const std::int32_t size : mesh.face_sizes) {
    const auto n = static_cast<size_t>(size);
    for (size_t k = 0; k < n; ++k) ++passed[{mesh.corner_vertices[first + k], mesh.corner_vertices[first + (k + 1) % n]}];
    first += n;
  }
  size_t open = 0;
  for (const auto& [edge, count] : passed) {
    const auto back = passed.find({edge.second, edge.first});
    open += count != 1 || back == passed.end() || back->second != 1;
  }
  return open;
}

PlanView square_view(const Scene& scene, int side_px) {
  PlanView view;
  view.camera = camera_of(scene, 0, 1, {side_px, side_px});
  view.truth = solve_truth(scene, view.camera, {}, {});
  return view;
}

PlanSettings local_plan(const std::string& kind, double tolerance_px) {
  PlanSettings settings;
  settings.tolerance_px = tolerance_px;
  settings.kinds = {kind};
  settings.local = true;
  return settings;
}

TEST(LocalModel, AnEllipsoidsSilhouetteTakesFewTrianglesAndKeepsToTheTolerance) {
  const Scene scene = find_scene("ellipsoid")->make();
  const SceneModel exact = build_model(scene, {.kind = "analytic"});
  const PlanView view = square_view(scene, 300);
  const std::pair<double, std::int64_t> most[] = {{1.0, 900}, {0.25, 2000}, {0.1, 3400}};
  for (const auto& [tolerance_px, triangles] : most) {
    const SceneModel model = build_local_model(scene, {}, {{view.camera}, tolerance_px, {}});
    EXPECT_LE(total(model).triangles, triangles) << tolerance_px << " px";
    EXPECT_EQ(share_beyond(model, exact, view, 0.4, tolerance_px, PlanMetric::silhouette), 0.0) << tolerance_px << " px";
    EXPECT_EQ(share_of_false_border(model, view, 0.4, tolerance_px, PlanMetric::silhouette), 0.0) << tolerance_px << " px";
  }
}

TEST(LocalModel, OfFieldsAndCagesTheBorderKeepsToTheToleranceWithNoEdgeOpen) {
  for (const char* name : {"ellipsoid", "tilted_torus", "superellipsoid", "teacup", "rook"}) {
    const Scene scene = find_scene(name)->make();
    const PlanView view = square_view(scene, 300);
    Scene fine = scene;
    for (SceneObject& object : fine.objects) object.level.reset();
    const bool field = std::holds_alternative<Field>(scene.objects.front().source);
    const SceneModel reference = build_model(fine, {.kind = field ? "analytic" : "mesh", .level = 6});
    for (const double tolerance_px : {1.0, 0.25}) {
      const SceneModel model = build_local_model(scene, {}, {{view.camera}, tolerance_px, {0.4}});
      for (const Surface& surface : model.surfaces) EXPECT_EQ(open_edges(surface.polygons->mesh()), 0u) << name;
      double trace_ms = 0.0;
      EXPECT_LE(measure_errors(model, view, 0.4, {}, trace_ms).border_px, tolerance_px) << name;
      EXPECT_LE(share_beyond(model, reference, view, 0.4, tolerance_px, PlanMetric::border), 0.01) << name << " " << tolerance_px;
      EXPECT_LE(share_of_false_border(model, view, 0.4, tolerance_px, PlanMetric::border), 0.01) << name << " " << tolerance_px;
    }
  }
}

// Where the block's round is cut at a flat angle the wedge is so sharp that the coarse mesh cuts it off.
TEST(LocalModel, EdgesThatGoAcrossACreaseAreSplitThereHoweverSharpItIs) {
  const Scene scene = find_scene("gyroid")->make();
  PlanView view;
  view.camera = camera_of(scene, 0, 4, {300, 300});
  view.truth = solve_truth(scene, view.camera, {}, {});
  const SceneModel model = build_local_model(scene, {}, {{view.camera}, 0.25, {0.4}});
  EXPECT_EQ(open_edges(model.surfaces.front().polygons->mesh()), 0u);
  double trace_ms = 0.0;
  EXPECT_LE(measure_errors(model, view, 0.4, {}, trace_ms).border_px, 0.125);
  EXPECT_LE(share_beyond(model, build_model(scene, {.kind = "analytic"}), view, 0.4, 0.25, PlanMetric::border), 0.01);
  EXPECT_LE(share_of_false_border(model, view, 0.4, 0.25, PlanMetric::border), 0.01);
}

TEST(LocalModel, OfAnyEllipsoidVerticesLieOnTheSurfaceAndNoPartIsFartherOffThanStated) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> radius(0.4, 1.5), weight(0.0, 1.0);
  for (int draw = 0; draw < 4; ++draw) {
    const Field field = make_shape("ellipsoid", {{"radii", {radius(random), radius(random), radius(random)}}});
    Scene scene;
    scene.objects.push_back({.name = "ellipsoid", .source = field});
    const Camera camera = camera_of(scene, draw, 4, {400, 300});
    const SceneModel model = build_local_model(scene, {}, {{camera}, 0.25, {0.4}});
    const Mesh& mesh = model.surfaces.front().polygons->mesh();
    FieldEvaluator evaluator(field);
    const auto off = [&](const glm::dvec3& p) {
      const FieldJet jet = evaluator.jet(p);
      return std::abs(jet.value) / glm::length(jet.gradient);
    };
    double worst_vertex = 0.0, worst_px = 0.0;
    for (const glm::dvec3& p : mesh.positions) worst_vertex = std::max(worst_vertex, off(p + model.render_origin));
    for (size_t f = 0; f < mesh.face_count(); ++f) {
      const double u = weight(random), v = weight(random) * (1.0 - u);
      const auto at = [&](size_t k) { return mesh.positions[static_cast<size_t>(mesh.corner_vertices[3 * f + k])] + model.render_origin; };
      const glm::dvec3 p = at(0) + u * (at(1) - at(0)) + v * (at(2) - at(0));
      worst_px = std::max(worst_px, off(p) * pixels_per_unit_at(camera, project(camera, p).z));
    }
    EXPECT_LT(worst_vertex, 1e-9);
    EXPECT_LT(worst_px, kLocalCoarse_px);
  }
}

std::vector<glm::dvec2> middles_of_pixels(int side_px) {
  std::vector<glm::dvec2> points;
  for (int k = 0; k < side_px * side_px; ++k) points.emplace_back(k % side_px + 0.5, k / side_px + 0.5);
  return points;
}

/// The camera of a call for 300x300 pixels that names none.
Camera camera_of_call(const std::string& name, const Scene& scene) {
  const TemporaryFolder folder;
  const nlohmann::json seen =
      run_limn({"render", name, "--size", "300x300", "--json", "-o", folder.file("picture.png")}).json()["cameras"][0];
  const auto vector = [&](const char* key) {
    return glm::dvec3(seen[key][0].get<double>(), seen[key][1].get<double>(), seen[key][2].get<double>());
  };
  CameraSettings asked = scene.camera;
  asked.width_px = asked.height_px = 300;
  asked.eye = vector("eye"), asked.target = vector("target"), asked.up = vector("up");
  return resolve_camera(asked, bounds(scene));
}

TEST(LocalModel, AnExportedCageIsWatertightAndReadsBackWithTheSameBorder) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "exported.obj";
  for (const char* name : {"teacup", "rook", "pipe_junction", "bracket"}) {
    const RunResult run = run_limn({"export", name, "--local", "0.25", "--size", "300x300", "-o", file.string()});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const Mesh mesh = load_mesh(file);
    EXPECT_EQ(open_edges(mesh), 0u) << name;
    const Scene scene = find_scene(name)->make();
    PlanView view;
    view.camera = camera_of_call(name, scene);
    view.truth = solve_truth(scene, view.camera, {}, {});
    const SceneModel made = build_local_model(scene, {}, {{view.camera}, 0.25, {0.4}});
    EXPECT_EQ(total(made).triangles, static_cast<std::int64_t>(mesh.face_count())) << name;
    Scene read;
    read.objects.push_back({.name = "read", .source = MeshSource{mesh}});
    const SceneModel again = build_model(read, {.kind = "mesh"});
    // Its border keeps to the tolerance in the picture that it was made for, and every pixel shows what was exported. Of several objects
    // one mesh is read: borders where one object ends at another are not looked for within it.
    double trace_ms = 0.0;
    if (scene.objects.size() == 1) {
      EXPECT_LE(measure_errors(again, view, 0.4, {}, trace_ms).border_px, 0.25) << name;
    }
    const std::vector<glm::dvec2> points = middles_of_pixels(300);
    const std::vector<PointSample> ours = seen_at(made, view.camera, points), theirs = seen_at(again, view.camera, points);
    int hits = 0, differ = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      const bool hit = ours[i].status == HitStatus::hit;
      hits += hit;
      differ += ours[i].status != theirs[i].status || (hit && glm::distance(ours[i].normal, theirs[i].normal) > 1e-4f);
    }
    EXPECT_GT(hits, 10'000) << name;
    // Placed about another origin, a ray may pass an edge of a facet on the other side.
    EXPECT_LE(differ, 3) << name;
  }
}

TEST(LocalModel, ACageHoweverTwistedHasAClosedLocalMesh) {
  // Corners that wander by half an edge and more: limit surfaces that turn within themselves and pass through themselves.
  const std::uint32_t seed = random_seed();
  for (unsigned draw = 0; draw < 16; ++draw) {
    Mesh cage = draw % 2 == 0 ? cube_cage(seed + draw) : block_cage({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}});
    cage = shaken(std::move(cage), draw % 4 < 2 ? 0.5 : 1.5, seed + draw);
    Scene scene;
    scene.objects.push_back({.name = "cage", .source = MeshSource{cage, Scheme::catmark}});
    for (const double tolerance_px : {8.0, 0.5}) {
      const SceneModel model = build_local_model(scene, {}, {{camera_of(scene, 0, 1, {200, 200})}, tolerance_px, {0.4}});
      EXPECT_EQ(open_edges(model.surfaces.front().polygons->mesh()), 0u) << draw;
      EXPECT_LT(total(model).triangles, 30'000) << draw << ", " << tolerance_px << " px";
    }
  }
}

/// Every pixel of 8 views and 20,000 random rays.
LocalRays rays_at(const Scene& scene, const SceneModel& local, const SceneModel& fine, const Camera& made_for, std::mt19937& random) {
  const ComparedModel of_local(local), of_fine(fine);
  const double bound = bound_of(scene, made_for);
  LocalRays count;
  for (int view = 0; view < 8; ++view) {
    const Camera camera = camera_of(scene, view, 8, {150, 150});
    std::uniform_real_distribution<double> at(0.0, 150.0);
    std::vector<glm::dvec2> points;
    for (int k = 0; k < 2500; ++k) points.emplace_back(at(random), at(random));
    for (int y = 0; y < 150; ++y)
      for (int x = 0; x < 150; ++x) points.emplace_back(x + 0.5, y + 0.5);
    cast_at_both(of_local, of_fine, camera, points, bound, around_of(scene, camera, bound), count);
  }
  return count;
}

TEST(LocalModel, WhatModelsStartFromIsKeptAndChangesNoTriangle) {
  for (const char* name : {"superellipsoid", "tilted_torus"}) {
    const Scene scene = find_scene(name)->make();
    const Camera camera = camera_of(scene, 0, 4, {150, 150});
    const LocalSettings coarse{{camera}, 2.0, {0.4}}, fine{{camera}, 0.25, {0.4}};
    const auto mesh_of = [](const SceneModel& model) { return model.surfaces.front().polygons->mesh(); };
    ObjectMeshCache cache;
    build_local_model(scene, {}, coarse, &cache);
    ASSERT_EQ(cache.starts.size(), scene.objects.size()) << name;
    const KeptStart kept = *cache.starts.front();
    ASSERT_NE(kept.local, nullptr) << name;
    const SceneModel again = build_local_model(scene, {}, fine, &cache), alone = build_local_model(scene, {}, fine);
    EXPECT_EQ(cache.starts.front()->local, kept.local) << name << ": made twice";
    EXPECT_EQ(mesh_of(again).positions, mesh_of(alone).positions) << name;
    EXPECT_EQ(mesh_of(again).corner_vertices, mesh_of(alone).corner_vertices) << name;
    EXPECT_EQ(mesh_of(again).corner_normals, mesh_of(alone).corner_normals) << name;
    // What was spared counts as its building time all the same.
    EXPECT_GE(again.surfaces.front().info.build_ms, kept.local_ms) << name;
    // Meshes as fine everywhere start from the same cage.
    const SurfaceSettings uniform{.kind = "mesh", .level = 2};
    const SceneModel shared = build_model(scene, uniform, &cache);
    EXPECT_EQ(cache.starts.front()->cage, kept.cage) << name << ": found twice";
    EXPECT_EQ(mesh_of(shared).positions, mesh_of(build_model(scene, uniform)).positions) << name;
  }
}

TEST(LocalModel, NoRayPassesThroughIt) {
  std::mt19937 random(random_seed());
  for (const char* name : {"ellipsoid", "tilted_torus", "superellipsoid"}) {
    const Scene scene = find_scene(name)->make();
    const SceneModel fine = build_model(scene, {.kind = "mesh", .level = 5, .normals = NormalKind::limit});
    const Camera camera = camera_of(scene, 0, 4, {150, 150});
    const SceneModel local = build_local_model(scene, {}, {{camera}, 0.25, {0.4}});
    const LocalRays count = rays_at(scene, local, fine, camera, random);
    EXPECT_GT(count.hits, 10000) << name;
    EXPECT_EQ(count.through, 0) << name;
    EXPECT_EQ(count.backs, 0) << name;
  }
}

TEST(LocalModel, NoRayMeetsABack) {
  // Beside tight bends the chords of coarse triangles reach past each other.
  for (const char* name : {"rook", "pipe_junction", "bracket"}) {
    const Scene scene = find_scene(name)->make();
    const SceneModel local = build_local_model(scene, {}, {{camera_of(scene, 0, 4, {300, 300})}, 0.25, {0.4}});
    const ComparedModel of_local(local);
    const std::vector<glm::dvec2> points = middles_of_pixels(300);
    int hits = 0, backs = 0;
    for (int view = 0; view < 18; ++view) {
      const Camera camera = camera_of(scene, view, 18, {300, 300});
      for (const PointSample& sample : seen_at(local, camera, points)) {
        if (sample.status != HitStatus::hit) continue;
        ++hits;
        backs += of_local.shows_back(sample, camera) ? 1 : 0;
      }
    }
    EXPECT_GT(hits, 100'000) << name;
    EXPECT_EQ(backs, 0) << name;
  }
}

TEST(LocalModel, WhereAFaceIsMissingRaysPassThrough) {
  std::mt19937 random(random_seed());
  const Scene scene = find_scene("ellipsoid")->make();
  const SceneModel fine = build_model(scene, {.kind = "mesh", .level = 5, .normals = NormalKind::limit});
  const Camera camera = camera_of(scene, 0, 4, {150, 150});
  Mesh holed = build_local_model(scene, {}, {{camera}, 0.25, {0.4}}).surfaces.front().polygons->mesh();
  holed.corner_vertices.resize(holed.corner_vertices.size() - 3 * holed.face_count() / 50 / 3 * 3);
  holed.face_sizes.resize(holed.corner_vertices.size() / 3);
  holed.corner_normals.clear();
  Scene with_holes;
  with_holes.objects.push_back({.name = "holes", .source = MeshSource{holed}});
  const LocalRays count = rays_at(scene, build_model(with_holes, {.kind = "mesh"}), fine, camera, random);
  EXPECT_GT(count.through, 0);
  EXPECT_GT(count.backs, 0);
}

TEST(LocalModel, AlongAPathItFlickersNoMoreThanTheUniformMeshOfTheTolerance) {
  const TemporaryFolder folder;
  const auto beyond = [&](const char* scene, const std::vector<std::string>& model) {
    std::vector<std::string> call = {"render", scene};
    call.insert(call.end(), model.begin(), model.end());
    for (const char* text : {"--size", "300x300", "--frames", "24", "--path-step", "0.2", "--json", "-q", "-o"}) call.emplace_back(text);
    call.push_back(folder.file("film.png"));
    const RunResult run = run_limn(call);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.exit_code == 0 ? run.json().at("flicker").at("beyond").get<int>() : -1;
  };
  // The levels are those of plans for 0.25 pixels.
  for (const auto& [scene, level] : {std::pair("ellipsoid", "2"), std::pair("tilted_torus", "3")}) {
    const int uniform = beyond(scene, {"--surface", "mesh", "--level", level}), local = beyond(scene, {"--local", "0.25"});
    EXPECT_GT(uniform, 0) << scene;
    EXPECT_GE(local, 0) << scene;
    EXPECT_LE(local, uniform) << scene;
  }
}

TEST(LocalModel, AStudySweepsLocalMeshesAsASeriesOfTheirOwn) {
  const TemporaryFolder folder;
  const auto study = folder.path() / "study";
  const RunResult run = run_limn({"study", "ellipsoid", "--surfaces", "mesh", "--levels", "1", "--normals", "limit", "--local", "2,0.25",
                                  "--views", "1", "--size", "200x200", "-o", study.string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::map<std::string, double> error_px, bytes;
  std::ifstream rows(study / "rows.jsonl");
  for (std::string line; std::getline(rows, line);) {
    const nlohmann::json row = nlohmann::json::parse(line);
    if (row.value("metric", "") != "border_error_p95") continue;
    const std::string local = row["surface_parameters"].value("local", "");
    EXPECT_EQ(row["surface"], local.empty() ? "mesh" : "local_mesh");
    error_px[local] = row["value"];
    bytes[local] = row["bytes"];
  }
  ASSERT_EQ(error_px.size(), 3u);
  EXPECT_LE(error_px["2"], 2.0);
  EXPECT_LE(error_px["0.25"], 0.25);
  EXPECT_LT(bytes["2"], bytes["0.25"]);
  EXPECT_NE(run_limn({"study", "ellipsoid", "--local", "0"}).err.find("--local"), std::string::npos);
}

TEST(LocalModel, AStudySweepsLocalLevelSetsBesideUniformOnes) {
  const TemporaryFolder folder;
  const auto study = folder.path() / "study";
  const RunResult run = run_limn({"study", "ellipsoid", "--surfaces", "level_set,mesh_level_set", "--levels", "2", "--voxels", "64",
                                  "--gradients", "central", "--local", "0.5", "--views", "1", "--size", "150x150", "-o", study.string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::map<std::string, double> error_px;
  std::ifstream rows(study / "rows.jsonl");
  for (std::string line; std::getline(rows, line);) {
    const nlohmann::json row = nlohmann::json::parse(line);
    if (row.value("metric", "") != "border_error_p95") continue;
    error_px[row["surface"]] = row["value"];
    const bool local = row["surface"].get<std::string>().starts_with("local_");
    EXPECT_EQ(row["surface_parameters"].value("local", ""), local ? "0.5" : "") << row["surface"];
    if (local && row["surface"] != "local_mesh") {
      EXPECT_EQ(row["surface_parameters"].value("voxels", ""), "256");
    }
  }
  for (const char* surface : {"level_set", "mesh_level_set", "local_mesh", "local_level_set", "local_mesh_level_set"})
    EXPECT_TRUE(error_px.contains(surface)) << surface;
  EXPECT_LE(error_px["local_level_set"], 0.5);
  EXPECT_LT(error_px["local_level_set"], error_px["level_set"]);
}

TEST(LocalModel, WhatHasNoEffectIsRefused) {
  const auto error_of = [](const std::vector<std::string>& arguments) {
    const RunResult run = run_limn(arguments);
    EXPECT_EQ(run.exit_code, 2);
    return run.err;
  };
  EXPECT_NE(error_of({"render", "ellipsoid", "--local"}).find("a number of pixels"), std::string::npos);
  EXPECT_NE(error_of({"render", "ellipsoid", "--local", "0"}).find("a number of pixels above 0"), std::string::npos);
  EXPECT_NE(error_of({"render", "ellipsoid", "--local", "1", "--level", "3"}).find("--level"), std::string::npos);
  EXPECT_NE(error_of({"render", "teacup", "--local", "1", "--surface", "level_set"}).find("--surface mesh"), std::string::npos);
  EXPECT_NE(error_of({"render", "ellipsoid", "--local", "1", "--tolerance", "1"}).find("--local"), std::string::npos);
  EXPECT_NE(error_of({"export", "ellipsoid", "--size", "300x300"}).find("--local"), std::string::npos);
}

TEST(LocalModel, APlanTriesLocalMeshesAndSaysWhatTheOneChosenSaves) {
  const Scene scene = find_scene("ellipsoid")->make();
  const PlanView view = square_view(scene, 300);
  const PlanSettings settings = local_plan("mesh", 0.1);
  ProgressBar bar(false);
  const PlanAnswer answer = make_plan(scene, {view}, settings, {}, bar);
  const auto is_local = [&](const PlanTrial& trial) { return answer.all_series[trial.series].local.has_value(); };
  EXPECT_TRUE(std::any_of(answer.trials.begin(), answer.trials.end(), is_local));
  ASSERT_TRUE(answer.chosen);
  // Which of the two is faster is for the machine to say; what is said of a local one must be so.
  if (!is_local(answer.trials[*answer.chosen])) return;
  const PlanTrial& chosen = answer.trials[*answer.chosen];
  EXPECT_LE(chosen.measured.border_px, 0.1);
  EXPECT_GT(answer.curvature_triangles, 2 * chosen.triangles);
  if (answer.uniform) {
    EXPECT_GT(answer.trials[*answer.uniform].triangles, 5 * chosen.triangles);
  }
}

/// Within 16 MB no level set that is as fine everywhere has its border right.
TEST(LocalModel, APlanTriesLocalLevelSetsAndTakesOneWhereMemoryIsShort) {
  const Scene scene = find_scene("machined_part")->make();
  const PlanView view = square_view(scene, 300);
  PlanSettings settings = local_plan("level_set", 0.25);
  settings.budget_bytes = std::int64_t{16} << 20;
  ProgressBar bar(false);
  const PlanAnswer answer = make_plan(scene, {view}, settings, {}, bar);
  ASSERT_TRUE(answer.chosen);
  const PlanTrial& chosen = answer.trials[*answer.chosen];
  const ResolutionSeries& series = answer.all_series[chosen.series];
  ASSERT_TRUE(series.local);
  EXPECT_EQ(series.settings.kind, "level_set");
  EXPECT_EQ(series.local_at(chosen.candidate)->cameras.size(), 1u);
  EXPECT_GT(chosen.voxels, 0);
  EXPECT_LE(chosen.bytes, *settings.budget_bytes);
  EXPECT_LE(chosen.measured.border_px, settings.tolerance_px);
  EXPECT_GT(answer.curvature_bytes, 0);
  // What it saves is said against one of as many voxels, which is measured, too.
  EXPECT_GT(answer.uniform_bytes, *settings.budget_bytes);
  ASSERT_TRUE(answer.uniform);
  EXPECT_EQ(answer.all_series[answer.trials[*answer.uniform].series].words_at(answer.trials[*answer.uniform].candidate),
            series.words_at(chosen.candidate));
  EXPECT_LE(answer.trials[*answer.uniform].measured.border_px, settings.tolerance_px);
  const std::vector<std::string> said = plan_sentences(answer, settings);
  const auto saves = [](const std::string& sentence) {
    return sentence.find("a level set that is as fine everywhere") != std::string::npos;
  };
  EXPECT_TRUE(std::any_of(said.begin(), said.end(), saves)) << said[0];
  // The same model, built again by itself, has the same border.
  const SceneModel again = build_local_model(scene, series.at(chosen.candidate), *series.local_at(chosen.candidate));
  double trace_ms = 0.0;
  EXPECT_EQ(measure_errors(again, view, settings.threshold, {}, trace_ms).border_px, chosen.measured.border_px);
}

TEST(LocalModel, APlanTriesLocalLevelSetsOfMeshes) {
  Scene scene;
  scene.objects.push_back({.name = "cube", .source = MeshSource{cube_cage(3), Scheme::catmark}});
  const PlanView view = square_view(scene, 160);
  PlanSettings settings = local_plan("mesh_level_set", 0.5);
  ProgressBar bar(false);
  // Half of what the best uniform one keeps. With local ones beside it the machine would say which of the two is faster.
  settings.local = false;
  const PlanAnswer uniform = make_plan(scene, {view}, settings, {}, bar);
  ASSERT_TRUE(uniform.chosen);
  settings.budget_bytes = uniform.trials[*uniform.chosen].bytes / 2;
  settings.local = true;
  const PlanAnswer answer = make_plan(scene, {view}, settings, {}, bar);
  ASSERT_TRUE(answer.chosen);
  const PlanTrial& chosen = answer.trials[*answer.chosen];
  EXPECT_TRUE(answer.all_series[chosen.series].local);
  EXPECT_EQ(answer.all_series[chosen.series].settings.kind, "mesh_level_set");
  EXPECT_LE(chosen.bytes, *settings.budget_bytes);
  EXPECT_LE(chosen.measured.border_px, settings.tolerance_px);
  // A budget is of what is kept: that the mesh takes more is nothing that the plan would have to note.
  for (const std::string& note : answer.notes) EXPECT_EQ(note.find("the refined mesh has"), std::string::npos) << note;
}

TEST(LocalModel, RenderTakesTheLocalLevelSetThatItsPlanChose) {
  const TemporaryFolder folder;
  const RunResult run = run_limn({"render", "ellipsoid", "--surface", "level_set", "--tolerance", "0.05", "--local", "--budget", "2M",
                                  "--size", "300x300", "-o", "egg.png", "--json"},
                                 folder.path());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_NE(run.err.find("local level set"), std::string::npos) << run.err;
  EXPECT_GT(json.at("surface").at("voxels").get<int>(), 0);
  EXPECT_LE(json.at("surface").at("bytes").get<int>(), 2'000'000);
}

}  // namespace
}  // namespace limn
