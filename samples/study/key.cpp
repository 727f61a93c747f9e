#include "samples/study/key.h"
#include "samples/spec/parse.h"
#include "samples/spec/surface_setting.h"

#include <fmt/format.h>

#include <cctype>
#include <cstddef>
#include <deque>
#include <fstream>
#include <span>
#include <sstream>

#include "raymarch/files/hash_module.h"
#include "raymarch/metric.h"
#include "sdf/error.h"
#include "sdf/level_set_bytes.h"
#include "sdf/version.h"

namespace limn {
namespace {

constexpr size_t kDigits = 32;

/// Of bytes in several places.
std::string digits_of(std::span<const std::span<const std::byte>> parts) {
  std::string digits = hash_module().sha1(parts).substr(0, kDigits);
  for (char& digit : digits) digit = static_cast<char>(std::tolower(static_cast<unsigned char>(digit)));
  return digits;
}

std::string file_hash(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  if (!stream) throw InputError({file, "", "", "cannot be read", "a file that you may read"});
  return content_hash(bytes.str());
}

/// A mesh's arrays where they are, each after its length.
struct MeshBytes {
  std::deque<std::uint64_t> counts{};  // their places stay
  std::vector<std::span<const std::byte>> parts{};

  template <class T>
  void append(const std::vector<T>& values) {
    parts.push_back(std::as_bytes(std::span(&counts.emplace_back(values.size()), 1)));
    parts.push_back(std::as_bytes(std::span(values)));
  }
};

// A mesh may come from several files (.gltf with its .bin), so what was loaded counts.
std::string mesh_hash(const Mesh& mesh) {
  MeshBytes bytes;
  bytes.append(mesh.positions);
  bytes.append(mesh.face_sizes);
  bytes.append(mesh.corner_vertices);
  bytes.append(mesh.corner_normals);
  bytes.append(mesh.face_materials);
  bytes.append(mesh.creases);
  bytes.append(mesh.corners);
  const auto boundary = static_cast<std::int32_t>(mesh.boundary);
  bytes.parts.push_back(std::as_bytes(std::span(&boundary, 1)));
  bytes.append(mesh.holes);
  bytes.append(mesh.face_smoothing);
  const std::int32_t rules[] = {static_cast<std::int32_t>(mesh.crease_method), static_cast<std::int32_t>(mesh.triangle_rule)};
  bytes.parts.push_back(std::as_bytes(std::span(rules)));
  return digits_of(bytes.parts);
}

/// Of a volume that was made and comes from no file.
std::string level_set_hash(const LevelSet& level_set) {
  const LevelSetBytes bytes = bytes_of(level_set);
  std::vector<std::span<const std::byte>> parts{std::as_bytes(std::span(bytes.numbers)), std::as_bytes(std::span(bytes.origins))};
  parts.insert(parts.end(), bytes.values.begin(), bytes.values.end());
  return digits_of(parts);
}

std::string vector_text(const glm::dvec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

std::string camera_text(const Camera& camera) {
  return fmt::format("camera {} {}x{} eye {} axes {} {} {} focal {} scale {}", static_cast<int>(camera.projection), camera.width_px,
                     camera.height_px, vector_text(camera.eye), vector_text(camera.world_from_camera[0]),
                     vector_text(camera.world_from_camera[1]), vector_text(camera.world_from_camera[2]), camera.focal_px,
                     camera.pixels_per_unit);
}

// What the representation reads, whether or not the study varies it.
std::string surface_text(const SurfaceSettings& settings) {
  const std::vector<std::string>* reads = settings.kind.empty() ? nullptr : &find_surface(settings.kind).settings;
  std::string text = "surface " + settings.kind + fmt::format(" max-steps {}", settings.max_steps);
  for (const SurfaceSetting& setting : surface_setting_list()) {
    if (reads != nullptr && std::find(reads->begin(), reads->end(), setting.name) == reads->end()) continue;
    const std::string used = setting.used(settings);
    text.append(" ").append(setting.name).append(" ").append(used.empty() ? "own" : used);
  }
  if (settings.resample_volumes) text += " resampled";
  return text;
}

std::string metrics_text() {
  std::string text = "metrics";
  for (const Metric& metric : metrics()) text += " " + metric.about.name;
  return text;
}

std::string flicker_text(const Study& study) {
  return study.flicker ? fmt::format("{} frames {} px apart", kFlickerPath.frames, kFlickerPath.step_px) : "no";
}

}  // namespace

std::string content_hash(std::string_view bytes) {
  const std::span<const std::byte> all = std::as_bytes(std::span(bytes));
  return digits_of({&all, 1});
}

std::string hash_of_input(const SceneInput& input) {
  std::string text = input.kind == InputKind::built_in ? "built-in " + input.name : "";
  if (input.kind == InputKind::scene_file) text += "scene " + file_hash(input.file);
  for (const std::string& formula : input.formulas) text += "\nformula " + file_hash(formula);
  if (input.kind == InputKind::field) text += "field " + file_hash(input.file);
  for (const SceneObject& object : input.scene.objects) {
    if (const auto* mesh = std::get_if<MeshSource>(&object.source))
      text += "\nmesh " + mesh_hash(mesh->mesh) + (mesh->scheme ? name_of(*mesh->scheme) : "") +
              (mesh->smooth_angle_deg ? fmt::format(" smooth-angle {}", *mesh->smooth_angle_deg) : "");
    if (const auto* volume = std::get_if<LevelSetSource>(&object.source))
      text += "\nvolume " + (volume->file.empty() ? level_set_hash(volume->level_set) : file_hash(volume->file)) + " " +
              volume->level_set.info().name;
  }
  return content_hash(text);
}

void name_cells(Study& study) {
  const std::string common = fmt::format("limn {} study {}\ninput {}\nreference {}\n{}\nflicker {}\ntruth of {}\n", kVersion, kStudyFormat,
                                         study.input_hash, surface_text(study.reference), metrics_text(), flicker_text(study),
                                         study.truth_reference == TruthReference::given ? "files as they are" : "the surface meant");
  std::vector<std::string> cameras, models, methods;
  for (const Camera& camera : study.cameras) cameras.push_back(camera_text(camera));
  for (const StudyModel& model : study.models) {
    models.push_back(surface_text(model.settings));
    if (!model.local_px) continue;
    models.back() += fmt::format(" local {} px for", *model.local_px);
    for (const std::string& camera : cameras) models.back() += " " + camera;
    for (const StudyMethod& method : study.methods)
      if (method.truth_threshold) models.back() += fmt::format(" threshold {}", *method.truth_threshold);
  }
  for (const StudyMethod& method : study.methods) {
    std::string text = "method " + method.call.method->about.name;
    for (const auto& [name, value] : method.parameters) text.append(" ").append(name).append("=").append(value);
    methods.push_back(std::move(text));
  }
  std::string all;
  for (StudyCell& cell : study.cells) {
    cell.key = content_hash(common + cameras[cell.view] + "\n" + models[cell.model] + "\n" + methods[cell.method]);
    all += cell.key + "\n";
  }
  study.head.id = content_hash(all);
}

}  // namespace limn
