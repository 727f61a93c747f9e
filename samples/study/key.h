#pragma once
// Names of cells and studies: hashes of all that determines them and of nothing else.

#include "samples/study/study.h"

namespace limn {

/// Of bytes, 32 hexadecimal digits: 128 bits of their SHA-1, against chance and not against malice.
std::string content_hash(std::string_view bytes);

/// Of what the input holds, wherever it lies: a built-in scene's name, files' bytes, meshes as loaded.
std::string hash_of_input(const SceneInput& input);

/// Fills the keys of all cells and the study's id.
void name_cells(Study& study);

}  // namespace limn
