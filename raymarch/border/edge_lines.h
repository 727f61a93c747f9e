#pragma once
// The arithmetic of draw_edges, line by line: every source as a row of floats (vectors interleaved) with one repeated pixel on each side,
// so that the operators are plain loops that the compiler turns into vector code.

#include <array>
#include <memory>

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
  const Image<glm::vec3>* custom = nullptr;  ///< The custom source; read where its weight is above 0.
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
  static constexpr int kChunk = 64;              // pixels whose grazing factors are worked out together, where they matter
  static constexpr size_t kFloatsPerPixel = 11;  // depth, its tolerance, normal, colour, custom
  struct Line {
    int row = -1;
    std::unique_ptr<float[]> floats;  ///< Not initialised: only the rows of used sources are written and read.
    std::vector<std::uint32_t> keys;
    std::vector<std::uint8_t> grazed;  ///< Chunks whose tolerance has its grazing factor.
  };
  using Rows = std::array<Line*, 3>;
  Line& line(int y);
  void fill(int y, Line& out);
  void fill_depth(size_t first, Line& out);
  void fill_normals(size_t first, Line& out);
  void fill_colors(size_t first, Line& out);
  void graze(Line& of, int chunk);
  /// The row that starts `floats_before` floats into each pixel's share; its element 0 is the picture's first pixel.
  float* row_of(Line& of, size_t floats_before, size_t floats) { return of.floats.get() + floats_before * stride_ + floats; }
  void strength(size_t floats_before, size_t floats, const Rows& rows);
  void id_strength(const Rows& rows);
  void depth_edges(const Rows& rows, float* edges);
  void compare_depth(const Rows& rows, int x0, int x1, float* edges);

  const EdgeSettings& settings_;
  const BorderInput& input_;
  float nearest_;
  int width_;
  size_t stride_;
  std::array<Line, 3> lines_;
  std::vector<float> squares_, wide_squares_, least_;
};

}  // namespace limn
