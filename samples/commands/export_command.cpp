#include <fmt/format.h>

#include <algorithm>

#include "samples/commands/command.h"
#include "samples/commands/common.h"
#include "samples/experiment/job.h"
#include "samples/experiment/local_request.h"
#include "samples/experiment/no_effect.h"
#include "samples/experiment/thread_settings.h"
#include "samples/input/input_files.h"
#include "samples/input/scene_facts.h"
#include "samples/input/world_model.h"
#include "samples/output/output.h"
#include "sdf/error.h"
#include "sdf/level_set_grids.h"
#include "subdiv/import.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kEndings = {".obj", ".ply", ".vdb"};

fs::path output_of(const Options& options, const std::string& name, InputKind kind) {
  if (!options.outputs.empty()) return options.outputs.back();
  return default_output("export", name).string() + (kind == InputKind::level_set ? ".vdb" : ".obj");
}

void add_options(CLI::App& app, Options& options) {
  add_input(app, options);
  add_surface(app, options, {.surface = true, .repeatable = false});
  add_refined(app, options);
  add_local(app, options, true);
  add_camera(app, options, true);
  add_output(app, options, ".obj .ply (refined mesh) or .vdb (level set); default limn-out/export/<name>.obj, .vdb for a volume", false);
  add_json(app, options);
  add_execution(app, options);
}

// --surface says by which way: mesh or level_set straight, mesh_level_set through both.
void check_kind(const SurfaceSettings& settings, const fs::path& file) {
  if (settings.kind == "analytic")
    throw InputError({"", "--surface", settings.kind, "a formula cannot be written to a file", "mesh, level_set or mesh_level_set"});
  if (settings.kind == "mesh" && ending_of(file) == ".vdb")
    throw InputError({"", "--surface", settings.kind, "a mesh cannot be written to a .vdb", "level_set or mesh_level_set, or -o FILE.obj"});
}

// The way to the file: through a mesh, a level set, or both.
SettingUse use_of(const Scene& scene, const SurfaceSettings& settings, bool to_level_set) {
  SettingUse use{.kinds = {settings.kind}, .level_set_file = to_level_set, .mesh_file = !to_level_set};
  const bool any_mesh = std::any_of(scene.objects.begin(), scene.objects.end(),
                                    [](const SceneObject& object) { return std::holds_alternative<MeshSource>(object.source); });
  if (to_level_set && any_mesh) use.kinds = {"mesh_level_set"};
  return use;
}

// Refined positions are there where cages are written as meshes.
void check_refined(const Scene& scene, const SurfaceSettings& settings, const fs::path& file) {
  const char* const expected = "a subdivision cage (--level N or --scheme NAME), written as .obj or .ply";
  if (ending_of(file) == ".vdb") throw InputError({"", "--refined", file.string(), "a level set has no refined positions", expected});
  if (settings.kind == "level_set" || settings.kind == "mesh_level_set")
    throw InputError({"", "--refined", "--surface " + settings.kind, "a level set has no refined positions", expected});
  for (const SceneObject& object : scene.objects) {
    const auto* mesh = std::get_if<MeshSource>(&object.source);
    if (mesh == nullptr || (!mesh->scheme && !settings.scheme))
      throw InputError({"", "--refined", object.name, "is no subdivision cage", expected});
  }
}

/// What a local model is written as: of shapes a .vdb has level sets, of meshes those made of them.
std::string local_kind_of(const Scene& scene, const SurfaceSettings& settings, bool is_volume) {
  if (!is_volume) return settings.kind.empty() ? "mesh" : settings.kind;
  if (!settings.kind.empty()) return settings.kind;
  const bool any_mesh = std::any_of(scene.objects.begin(), scene.objects.end(),
                                    [](const SceneObject& object) { return std::holds_alternative<MeshSource>(object.source); });
  return any_mesh ? "mesh_level_set" : "level_set";
}

/// A local mesh is made for pictures; nothing else that is written depends on a camera.
std::optional<LocalSettings> local_of(const Options& options, const SceneInput& input, const SurfaceSettings& settings,
                                      const fs::path& file) {
  const CameraSpec& camera = options.spec.camera;
  if (!options.local.asked) {
    if (camera.is_set() || camera.size_px || options.spec.views > 1)
      throw InputError({"", "local", "", "missing: a camera has no effect on a surface that is as fine everywhere", "--local PX"});
    return {};
  }
  if (!options.local.tolerance_px) throw InputError({"", "local", "", "needs a tolerance", "a number of pixels, such as --local 0.25"});
  if (options.refined) throw InputError({"", "local", "", "has no effect on refined positions; leave out one of them", ""});
  const std::string kind = local_kind_of(input.scene, settings, ending_of(file) == ".vdb");
  refuse_local_without_effect(options.spec, input.scene, settings, {kind});
  if (has_local_bricks(kind) && ending_of(file) != ".vdb")
    throw InputError({"", "local", "", "a local level set is no mesh", "a .vdb file, one grid a voxel size; or surface = mesh"});
  refuse_eye_of_views(camera, options.spec.views);
  const FramedSurface framed = framed_input(camera, input);
  std::vector<Camera> cameras;
  cameras.reserve(static_cast<size_t>(options.spec.views));
  for (int view = 0; view < options.spec.views; ++view)
    cameras.push_back(camera_of_view(camera_settings(camera, input), framed, framing_settings(camera), view, options.spec.views));
  return local_settings(*options.local.tolerance_px, options.plan.silhouette, {}, std::move(cameras));
}

