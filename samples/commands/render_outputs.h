#pragma once
// The files of `limn render`: a picture each, or one that plays all frames.

#include <filesystem>
#include <vector>

#include "samples/commands/options.h"
#include "samples/input/input.h"

namespace limn {

/// Views, frames, or those of a turntable.
int pictures_of(const Options& options);
bool has_frames(const Options& options);
/// "frame" or "view", for messages.
const char* name_of_one(const Options& options);

/// Whether a file holds all frames of a turntable.
bool is_animated(const std::filesystem::path& file, const Options& options);
/// name.png, or name_v03.png for one of several views, name_f03.png for one of several frames.
std::filesystem::path picture_file(const std::filesystem::path& file, int index, const Options& options);

/// As asked for, or by the input's name.
std::vector<std::filesystem::path> outputs_of(const Options& options, const SceneInput& input);
/// Throws InputError for what cannot be written, or is read by the call.
void check_outputs(const std::vector<std::filesystem::path>& outputs, const std::vector<std::filesystem::path>& inputs,
                   const Options& options);

}  // namespace limn
