#pragma once
// Ink in a picture: how much of each pixel it covers, and the lines that it makes.

#include <filesystem>

#include "samples/judge/drawing_file.h"
#include "sdf/image.h"

namespace limn {

/// Coverage from 0 to 1. Throws InputError where the file cannot be read or has no such channel.
Image<float> read_ink(const std::filesystem::path& file, const InkChoice& ink);

/// Ink narrower than about four pixels becomes its centre line, wider ink its edges.
DrawnLines lines_of_ink(const Image<float>& coverage);

}  // namespace limn
