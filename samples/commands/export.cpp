#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "samples/commands/command.h"
#include "samples/input_files.h"
#include "samples/job.h"
#include "samples/limits.h"
#include "samples/no_effect.h"
#include "samples/output.h"
#include "samples/threads.h"
#include "samples/warnings.h"
#include "samples/world_model.h"
#include "sdf/error.h"
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
  add_output(app, options, ".obj .ply (refined mesh) or .vdb (level set); default limn-out/export/<name>.obj, .vdb for a volume", false);
  add_json(app, options);
  add_execution(app, options);
}

// --surface says by which way: mesh or level_set straight, mesh_level_set through both.
void check_kind(const SurfaceSettings& settings) {
  if (settings.kind == "analytic") {
    throw InputError({"", "--surface", settings.kind, "a formula cannot be written to a file", "mesh, level_set or mesh_level_set"});
  }
}

// The way to the file: through a mesh, a level set, or both.
OptionUse use_of(const Scene& scene, const SurfaceSettings& settings, bool to_level_set) {
  OptionUse use{.kinds = {settings.kind}, .level_set_file = to_level_set, .mesh_file = !to_level_set};
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

Mesh exported_mesh(const Scene& scene, const SurfaceSettings& settings, bool refined, std::vector<std::string>& warnings) {
  if (settings.kind != "level_set" && settings.kind != "mesh_level_set") return world_mesh(scene, settings, refined);
  SceneObject remeshed{.name = scene.name, .source = LevelSetSource{world_level_set(scene, settings, warnings), scene.name}};
  return world_mesh(remeshed, settings);
}

int run(const Options& options) {
  const ThreadLimit threads(options.threads);
  ProgressBar bar(wants_progress(options.quiet, options.no_progress));
  input_kind(options.input);
  if (!options.outputs.empty()) {
    check_output_file(options.outputs.back(), options, kEndings);
    check_not_input(options.outputs.back(), {options.input});
  }
  SceneInput input = load_input(options);
  const fs::path file = output_of(options, input.name, input.kind);
  check_output_file(file, options, kEndings);
  check_not_input(file, files_of(input));
  SurfaceSettings settings = surface_settings(options, input);
  check_kind(settings);
  if (options.refined) check_refined(input.scene, settings, file);
  settings.progress = bar.stage("building the surface");

  // What is written to a .vdb is one level set, whatever it is called.
  SurfaceSettings expected = settings;
  if (ending_of(file) == ".vdb" && settings.kind.empty()) expected.kind = "level_set";
  if (ending_of(file) != ".vdb" && settings.kind.empty()) expected.kind = "mesh";
  refuse_without_effect(options, input, use_of(input.scene, expected, ending_of(file) == ".vdb"));
  check_limits(options, input.scene, expected, {});
  std::vector<std::string> warnings = warn_of_input(options, input.scene, expected, {});
  const size_t of_input = warnings.size();
  Json document;
  std::string text;
  if (ending_of(file) == ".vdb") {
    const LevelSet level_set = world_level_set(input.scene, settings, warnings);
    const LevelSetInfo& info = level_set.info();
    write_level_set(level_set, file);
    document = {{"kind", "level_set"},
                {"voxels", info.active_voxels},
                {"voxel_size", info.voxel_size},
                {"half_width_voxels", info.half_width_voxels}};
    text = fmt::format("{} voxels of {:g}, half width {:g} voxels", info.active_voxels, info.voxel_size, info.half_width_voxels);
  } else {
    const Mesh mesh = exported_mesh(input.scene, settings, options.refined, warnings);
    write_mesh(mesh, file);
    document = {{"kind", "mesh"}, {"vertices", mesh.vertex_count()}, {"faces", mesh.face_count()}};
    text = fmt::format("{} vertices, {} faces", mesh.vertex_count(), mesh.face_count());
  }
  bar.clear();
  document["files"] = {file.string()};
  document["warnings"] = warnings;
  print_warnings(options, {warnings.begin() + static_cast<std::ptrdiff_t>(of_input), warnings.end()});
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
