#pragma once
// Internal: where curves pass behind folds and open edges in the image.

#include <memory>
#include <optional>

#include "raymarch/lines/fold_index.h"

namespace limn {

struct NearerCrossing {
  double at = 0.0;          ///< Place on the curve behind: index of the step plus the share of it.
  int layers = 0;           ///< How many layers it adds to what lies in front of the curve, walking along.
  std::uint32_t curve = 0;  ///< In front.
  double on_nearer = 0.0;   ///< Place on it.
};

/// The folds and open edges of all curves, by their places in the image. Keeps references to what it is made of.
class NearerFolds {
 public:
  NearerFolds(const std::vector<SurfaceCurve>& curves, const Camera& camera);
  ~NearerFolds();
  NearerFolds(const NearerFolds&) = delete;
  NearerFolds& operator=(const NearerFolds&) = delete;

  /// Of each curve, in order along it.
  std::vector<std::vector<NearerCrossing>> crossings() const;
  /// How far the nearest line in front of a place of a curve lies beside it in the image; no more than `reach_px`. A ray that starts a
  /// little beside the curve tells what lies in front of it only where this is more. Where a line is nearer than `enough_px` it may be the
  /// distance of another one that is.
  double clearance_px(const CurveSample& sample, std::uint32_t curve, double place, double reach_px, double enough_px = 0.0) const;
  /// The line in front of a place of a curve that lies nearest beside it in the image, and where on it; nothing within `reach_px`. Its
  /// layers are left 0.
  std::optional<NearerCrossing> nearest(const CurveSample& sample, std::uint32_t curve, double place, double reach_px) const;

 private:
  struct Beside {
    double px = 0.0;
    std::uint32_t fold = 0;  ///< Into the index; kNoFold: none within reach.
  };
  Beside beside(const CurveSample& sample, std::uint32_t curve, double place, double reach_px, double enough_px) const;

  const std::vector<SurfaceCurve>& curves_;
  const Camera& camera_;
  std::unique_ptr<const FoldIndex> index_;
};

/// Of the steps asked for, by curve (0 or 1 each), among each other: those that come so near to a nearer line, or cross it at so flat an
/// angle, that straight steps do not tell where the lines cross; and the nearer line's own.
StepMarks unclear_steps(const std::vector<SurfaceCurve>& curves, const Camera& camera, const StepMarks& asked);

}  // namespace limn
