#include "samples/input/scene_file.h"
#include "samples/spec/parse.h"
#include "samples/spec/surface_setting.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>

#include "raymarch/border.h"
#include "raymarch/surface.h"
#include "samples/input/field_reader.h"
#include "samples/input/named_file.h"
#include "samples/input/toml_reader.h"
#include "sdf/framed_surface.h"
#include "sdf/guard.h"
#include "subdiv/import.h"

namespace limn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void read_view_angles(TomlReader& reader, CameraSettings& camera) {
  const auto azimuth = reader.number("azimuth", -kInfinity, kInfinity, "degrees");
  const auto elevation = reader.number("elevation", -90.0, 90.0, "degrees from -90 to 90");
  if (!azimuth && !elevation) return;
  if (camera.eye) reader.fail("eye beside azimuth or elevation", "an eye, or the angles to look from");
  if (!(glm::length(camera.up) > 0.0)) return;  // refused where the camera is resolved
  ViewAngles angles = angles_of(default_view_direction(camera.up), camera.up);
  if (azimuth) angles.azimuth = *azimuth * std::numbers::pi / 180.0;
  if (elevation) angles.elevation = *elevation * std::numbers::pi / 180.0;
  camera.direction = direction_at(angles, camera.up);
}

CameraSettings read_camera(TomlReader& reader) {
  CameraSettings camera;
  camera.eye = reader.vector3("eye");
  camera.target = reader.vector3("target");
  if (const auto up = reader.vector3("up")) camera.up = *up;
  if (const auto fov = reader.number_between("fov", 0.0, 180.0, "degrees above 0 and below 180")) {
    camera.vertical_fov = *fov * std::numbers::pi / 180.0;
  }
  if (const auto height = reader.number_between("ortho", 0.0, kInfinity, "the picture's height, above 0 in world units")) {
    if (reader.has("fov")) reader.fail("both fov and ortho", "one of the two");
    camera.projection = Projection::orthographic;
    camera.ortho_height = *height;
  }
  read_view_angles(reader, camera);
  const std::string size_expected = "[width, height] in whole pixels, 1 to 16384 each";
  if (const auto size = reader.numbers("size", 2, size_expected)) {
    for (const double side : *size) {
      if (side < 1.0 || side > 16384.0 || side != std::floor(side))
        reader.fail(*reader.take("size"), "size", "out of range", size_expected);
    }
    camera.width_px = static_cast<int>((*size)[0]);
    camera.height_px = static_cast<int>((*size)[1]);
  }
  reader.finish();
  return camera;
}

void read_setting(const SurfaceSetting& setting, TomlReader& reader, SurfaceSpec& surface) {
  const std::string key = setting.name;
  const auto place = [&] { return reader.where(*reader.take(key)); };
  if (setting.type == SettingType::name) {
    if (const auto word = reader.text(key)) setting.ask(surface, 0.0, *word, place(), reader.field(key));
    return;
  }
  std::optional<double> number;
  if (setting.type == SettingType::whole_number)
    number = reader.integer(key, static_cast<int>(setting.low), static_cast<int>(setting.high));
  else if (setting.includes_low)
    number = reader.number(key, setting.low, setting.high, setting.expected);
  else
    number = reader.number_between(key, setting.low, setting.high, setting.expected);
  if (number) setting.ask(surface, *number, "", place(), reader.field(key));
}

SurfaceSpec read_surface(TomlReader& reader) {
  SurfaceSpec surface;
  surface.kind = reader.text("kind");
  if (surface.kind) find_surface(*surface.kind, reader.where(*reader.take("kind")), reader.field("kind"));
  for (const SurfaceSetting& setting : surface_setting_list()) read_setting(setting, reader, surface);
  if (surface.voxels && surface.voxel_size) reader.fail("both voxels and voxel_size", "one of the two");
  reader.finish();
  return surface;
}

BorderDefaults read_border(TomlReader& reader) {
  BorderDefaults border;
  border.method = reader.text("method").value_or(kDefaultMethod);
  const toml::node* method_node = reader.take("method");
  const BorderMethod& method =
      find_border_method(border.method, method_node ? reader.where(*method_node) : reader.file(), reader.field("method"));
  border.parameters = reader.parameters(method.parameters);
  reader.finish();
  resolve(method.parameters, border.parameters, reader.file(), reader.field(""));
  return border;
}

std::filesystem::path beside(const TomlReader& reader, const std::string& name) {
  return std::filesystem::path(reader.file()).parent_path() / name;
}

