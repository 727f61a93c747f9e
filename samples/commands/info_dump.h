#pragma once
// What limn computes with, as text: `limn info --dump`.

#include <string>

#include "samples/commands/options.h"
#include "samples/input/input.h"

namespace limn {

/// Object by object, as pictures of this scene use it: in render space. An object that has nothing to dump has a line with the reason.
/// Throws InputError where no object has, and for settings without effect.
std::string dump_text(const Options& options, SceneInput input);

}  // namespace limn
