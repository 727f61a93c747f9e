#include "subdiv/weld.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <tuple>

namespace limn {
namespace {

std::uint64_t mixed(std::uint64_t x) {  // splitmix64 (Steele, Lea & Flood 2014)
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// Equal positions have equal ones: minus zero is zero.
std::uint64_t hash_of(const glm::dvec3& p) {
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x + 0.0); };
  return mixed(bits(p.x) ^ mixed(bits(p.y) ^ mixed(bits(p.z))));
}

using Corners = std::array<std::uint32_t, 3>;

Corners sorted_corners(const glm::uvec3& t, std::span<const std::uint32_t> first) {
  Corners corners{first[t.x], first[t.y], first[t.z]};
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// Whether two triangles on the same corners run round them the same way.
bool same_way(const glm::uvec3& a, const glm::uvec3& b, std::span<const std::uint32_t> first) {
  const auto after = [&](const glm::uvec3& t, std::uint32_t corner) {
    for (int i = 0; i < 3; ++i)
      if (first[t[i]] == corner) return first[t[(i + 1) % 3]];
    return corner;
  };
  return after(a, first[a.x]) == after(b, first[a.x]);
}

/// Bits by hash: all that is said twice is found, and little else.
class SeenBits {
 public:
  explicit SeenBits(size_t count) : bits_(std::bit_ceil(std::max<size_t>(64, 32 * count)) / 64, 0) {}
  /// True where it had been said before.
  bool say(std::uint64_t hash) {
    std::uint64_t& word = bits_[(hash >> 6) & (bits_.size() - 1)];
    const std::uint64_t bit = std::uint64_t{1} << (hash & 63);
    const bool before = (word & bit) != 0;
    word |= bit;
    return before;
  }
  bool has(std::uint64_t hash) const { return (bits_[(hash >> 6) & (bits_.size() - 1)] >> (hash & 63) & 1) != 0; }

 private:
  std::vector<std::uint64_t> bits_;
};

/// Triangles that share all corners with another, by corners and then in order; and a few more.
std::vector<std::uint32_t> candidates(const TriangleMesh& mesh, std::span<const std::uint32_t> first) {
  // Sums and products do not depend on the order of the corners.
  const auto hash = [&](const glm::uvec3& t) {
    const std::uint64_t a = first[t.x], b = first[t.y], c = first[t.z];
    return mixed((a + b + c) * 0x9e3779b97f4a7c15ull + a * b + b * c + c * a);
  };
  SeenBits seen(mesh.triangles.size());
  std::vector<std::uint64_t> twice;
  for (const glm::uvec3& t : mesh.triangles)
    if (const std::uint64_t h = hash(t); seen.say(h)) twice.push_back(h);
  if (twice.empty()) return {};
  SeenBits said(twice.size());
  for (const std::uint64_t h : twice) said.say(h);
  std::vector<std::uint32_t> found;
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    if (said.has(hash(mesh.triangles[i]))) found.push_back(static_cast<std::uint32_t>(i));
  std::sort(found.begin(), found.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(sorted_corners(mesh.triangles[a], first), a) < std::tuple(sorted_corners(mesh.triangles[b], first), b);
  });
  return found;
}

}  // namespace

std::vector<std::uint32_t> first_at_position(std::span<const glm::dvec3> positions) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  // At most half full, looked through from where the hash says.
  std::vector<std::uint32_t> table(std::bit_ceil(std::max<size_t>(16, 2 * positions.size())), kNone);
  const size_t mask = table.size() - 1;
  std::vector<std::uint32_t> first(positions.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    size_t at = hash_of(positions[i]) & mask;
    while (table[at] != kNone && positions[table[at]] != positions[i]) at = (at + 1) & mask;
    if (table[at] == kNone) table[at] = static_cast<std::uint32_t>(i);
    first[i] = table[at];
  }
  return first;
}

MergedTriangles merge_coincident(const TriangleMesh& mesh, std::span<const std::uint32_t> first) {
  const std::vector<std::uint32_t> found = candidates(mesh, first);
  const auto corners = [&](size_t k) { return sorted_corners(mesh.triangles[found[k]], first); };
  std::vector<std::pair<std::uint32_t, std::int32_t>> times;  // of those that stay and are there more than once
  std::vector<std::uint32_t> dropped;
  for (size_t k = 0; k < found.size();) {
    size_t end = k + 1;
    std::int32_t count = 1;
    for (; end < found.size() && corners(end) == corners(k); ++end) {
      count += same_way(mesh.triangles[found[k]], mesh.triangles[found[end]], first) ? 1 : -1;
      dropped.push_back(found[end]);
    }
    if (end > k + 1) times.emplace_back(found[k], count > 0 ? 1 : count < 0 ? -1 : 0);
    k = end;
  }
  MergedTriangles merged;
  if (dropped.empty()) {
    merged.triangles = mesh.triangles;
    return merged;
  }
  std::sort(dropped.begin(), dropped.end());
  std::sort(times.begin(), times.end());
  auto drop = dropped.begin();
  auto more = times.begin();
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (drop != dropped.end() && *drop == i) {
      ++drop;
      continue;
    }
    merged.triangles.push_back(mesh.triangles[i]);
    merged.times.push_back(more != times.end() && more->first == i ? (more++)->second : 1);
  }
  return merged;
}

}  // namespace limn
