#pragma once
// Internal: what a volume's file says of a grid beside its voxels, kept so that writing it again loses nothing.

#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace limn {

/// One entry of a grid's metadata as OpenVDB files it: `bytes` are a 32-bit length and as many bytes of value.
struct GridMetadata {
  std::string name, type;
  std::string bytes;
};

/// Values of one block of 8^3 nodes that single precision does not hold, numbered as in LevelSetBlock.
struct DoubleBlock {
  glm::ivec3 origin{};
  double values[512];
};

struct GridFile {
  std::string value_type = "float";  ///< As it is filed: float, double or half.
  std::string grid_class = "level set";
  std::vector<GridMetadata> metadata{};
  std::vector<GridMetadata> of_file{};  ///< The file's own, shared by all its grids.
  std::vector<DoubleBlock> doubles{};   ///< Of a grid of doubles that is as its file has it.
};

}  // namespace limn
