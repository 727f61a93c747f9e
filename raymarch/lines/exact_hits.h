#pragma once
// Internal: which triangles a segment goes through, in double precision.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace limn {

struct LayerTriangle;

inline constexpr std::uint32_t kNoIndex = 0xffffffffu;

/// Where a segment goes through a triangle: the share of the segment, above 0 and below 1.
struct ExactHit {
  double share = 0.0;
  std::uint32_t triangle = 0;
};

/// A segment, and the triangles that it starts on or ends at: these are not asked.
struct Segment {
  glm::dvec3 from{0.0}, to{0.0};
  std::array<std::uint32_t, 2> edge{kNoIndex, kNoIndex};      ///< Triangles that have both of these vertices.
  std::array<std::uint32_t, 2> vertices{kNoIndex, kNoIndex};  ///< Those that have one of these.
  std::array<std::uint32_t, 2> faces{kNoIndex, kNoIndex};     ///< These themselves.
};

/// A tree over triangles in double precision. Where two of them share an edge a segment goes through one of them, whatever rounding does.
/// Keeps references to what it is made of; safe from many threads.
class ExactHits {
 public:
  /// `extent`: the radius of all of them, which their coordinates are of the order of. Throws MachineError.
  ExactHits(std::span<const glm::dvec3> positions, std::span<const LayerTriangle> triangles, double extent);
  ~ExactHits();
  ExactHits(const ExactHits&) = delete;
  ExactHits& operator=(const ExactHits&) = delete;

  /// In order along the segment.
  std::vector<ExactHit> through(const Segment& segment) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace limn
