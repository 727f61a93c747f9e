#include "raymarch/truth/lattice_memory.h"

namespace limn {

size_t LatticeRegion::bytes() const {
  size_t sum = modelled.bytes() + modelled_bytes;
  for (const auto& [branch, samples] : branches) sum += samples.bytes();
  for (const auto& [pair, curves] : seams) sum += curves.crossings.capacity() * sizeof(Crossing) + curves.links.capacity() * sizeof(Link);
  return sum;
}

void LatticeMemory::prepare(const CellGrid& grid, size_t most_bytes) {
  size_t bytes = 0;
  for (const auto& [key, region] : regions) bytes += region.bytes();
  if (grid.corner != corner || grid.side != side || bytes > most_bytes) regions.clear();
  corner = grid.corner;
  side = grid.side;
}

}  // namespace limn
