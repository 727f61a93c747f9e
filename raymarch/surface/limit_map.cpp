#include "raymarch/surface/limit_map.h"

#include <algorithm>

namespace limn {
namespace {

using Domain = std::array<glm::dvec2, 4>;

/// The parameters at the corners of child `child` of a face, in OpenSubdiv's order of children and corners.
Domain quad_child(const Domain& parent, int child) {
  const auto i = static_cast<size_t>(child), next = (i + 1) % 4, across = (i + 2) % 4, before = (i + 3) % 4;
  Domain result;
  result[i] = parent[i];
  result[next] = 0.5 * (parent[i] + parent[next]);
  result[across] = 0.25 * (parent[0] + parent[1] + parent[2] + parent[3]);
  result[before] = 0.5 * (parent[i] + parent[before]);
  return result;
}
Domain triangle_child(const Domain& parent, int child) {
  const glm::dvec2 ab = 0.5 * (parent[0] + parent[1]), bc = 0.5 * (parent[1] + parent[2]), ca = 0.5 * (parent[2] + parent[0]);
  if (child == 0) return {parent[0], ab, ca};
  if (child == 1) return {ab, parent[1], bc};
  if (child == 2) return {ca, bc, parent[2]};
  return {bc, ca, ab};
}

}  // namespace

LimitMap::LimitMap(const Mesh& cage, Scheme scheme, int level, const std::string& file)
    : surface(cage, scheme, file), face_sizes_(cage.face_sizes), scheme_(scheme), level_(level) {
  const std::int64_t later = std::int64_t{1} << (2 * std::max(level - 1, 0));
  first_child_.push_back(0);
  for (size_t f = 0; f < face_sizes_.size(); ++f) {
    if (std::binary_search(cage.holes.begin(), cage.holes.end(), static_cast<std::int32_t>(f))) {
      first_child_.push_back(first_child_.back());
      continue;
    }
    const std::int64_t children = level == 0 ? 1 : scheme == Scheme::loop ? 4 * later : face_sizes_[f] * later;
    first_child_.push_back(first_child_.back() + children);
  }
}

bool LimitMap::piece_of(std::int32_t refined_face, LimitPiece& piece) const {
  const auto at = std::upper_bound(first_child_.begin(), first_child_.end(), std::int64_t{refined_face});
  piece.face = static_cast<int>(at - first_child_.begin()) - 1;
  const std::int32_t size = face_sizes_[static_cast<size_t>(piece.face)];
  const std::int64_t rest = refined_face - first_child_[static_cast<size_t>(piece.face)];
  const bool triangles = scheme_ == Scheme::loop;
  piece.corners = triangles ? Domain{{{0, 0}, {1, 0}, {0, 1}, {0, 0}}} : Domain{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  int digits = level_;
  if (!triangles && size != 4) {
    if (digits == 0) return false;
    --digits;
    piece.sub_face = static_cast<int>(rest >> (2 * digits));
  }
  while (digits > 0) {
    const int child = static_cast<int>((rest >> (2 * --digits)) & 3);
    piece.corners = triangles ? triangle_child(piece.corners, child) : quad_child(piece.corners, child);
  }
  return true;
}

}  // namespace limn
