#pragma once
// The page that shows what `limn stability` found: methods across, cases down, with the pictures.

#include <filesystem>
#include <string>

#include "samples/stability/results.h"

namespace limn {

/// The whole page, without requests to anywhere. Pictures are read from `folder` and held in the page.
std::string stability_page(const StabilityResults& results, const std::filesystem::path& folder);
/// A Markdown table of outcomes: the catalogue's rows down, how many cells came out how across, the sum below.
std::string stability_markdown(const StabilityResults& results);

}  // namespace limn
