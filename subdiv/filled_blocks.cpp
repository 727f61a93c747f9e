#include "subdiv/filled_blocks.h"

namespace limn {

void FilledBlocks::add(const glm::ivec3& origin, const BlockFaces& faces) {
  if (slabs_[0].blocks.empty() || slabs_[0].x != origin.x) {
    std::swap(slabs_[0], slabs_[1]);
    slabs_[0] = {origin.x, {}};
  }
  slabs_[0].blocks.emplace(std::pair(origin.y, origin.z), faces);
}

const BlockFace* FilledBlocks::before(const glm::ivec3& origin, int axis) const {
  glm::ivec3 at = origin;
  at[axis] -= 8;
  for (const Slab& slab : slabs_) {
    if (slab.x != at.x) continue;
    const auto found = slab.blocks.find({at.y, at.z});
    if (found != slab.blocks.end()) return &found->second[static_cast<size_t>(axis)];
  }
  return nullptr;
}

}  // namespace limn
