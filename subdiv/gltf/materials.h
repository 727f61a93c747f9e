#pragma once
// Internal: names and base colours of a document's materials.

#include "subdiv/gltf/document.h"

namespace limn::gltf {

struct Materials {
  std::vector<std::string> names{};
  std::vector<glm::vec3> colors{};  ///< Linear; white where the file gives none.
  std::vector<char> textured{};
};
/// One for each material of the file, and a last one, white, for what has none.
Materials read_materials(const Json& root);

}  // namespace limn::gltf
