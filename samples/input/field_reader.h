#pragma once

#include <filesystem>
#include <functional>

#include "samples/input/toml_reader.h"
#include "sdf/field.h"
#include "sdf/geometry.h"

namespace limn {

inline constexpr int kGreatestMaterial = 1'000'000;

/// How the files that a field names are read.
using VmReader = std::function<Field(const std::filesystem::path& file)>;

/// A field from a table with `shape` and its parameters, with `vm` (a file beside the scene's), or with `csg`, `of` and `smooth`; then, in
/// this order, `grow` (offset, world), `shell` (thickness, world), `scale`, `rotate` and `translate`. A table in `of` may have a `material`
/// and a `color`: those of all shapes in it that have none themselves. Leaves the keys that belong to objects to the caller, who calls
/// finish.
Field read_field(TomlReader& reader, const VmReader& read_vm);

/// translate, rotate, scale of a table, for what is not a field: world_from_object.
Affine read_placement(TomlReader& reader);

}  // namespace limn
