// What export writes is drawn with the border of the model it was written from, within that model's own error.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "raymarch/measured_border.h"
#include "samples/experiment/job.h"
#include "samples/input/input.h"
#include "samples/plan/plan.h"
#include "samples/scenes/scenes.h"
#include "sdf/error.h"
#include "tests/samples/run_program.h"

namespace limn {
namespace {

constexpr double kThreshold = 0.4;

/// One way from a scene to a file.
struct Way {
  std::string input, surface, gradient, format;
  int voxels = 64, level = 2, view = 0;
  bool refines = false;  ///< The input has levels.
  bool is_grid() const { return surface != "mesh"; }

  std::vector<std::string> options() const {
    std::vector<std::string> words{"--surface", surface};
    if (is_grid()) words.insert(words.end(), {"--voxels", std::to_string(voxels)});
    // Polygons have no gradient.
    if (is_grid() && format == ".vdb") words.insert(words.end(), {"--gradient", gradient});
    if (surface != "level_set" && refines) words.insert(words.end(), {"--level", std::to_string(level)});
    return words;
  }
  std::string text() const {
    return fmt::format("{} {} view {} -> {}", std::filesystem::path(input).filename().string(), fmt::join(options(), " "), view, format);
  }
};

/// The same call as a program makes it, up to the model.
SceneModel model_of(const Way& way, SceneInput& input) {
  ExperimentSpec spec;
  spec.input = way.input;
  spec.surfaces = {way.surface};
  spec.surface.gradient = way.gradient;
  if (way.refines && way.surface != "level_set") spec.surface.level = way.level;
  input = load_input(spec);
  // A file holds all objects in one grid, and counts its voxels along all of them.
  if (way.is_grid()) spec.surface.voxel_size = bounds(input.scene).longest_side() / way.voxels;
  return build_model(input.scene, surface_settings(spec, input));
}

SceneModel model_of_file(const std::string& file, const Way& way) {
  ExperimentSpec spec;
  spec.input = file;
  if (way.format == ".vdb") spec.surface.gradient = way.gradient;
  SceneInput input = load_input(spec);
  return build_model(input.scene, surface_settings(spec, input));
}

struct Outcome {
  BorderErrors own;   ///< Of the model, against the true border.
  BorderErrors file;  ///< Of what is drawn from the file, against the model's border.
  double voxel_px = 0.0;
  std::int64_t hits = 0;
};

Outcome follow(const Way& way, const TemporaryFolder& folder) {
  const std::string file = folder.file("way" + way.format);
  std::vector<std::string> call{"export", way.input, "-o", file, "-q"};
  const std::vector<std::string> options = way.options();
  call.insert(call.end(), options.begin(), options.end());
  const RunResult run = run_limn(call);
  if (run.exit_code != 0) throw std::runtime_error(run.err);

  SceneInput input;
  const SceneModel model = model_of(way, input);
  CameraSettings lens = input.scene.camera;
  lens.width_px = 240;
  lens.height_px = 180;
  const Box box = bounds(input.scene);
  PlanView truth, drawn;
  truth.camera = drawn.camera = camera_of_view(lens, {box, {}}, {}, way.view, 6);
  truth.truth = solve_truth(input.scene, truth.camera, {.threshold = kThreshold}, {});
  MeasuredBorderSettings measuring;
  measuring.threshold = kThreshold;
  drawn.truth.curves = measure_border(model, drawn.camera, render_gbuffer(model, drawn.camera, {}), measuring, {});

  Outcome outcome;
  double ignored = 0.0;
  outcome.own = measure_errors(model, truth, kThreshold, {}, ignored);
  const SceneModel again = model_of_file(file, way);
  // A file of several objects holds them as one.
  if (again.surfaces.size() == 1)
    for (BorderCurve& curve : drawn.truth.curves.curves) curve.object = 1;
  outcome.file = measure_errors(again, drawn, kThreshold, {}, ignored);
  const GBuffer seen = render_gbuffer(again, drawn.camera, {});
  for (const std::uint8_t status : seen.status.pixels) outcome.hits += status == 1 ? 1 : 0;
  const double depth = glm::distance(drawn.camera.eye, box.center());
  outcome.voxel_px = way.is_grid() ? pixels_per_unit_at(drawn.camera, depth) * box.longest_side() / way.voxels : 0.0;
  return outcome;
}

/// Each lies off the true border by the model's own error at most, so they lie off each other by twice that; a grid's polygons (dual
/// contouring) cut corners by a quarter of a voxel beside.
double bound_px(double own_px, const Way& way, double voxel_px) {
  const bool polygons_of_grid = way.is_grid() && way.format != ".vdb";
  return 2.2 * own_px + 0.05 + (polygons_of_grid ? 0.25 * voxel_px : 0.0);
}

/// Empty where all is well.
std::string fault(const Way& way, const Outcome& outcome) {
  if (outcome.hits == 0) return "nothing is drawn";
  const double silhouette = bound_px(outcome.own.silhouette_px, way, outcome.voxel_px);
  if (std::isfinite(silhouette) && !(outcome.file.silhouette_px <= silhouette))
    return fmt::format("silhouette off by {:.3g} px, bound {:.3g}", outcome.file.silhouette_px, silhouette);
  // Polygons have normals of their own.
  if (way.is_grid() && way.format != ".vdb") return {};
  const double inner = bound_px(outcome.own.inner_px, way, outcome.voxel_px);
  if (std::isfinite(inner) && !(outcome.file.inner_px <= inner))
    return fmt::format("inner border off by {:.3g} px, bound {:.3g}", outcome.file.inner_px, inner);
  return {};
}

/// The built-in scenes, a mesh and a volume.
struct Inputs {
  std::vector<std::string> names = scenes().names();
  explicit Inputs(const TemporaryFolder& folder) {
    names.push_back(folder.file("egg.obj"));
    names.push_back(folder.file("cup.vdb"));
    EXPECT_EQ(run_limn({"export", "ellipsoid", "--surface", "mesh", "--level", "3", "-q", "-o", folder.file("egg.obj")}).exit_code, 0);
    EXPECT_EQ(
        run_limn({"export", "tilted_torus", "--surface", "level_set", "--voxels", "120", "-q", "-o", folder.file("cup.vdb")}).exit_code, 0);
  }
};

template <class T>
const T& one_of(const std::vector<T>& all, std::mt19937_64& random) {
  return all[std::uniform_int_distribution<size_t>(0, all.size() - 1)(random)];
}

Way draw(const Inputs& inputs, std::mt19937_64& random) {
  Way way;
  way.input = one_of(inputs.names, random);
  ExperimentSpec spec;
  spec.input = way.input;
  const SceneInput input = load_input(spec);
  std::vector<std::string> surfaces;
  for (const SurfaceDescriptor& kind : surface_kinds())
    if (kind.about.name != "analytic" && kind.unsupported(input.scene.objects.front()).empty()) surfaces.push_back(kind.about.name);
  way.surface = one_of(surfaces, random);
  way.gradient = one_of(std::vector<std::string>{"cell", "central", "cubic"}, random);
  const bool grid = way.is_grid();
  way.format = one_of(grid ? std::vector<std::string>{".vdb", ".vdb", ".obj", ".ply"} : std::vector<std::string>{".obj", ".ply"}, random);
  // Few at the top: a grid's cost grows with the square.
  const double u = std::uniform_real_distribution(0.0, 1.0)(random);
  way.voxels = static_cast<int>(std::lround(16.0 * std::pow(32.0, std::pow(u, 1.7))));
  way.level = std::uniform_int_distribution(1, 3)(random);
  way.view = std::uniform_int_distribution(0, 5)(random);
  const auto* mesh = std::get_if<MeshSource>(&input.scene.objects.front().source);
  way.refines = std::holds_alternative<Field>(input.scene.objects.front().source) || (mesh != nullptr && mesh->scheme);
  return way;
}

int number_in(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::atoi(text);
}

// The same draws each time; LIMN_EXPORT_DRAWS=200 LIMN_EXPORT_SEED=7 looks at more and at others.
TEST(ExportedBorders, AreTheModelsWithinItsOwnError) {
  const TemporaryFolder folder;
  const Inputs inputs(folder);
  const int draws = number_in("LIMN_EXPORT_DRAWS", 10);
  const auto seed = static_cast<std::uint64_t>(number_in("LIMN_EXPORT_SEED", 1));
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  std::mt19937_64 random(seed);
  int bounded = 0;
  double worst = 0.0;
  std::string worst_way;
  for (int k = 0; k < draws; ++k) {
    const Way way = draw(inputs, random);
    Outcome outcome;
    try {
      outcome = follow(way, folder);
    } catch (const std::exception& error) {
      ADD_FAILURE() << way.text() << ": " << error.what();
      continue;
    }
    const std::string wrong = fault(way, outcome);
    EXPECT_EQ(wrong, "") << way.text();
    const double bound = bound_px(outcome.own.silhouette_px, way, outcome.voxel_px);
    if (draws > 50)
      std::printf("%s: own %.3g %.3g, file %.3g %.3g px%s\n", way.text().c_str(), outcome.own.silhouette_px, outcome.own.inner_px,
                  outcome.file.silhouette_px, outcome.file.inner_px, wrong.empty() ? "" : " WRONG");
    if (!std::isfinite(bound)) continue;
    ++bounded;
    if (outcome.file.silhouette_px / bound > worst) {
      worst = outcome.file.silhouette_px / bound;
      worst_way = way.text();
    }
  }
  std::printf("%d of %d with a bound; worst silhouette %.2f of it: %s\n", bounded, draws, worst, worst_way.c_str());
  EXPECT_GE(bounded, draws / 3);
}

}  // namespace
}  // namespace limn
