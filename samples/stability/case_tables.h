#pragma once
// Internal: the tables of a case file that are no scene's.

#include <map>
#include <optional>
#include <string>

#include "subdiv/mesh.h"

namespace limn {

struct VolumeSettings {
  int voxels = 48;
  double half_width_voxels = 3.0;
};

/// What a case brings with it for its objects to be made of.
struct CaseSources {
  std::map<std::string, Mesh> meshes{};
  std::optional<VolumeSettings> volume{};
};

/// `text` with values for its parameters. Throws InputError.
CaseSources read_sources(const std::string& text, const std::string& file);

}  // namespace limn
