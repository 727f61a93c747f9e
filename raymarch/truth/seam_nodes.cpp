#include "raymarch/truth/seam_nodes.h"

#include <utility>

#include "raymarch/truth/limit_grid.h"

namespace limn {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

std::uint64_t key(const glm::dvec3& cell) {
  const auto mixed = [](double v, std::uint64_t factor) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(v)) * factor; };
  return mixed(cell.x, 0x9e3779b97f4a7c15u) ^ mixed(cell.y, 0xc2b2ae3d27d4eb4fu) ^ mixed(cell.z, 0x165667b19e3779f9u);
}

}  // namespace

std::uint32_t SeamNodes::node_at(const glm::dvec3& p, std::uint32_t& next_number) {
  const double side = 2.0 * tolerance_;
  const glm::dvec3 low = glm::floor((p - tolerance_) / side), high = glm::floor((p + tolerance_) / side);
  for (double x = low.x; x <= high.x; ++x) {
    for (double y = low.y; y <= high.y; ++y) {
      for (double z = low.z; z <= high.z; ++z) {
        const size_t cell = cells_.find(key({x, y, z}));
        if (cell == KeyNumbers::kNone) continue;
        for (std::uint32_t node = first_in_cell_[cell]; node != kNone; node = nodes_[node].next) {
          if (glm::distance(nodes_[node].position, p) <= tolerance_) return node;
        }
      }
    }
  }
  const auto node = static_cast<std::uint32_t>(nodes_.size());
  const auto [cell, is_new] = cells_.add(key(glm::floor(p / side)));
  if (is_new) first_in_cell_.push_back(kNone);
  nodes_.push_back({p, next_number++, kNone, std::exchange(first_in_cell_[cell], node)});
  return node;
}

std::uint32_t SeamNodes::side_of(std::uint32_t node, const glm::dvec3& normal, std::uint32_t& next_number) {
  std::uint32_t* link = &nodes_[node].first_side;
  for (; *link != kNone; link = &sides_[*link].next) {
    const Side& side = sides_[*link];
    if (glm::distance(side.normal, normal) < kSameLimitNormal) return side.number;
  }
  *link = static_cast<std::uint32_t>(sides_.size());  // before the vector moves
  sides_.push_back({normal, next_number++, nodes_[node].number});
  return sides_.back().number;
}

}  // namespace limn
