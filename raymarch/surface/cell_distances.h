#pragma once
// Internal: distances to a field of many parts at points that lie near each other.

#include <unordered_map>

#include "sdf/level_set_distance.h"

namespace limn {

/// The field's box is divided into cells, and in each what has no influence there is left out of the field. The same numbers as of the
/// whole field, to the last bit. For one thread; a field of few parts is asked as it is.
class CellDistances {
 public:
  /// `box`: where points mostly lie; not finite: everywhere.
  CellDistances(const Field& field, const Box& box);

  /// As signed_distances() of the field.
  void find(const LanePoints& points, double half_width, LaneNumbers& distances);
  FieldJet jet(const glm::dvec3& point);

 private:
  static constexpr std::uint32_t kWhole = ~std::uint32_t{0};  ///< Outside the box, or of few parts.

  std::uint32_t cell_of(const glm::dvec3& point) const;
  DistanceEvaluator& distance_in(std::uint32_t cell);
  void find_in(std::uint32_t cell, const LanePoints& points, double half_width, LaneNumbers& distances);

  DistanceEvaluator whole_;
  Box box_{};
  glm::ivec3 count_{0};  ///< Of cells along the axes; 0: none.
  double side_ = 0.0;
  std::vector<bool> is_whole_{};                                  ///< Cells that nothing can be left out in, as far as is known.
  std::unordered_map<std::uint32_t, DistanceEvaluator> cells_{};  ///< Those that were asked for.
  TapeScratch scratch_{};                                         ///< That all of them use.
};

}  // namespace limn
