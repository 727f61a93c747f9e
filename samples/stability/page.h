#pragma once
// The page that shows what `limn study stability` found: methods across, cases down, with the pictures.

#include <filesystem>
#include <string>

#include "samples/stability/results.h"

namespace limn {

/// The whole page, without requests to anywhere. Pictures are read from `folder` and held in the page.
std::string stability_page(const StabilityResults& results, const std::filesystem::path& folder);

}  // namespace limn
