#pragma once
// The arithmetic of draw_edges, line by line: every source as planes of float with one repeated pixel on each side, so that the operators
// are plain loops that the compiler turns into vector code.

#include <array>

#include "raymarch/border/edge_sources.h"

namespace limn {

inline constexpr size_t kDepthSource = 0, kNormalSource = 1, kColorSource = 2, kIdSource = 3, kCustomSource = 4, kSourceCount = 5;

struct EdgeSource {
  float weight = 0.0f;
  float threshold = 0.0f;  ///< Of the edge strength; depth: pixel sizes.
};

struct EdgeSettings {
  EdgeOperator edge_operator = EdgeOperator::roberts;
  std::array<EdgeSource, kSourceCount> sources{};
  float distance_factor = 1.0f;
  GrazingModulation grazing{};
  bool debug = false;
  bool used(size_t source) const { return sources[source].weight > 0.0f || (debug && source <= kColorSource); }
};

/// 1 where a source has an edge, else 0; one line of each.
class EdgeFlags {
 public:
  explicit EdgeFlags(int width) : width_(static_cast<size_t>(width)), flags_(width_ * kSourceCount, 0.0f) {}
  float* of(size_t source) { return flags_.data() + source * width_; }
  const float* of(size_t source) const { return flags_.data() + source * width_; }

 private:
  size_t width_;
  std::vector<float> flags_;
};

/// `factors[i]` = grazing_factor(n_dot_v[i]).
void grazing_factors(const GrazingModulation& modulation, const float* n_dot_v, int count, float* factors);

/// Walks down a band of lines; keeps the three lines that an operator needs.
class EdgeLines {
 public:
  /// `nearest_depth`: the smallest Z of the picture, finite.
  EdgeLines(const EdgeSettings& settings, const BorderInput& input, float nearest_depth);
  void find_edges(int y, EdgeFlags& flags);

 private:
  static constexpr size_t kPlanes = 11;  // depth, its tolerance, normal, colour, custom
  struct Line {
    int row = -1;
    std::vector<float> planes;
    std::vector<std::uint32_t> keys;
  };
  Line& line(int y);
  void fill(int y, Line& out);
  void fill_depth(size_t first, Line& out);
  void fill_colors(size_t first, Line& out);
  float* plane(Line& of, size_t index) { return of.planes.data() + index * stride_ + 1; }
  void strength(size_t first_plane, size_t count, const std::array<Line*, 3>& rows);
  void id_strength(const std::array<Line*, 3>& rows);
  void depth_edges(const std::array<Line*, 3>& rows, float* edges);

  const EdgeSettings& settings_;
  const BorderInput& input_;
  float nearest_;
  int width_;
  size_t stride_;
  std::array<Line, 3> lines_;
  std::vector<float> squares_, scratch_;
};

}  // namespace limn