MeshSource read_mesh(TomlReader& reader, const SceneReaders& readers, bool own_color, std::optional<int>& level) {
  const std::string name = *reader.text("mesh");
  std::optional<Scheme> scheme;
  if (const auto text = reader.text("scheme")) {
    scheme = parse_scheme(*text, reader.where(*reader.take("scheme")), reader.field("scheme"));
  }
  level = reader.integer("level", 0, 8);
  const auto smooth_angle = reader.number("smooth_angle", 0.0, 180.0, "an angle of 0 to 180 degrees");
  const std::filesystem::path path = beside(reader, name);
  Mesh mesh = read_named(reader, "mesh", path, [&] { return readers.mesh(path); });
  mesh.draws_colors = !own_color;
  // A level without a scheme still asks for subdivision.
  if (level && *level > 0 && !scheme) scheme = default_scheme(mesh);
  MeshSource source = mesh_source(std::move(mesh), scheme, path.string());
  source.smooth_angle_deg = smooth_angle;
  return source;
}

LevelSetSource read_volume(TomlReader& reader, const SceneReaders& readers) {
  const std::string name = *reader.text("vdb");
  const std::string grid = reader.text("grid").value_or("");
  const std::filesystem::path path = beside(reader, name);
  return {read_named(reader, "vdb", path, [&] { return readers.volume(path, grid); }), path.string()};
}

using Source = decltype(SceneObject::source);

SceneObject read_object(TomlReader& reader, const SceneReaders& readers, size_t index) {
  int kinds = 0;
  for (const char* key : {"shape", "csg", "vm", "mesh", "vdb"}) kinds += reader.has(key) ? 1 : 0;
  if (kinds != 1) {
    reader.fail(kinds == 0 ? "no shape, csg, vm, mesh or vdb" : "more than one of shape, csg, vm, mesh and vdb", "exactly one of them");
  }
  std::optional<int> level;
  Affine world_from_object;
  const auto read_source = [&](bool own_color) -> Source {
    if (reader.has("mesh")) return read_mesh(reader, readers, own_color, level);
    if (reader.has("vdb")) return read_volume(reader, readers);
    return read_field(reader, readers.vm);
  };
  // Cheap keys first, so that a slip in them is told before a large file is read.
  const std::string name = reader.text("name").value_or(fmt::format("object {}", index + 1));
  const std::optional<glm::vec3> own_color = reader.color("color");
  const glm::vec3 color = own_color.value_or(glm::vec3(0.8f));
  const int material = reader.integer("material", 0, kGreatestMaterial).value_or(0);
  if (reader.has("mesh") || reader.has("vdb")) world_from_object = read_placement(reader);
  Source source = read_source(own_color.has_value());
  reader.finish();
  return {name, std::move(source), world_from_object, color, material, level};
}

std::string read_text(const std::filesystem::path& file) {
  check_readable(file, "a scene file");
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw InputError({file.string(), "", "", "cannot be read", "a readable scene file"});
  return text.str();
}

}  // namespace

SceneInput parse_scene_file(const std::string& text, const std::filesystem::path& file, const SceneReaders& readers) {
  const toml::table root = parse_toml(text, file.string());
  SceneInput input;
  input.kind = InputKind::scene_file;
  input.name = file.stem().string();
  input.file = file.string();
  input.scene.name = input.name;

  TomlReader reader(root, file.string(), "");
  const auto single = [&reader](const std::string& key) -> const toml::table* {
    const toml::node* node = reader.take(key);
    if (node == nullptr) return nullptr;
    if (!node->is_table()) reader.fail(*node, key, "not a table", "[" + key + "]");
    return node->as_table();
  };
  const toml::table* camera = single("camera");
  const toml::table* surface = single("surface");
  const auto borders = reader.tables("border");
  const auto objects = reader.tables("object");
  reader.finish();
  if (objects.empty()) throw InputError({file.string(), "object", "", "no objects", "at least one [[object]]"});

  if (camera != nullptr) {
    TomlReader table(*camera, file.string(), "camera.");
    input.scene.camera = read_camera(table);
  }
  if (surface != nullptr) {
    TomlReader table(*surface, file.string(), "surface.");
    input.surface = read_surface(table);
  }
  for (size_t i = 0; i < borders.size(); ++i) {
    TomlReader table(*borders[i], file.string(), borders.size() == 1 ? "border." : fmt::format("border[{}].", i));
    input.borders.push_back(read_border(table));
  }
  SceneReaders noting = readers;
  noting.vm = [&readers, &input](const std::filesystem::path& vm_file) {
    input.formulas.push_back(vm_file.string());
    return readers.vm(vm_file);
  };
  for (size_t i = 0; i < objects.size(); ++i) {
    TomlReader table(*objects[i], file.string(), fmt::format("object[{}].", i));
    input.scene.objects.push_back(read_object(table, noting, i));
  }
  return input;
}

SceneInput load_scene_file(const std::filesystem::path& file) { return parse_scene_file(read_text(file), file); }

}  // namespace limn
