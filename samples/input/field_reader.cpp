#include "samples/input/field_reader.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numbers>

#include "samples/input/named_file.h"
#include "sdf/field_tree.h"
#include "sdf/shape.h"

namespace limn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Placement {
  glm::dvec3 scale{1.0};
  bool uniform = true;
  glm::dvec3 axis{0.0, 1.0, 0.0};
  double angle = 0.0;  ///< Radians.
  glm::dvec3 translation{0.0};
};

Placement read_transform(TomlReader& reader) {
  Placement placement;
  if (const auto by = reader.vector3("translate")) placement.translation = *by;
  if (const auto turn = reader.numbers("rotate", 4, "[axis x, axis y, axis z, degrees]")) {
    placement.axis = {(*turn)[0], (*turn)[1], (*turn)[2]};
    placement.angle = (*turn)[3] * std::numbers::pi / 180.0;
    if (!(glm::length(placement.axis) > 0.0) || !std::isfinite(glm::length(placement.axis)) || !std::isfinite(placement.angle)) {
      reader.fail(*reader.take("rotate"), "rotate", "the axis has no length, or a number is not finite",
                  "an axis such as [0, 1, 0, degrees]");
    }
  }
  const toml::node* scale = reader.take("scale");
  if (scale == nullptr) return placement;
  const std::string expected = "a number other than 0, or three of them, [x, y, z]; negative ones mirror";
  if (scale->is_array()) {
    placement.scale = *reader.vector3("scale");
    placement.uniform = placement.scale.x == placement.scale.y && placement.scale.y == placement.scale.z;
  } else {
    placement.scale = glm::dvec3(*reader.number("scale", -kInfinity, kInfinity, expected));
  }
  const glm::dvec3 size = glm::abs(placement.scale);
  if (!(size.x > 0.0 && size.y > 0.0 && size.z > 0.0) || !std::isfinite(size.x + size.y + size.z))
    reader.fail(*scale, "scale", "out of range", expected);
  return placement;
}

Field place(Field field, const Placement& placement) {
  if (placement.uniform && placement.scale.x != 1.0) field = scale(field, placement.scale.x);
  if (!placement.uniform) field = scale(field, placement.scale);
  if (placement.angle != 0.0) field = rotate(field, placement.axis, placement.angle);
  if (placement.translation != glm::dvec3(0.0)) field = translate(field, placement.translation);
  return field;
}

Field read_shape(TomlReader& reader) {
  const std::string name = *reader.text("shape");
  const ShapeDescriptor& shape = find_shape(name, reader.where(*reader.take("shape")), reader.field("shape"));
  const std::string prefix = reader.field("");
  return shape.make(resolve(shape.parameters, reader.parameters(shape.parameters), reader.file(), prefix));
}

Csg read_operation(TomlReader& reader) {
  const std::string name = *reader.text("csg");
  const std::vector<std::string> known = {"union", "intersection", "difference"};
  for (size_t i = 0; i < known.size(); ++i) {
    if (name == known[i]) return std::array{Csg::union_, Csg::intersection, Csg::difference}[i];
  }
  throw InputError({reader.where(*reader.take("csg")), reader.field("csg"), name, "unknown operation", known_names(name, known)});
}

Field read_vm_file(TomlReader& reader, const VmReader& read_vm) {
  const std::string name = *reader.text("vm");
  const std::filesystem::path path = std::filesystem::path(reader.file()).parent_path() / name;
  return read_named(reader, "vm", path, [&] { return read_vm(path); });
}

Field read_csg(TomlReader& reader, const VmReader& read_vm) {
  const Csg operation = read_operation(reader);
  const double smooth = reader.number("smooth", 0.0, kInfinity, "the blend's radius, 0 or more in world units").value_or(0.0);
  const auto tables = reader.tables("of");
  if (tables.empty()) reader.fail("csg without of", "of = [ { shape = … }, … ]");
  std::vector<Field> fields;
  for (size_t i = 0; i < tables.size(); ++i) {
    TomlReader item(*tables[i], reader.file(), reader.field(fmt::format("of[{}].", i)));
    const int material = item.integer("material", 0, kGreatestMaterial).value_or(kNoMaterial);
    const std::optional<glm::vec3> color = item.color("color");
    const Field field = read_field(item, read_vm);
    fields.push_back(material != kNoMaterial || color ? with_material(field, material, color) : field);
    item.finish();
  }
  return combine(operation, fields, smooth);
}

}  // namespace

namespace {

Field read_parts(TomlReader& reader, const VmReader& read_vm) {
  const int kinds = (reader.has("shape") ? 1 : 0) + (reader.has("csg") ? 1 : 0) + (reader.has("vm") ? 1 : 0);
  if (kinds != 1) reader.fail(kinds > 1 ? "more than one of shape, csg and vm" : "none of shape, csg and vm", "exactly one of them");
  Field field = reader.has("shape") ? read_shape(reader) : reader.has("vm") ? read_vm_file(reader, read_vm) : read_csg(reader, read_vm);
  if (const auto by = reader.number("grow", -kInfinity, kInfinity, "a length in world units")) field = offset(field, *by);
  if (const auto thickness = reader.number_between("shell", 0.0, kInfinity, "a thickness above 0 in world units")) {
    field = shell(field, *thickness);
  }
  return place(field, read_transform(reader));
}

}  // namespace

Field read_field(TomlReader& reader, const VmReader& read_vm) {
  try {
    return read_parts(reader, read_vm);
  } catch (const InputError& error) {
    // What a field refuses of itself says nothing of the file that asked for it.
    InputFault fault = error.fault();
    if (!fault.file.empty()) throw;
    // The line that says what it is, where there is one.
    const toml::node* const kind = reader.take(reader.has("csg") ? "csg" : reader.has("vm") ? "vm" : "shape");
    fault.file = kind != nullptr ? reader.where(*kind) : reader.file();
    fault.field = reader.field(fault.field);
    throw InputError(fault);
  }
}

Affine read_placement(TomlReader& reader) {
  const Placement placement = read_transform(reader);
  const glm::dmat4 turn =
      placement.angle == 0.0 ? glm::dmat4(1.0) : glm::rotate(glm::dmat4(1.0), placement.angle, glm::normalize(placement.axis));
  Affine world_from_object;
  world_from_object.linear = glm::dmat3(turn);
  for (int i = 0; i < 3; ++i) world_from_object.linear[i] *= placement.scale[i];
  world_from_object.translation = placement.translation;
  return world_from_object;
}

}  // namespace limn
