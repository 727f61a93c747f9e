#pragma once
// Fields from .vm files (fidget, libfive): a list of arithmetic operations, one a line.

#include <filesystem>
#include <string>
#include <string_view>

#include "sdf/field.h"

namespace limn {

/// What a .vm file holds.
struct VmField {
  /// Parts without thickness (two planes that face each other at no distance) are left out.
  Field field;         ///< No steeper than 1 anywhere: near the surface `scale` times what the file computes, the same sign everywhere.
  double scale = 1.0;  ///< See `field`; above 0.
  std::string unbounded{};  ///< Empty where interval arithmetic bounds the surface, else along which axes it does not, in words.
};

/// The field ends in minima and maxima as a union or intersection of fields does, so that its edges are known as edges.
/// Throws InputError with file and line: not the format, more than 10,000 operations, an operation with jumps; nothing inside; a slope
/// without bound where the surface is (a division by 0, a square root of 0).
VmField vm_field(std::string_view text, const std::string& file);
/// The same of a file. Throws InputError where it cannot be read, too.
VmField load_vm(const std::filesystem::path& file);

}  // namespace limn