Mesh exported_mesh(const Scene& scene, const SurfaceSettings& settings, bool refined, WorldNotes& said) {
  const bool resampled = settings.kind.empty() && settings.resample_volumes && all_are<LevelSetSource>(scene);
  if (settings.kind != "level_set" && settings.kind != "mesh_level_set" && !resampled)
    return world_mesh(scene, settings, refined, &said.warnings);
  const std::vector<LevelSet> level_sets = world_level_sets(scene, settings, said);
  SurfaceSettings as_made = settings;
  as_made.resample_volumes = false;
  Scene remeshed{.name = scene.name};
  for (size_t i = 0; i < level_sets.size(); ++i)
    remeshed.objects.push_back({.name = level_sets.size() == scene.objects.size() ? scene.objects[i].name : scene.name,
                                .source = LevelSetSource{level_sets[i], scene.name}});
  return world_mesh(remeshed, as_made);
}

/// Of all grids that go into a file together.
Json level_sets_json(const std::vector<LevelSet>& level_sets) {
  std::int64_t voxels = 0;
  Json grids = Json::array();
  for (const LevelSet& level_set : level_sets) {
    const LevelSetInfo& info = level_set.info();
    voxels += info.active_voxels;
    grids.push_back({{"name", info.name},
                     {"voxels", info.active_voxels},
                     {"voxel_size", info.voxel_size},
                     {"half_width_voxels", info.half_width_voxels}});
  }
  const LevelSetInfo& first = level_sets.front().info();
  return {{"kind", "level_set"},
          {"voxels", voxels},
          {"voxel_size", first.voxel_size},
          {"half_width_voxels", first.half_width_voxels},
          {"grids", grids}};
}

std::string level_sets_text(const std::vector<LevelSet>& level_sets) {
  std::string text;
  for (const LevelSet& level_set : level_sets) {
    const LevelSetInfo& info = level_set.info();
    text += fmt::format("{}{}{} voxels of {:g}, half width {:g} voxels", text.empty() ? "" : "\n",
                        level_sets.size() > 1 ? info.name + ": " : "", info.active_voxels, info.voxel_size, info.half_width_voxels);
  }
  return text;
}

/// What is wrong with the volumes that were read; a file made of them has it too.
void add_warnings_of_volumes(const Scene& scene, std::vector<std::string>& warnings) {
  for (const SceneObject& object : scene.objects) {
    const auto* volume = std::get_if<LevelSetSource>(&object.source);
    if (volume == nullptr) continue;
    for (const std::string& warning : volume->level_set.info().warnings)
      if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(warning);
  }
}

int run(const Options& options) {
  const ThreadLimit threads(options.spec.threads);
  ProgressBar bar(wants_progress(options.quiet, options.no_progress));
  input_kind(options.spec.input);
  if (!options.outputs.empty()) {
    check_output_file(options.outputs.back(), options.no_clobber, kEndings);
    check_not_input(options.outputs.back(), {options.spec.input});
  }
  SceneInput input = load(options);
  const fs::path file = output_of(options, input.name, input.kind);
  check_output_file(file, options.no_clobber, kEndings);
  check_not_input(file, files_of(input));
  SurfaceSettings settings = surface_settings(options.spec, input);
  check_kind(settings, file);
  if (options.refined) check_refined(input.scene, settings, file);
  const std::optional<LocalSettings> local = local_of(options, input, settings, file);
  settings.progress = bar.stage("building the surface");

  // What is written to a .vdb is one level set, whatever it is called.
  const bool is_volume = ending_of(file) == ".vdb";
  SurfaceSettings expected = settings;
  if (settings.kind.empty()) expected.kind = is_volume ? "level_set" : "mesh";
  refuse_without_effect(options.spec.surface, input, use_of(input.scene, expected, is_volume));
  // A local level set says itself when it needs too much: what it takes is not known before.
  if (!(local && is_volume)) check_cost(options, input.scene, expected, {.library_bytes = is_volume ? kVolumeLibraryBytes : 0.0});
  std::vector<std::string> warnings = warn_of_input(options, input.scene, expected, {});
  WorldNotes said;
  Json document;
  std::string text;
  if (is_volume) {
    SurfaceSettings of_local = settings;
    of_local.kind = local_kind_of(input.scene, settings, true);
    const std::vector<LevelSet> level_sets =
        local ? local_level_sets(input.scene, of_local, *local, &said.warnings) : world_level_sets(input.scene, settings, said);
    write_level_sets(level_sets, file);
    document = level_sets_json(level_sets);
    text = level_sets_text(level_sets);
  } else {
    const Mesh mesh = local ? world_local_mesh(input.scene, settings, *local, said.warnings)
                            : exported_mesh(input.scene, settings, options.refined, said);
    write_mesh(mesh, file);
    document = {{"kind", "mesh"}, {"vertices", mesh.vertex_count()}, {"faces", mesh.face_count()}};
    text = fmt::format("{} vertices, {} faces", mesh.vertex_count(), mesh.face_count());
  }
  bar.clear();
  add_warnings_of_volumes(input.scene, said.warnings);
  document["files"] = {file.string()};
  warnings.insert(warnings.end(), said.warnings.begin(), said.warnings.end());
  document["warnings"] = warnings;
  document["notes"] = said.notes;
  print_warnings(options, said.warnings);
  if (!options.quiet) {
    for (const std::string& note : said.notes) print_note(note);
  }
  if (options.json)
    print_json(document);
  else if (!options.quiet)
    print_text(file.string() + "\n" + text + "\n");
  return 0;
}

}  // namespace

Command export_command() {
  return {"export", "writes the surface as modelled, for other tools",
          "  limn export teacup --level 4 -o teacup.obj\n"
          "  limn export gyroid --voxels 300 -o gyroid.vdb",
          add_options, run};
}

}  // namespace limn
