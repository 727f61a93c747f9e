#include "raymarch/truth/curve_tubes.h"

#include <algorithm>
#include <climits>

namespace limn {
namespace {

constexpr int kParts = 1 << kNearCuts;

std::uint64_t packed(const glm::ivec3& cell) {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v) + 16; };  // cells may begin below zero by a few
  return (part(cell.x) << 20 | part(cell.y)) << 20 | part(cell.z);
}

std::uint64_t bit_of(const glm::ivec3& part) { return std::uint64_t{1} << ((part.x & 3) << 4 | (part.y & 3) << 2 | (part.z & 3)); }

}  // namespace

void CurveTubes::add(const CellGrid& grid, const CellCurves& curves) {
  KeyedValues<glm::dvec3> points;
  for (const Crossing& crossing : curves.crossings) {
    bool added = false;
    glm::dvec3& point = points.at(crossing.key, added);
    if (added) point = (crossing.point.p - grid.corner) / grid.side;
  }
  glm::ivec3 last_part(INT_MIN);
  for (const Link& link : curves.links) {
    const glm::dvec3 a = *points.find(link.from), b = *points.find(link.to);
    const int steps = 1 + static_cast<int>(glm::distance(a, b) * 2.0 * kParts);
    for (int i = 0; i <= steps; ++i) {
      const glm::dvec3 p = glm::mix(a, b, static_cast<double>(i) / steps);
      const glm::ivec3 part(glm::floor(p * static_cast<double>(kParts)));
      if (part != last_part) insert_around(part);
      last_part = part;
    }
  }
}

void CurveTubes::add(const CurveTubes& other) {
  for (const auto& [key, parts] : other.blocks_.entries()) {
    bool added = false;
    blocks_.at(key, added) |= parts;
  }
}

void CurveTubes::insert_around(const glm::ivec3& part) {
  const glm::ivec3 low = part - 1, high = part + 1;
  for (int x = low.x >> 2; x <= high.x >> 2; ++x) {
    for (int y = low.y >> 2; y <= high.y >> 2; ++y) {
      for (int z = low.z >> 2; z <= high.z >> 2; ++z) {
        bool added = false;
        std::uint64_t& block = blocks_.at(packed({x, y, z}), added);
        for (int i = std::max(low.x, 4 * x); i <= std::min(high.x, 4 * x + 3); ++i) {
          for (int j = std::max(low.y, 4 * y); j <= std::min(high.y, 4 * y + 3); ++j) {
            for (int k = std::max(low.z, 4 * z); k <= std::min(high.z, 4 * z + 3); ++k) block |= bit_of({i, j, k});
          }
        }
      }
    }
  }
}

std::uint64_t CurveTubes::block(const glm::ivec3& cell) const {
  const std::uint64_t* found = blocks_.find(packed(cell));
  return found != nullptr ? *found : 0;
}

}  // namespace limn
