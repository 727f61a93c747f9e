#pragma once
// docs/reference.md: every shape, surface, gradient, method, metric and check from its descriptor, every key of a scene file, column of a
// study and value of JSON from the tables here.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sdf/descriptor.h"

namespace limn {

struct DocumentedKey {
  std::string_view where;  ///< The table of a scene file ("camera"), or the command whose JSON has it ("render"); empty for columns.
  std::string_view key;    ///< A path: "cells[].bytes"; "metrics.*" stands for all names below it.
  std::string_view unit;   ///< "px", "ms", "bytes"; empty: a name, a text, a count or a share.
  std::string_view help;
};

/// Of scene files, in the order of docs/commands.md.
std::span<const DocumentedKey> scene_keys();
/// Of rows.csv, in order; rows.jsonl has the same names.
std::span<const DocumentedKey> row_columns();
/// Of --json, and of rows.json that `compare` writes.
std::span<const DocumentedKey> json_keys();

/// Of `normals`, as parse_normals reads them.
std::vector<Description> normal_kinds();

/// docs/reference.md.
std::string reference_page();

}  // namespace limn
