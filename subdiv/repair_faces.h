#pragma once
// Faces that nothing can be drawn of, as readers meet them: dropped, counted and said.

#include <functional>
#include <string>

#include "subdiv/mesh.h"

namespace limn {

/// How messages speak of a file.
struct RepairWords {
  std::string file{};
  int first_index = 0;  ///< The number of the first vertex in this format.
  /// Where a face is in the file ("line 12"); none: "face 12".
  std::function<std::string(size_t face)> place{};
  std::string instead{};    ///< What a file without faces holds ("6 lines").
  bool keep_equal = false;  ///< Faces with equal corners stay: of parts with materials of their own both may be meant.
};

/// Drops faces that name vertices which are not there (corners may hold any number), faces with fewer than three different corners, and
/// faces with the same corners in the same order as an earlier one. Two faces back to back stay, quads with a repeated corner too. What
/// belongs to a face goes with it and Mesh::holes is renumbered; vertices stay, because tags count them. Adds a sentence to Mesh::warnings
/// for each kind. Throws InputError where the mesh had no faces, or none is left. Linear in the mesh.
void repair_faces(Mesh& mesh, const RepairWords& words);

/// "1 face", "1,234 faces": for warnings.
std::string counted(std::int64_t count, const char* one, const char* many);

}  // namespace limn
