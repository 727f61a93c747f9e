#pragma once
// How wide the bands of ink, the gaps between them and the strips of sheet are beside a border.

#include "raymarch/curves/curve_geometry.h"

namespace limn {

/// The borders of one picture, as what lies beside a sample of these or of another picture's. Widths are px; infinite where nothing lies
/// within `reach_px`.
class BorderBands {
 public:
  explicit BorderBands(const BorderCurves& curves) : silhouettes_(curves, CurveKind::silhouette), all_(curves, {}) {}

  /// How wide the band of ink is that an inner border bounds at a sample: where the other side has none, its borders are off by that much.
  /// At the tips of wedges it goes to nothing.
  double ink_px(const BorderSample& sample, double reach_px) const;
  /// ... and how wide what is clear beside it, up to the next band.
  double clear_px(const BorderSample& sample, double reach_px) const;
  /// How wide the strip of sheet is between a silhouette of the other picture and one here that faces the same way: a fold that only one of
  /// them shows is wrong on that strip alone.
  double fold_px(const BorderSample& sample, double reach_px) const;

 private:
  /// To the next border that faces the other way, if that lies on the `inward` (1) or outward (-1) side.
  double across(const BorderSample& sample, double reach_px, double inward) const;

  CurveIndex silhouettes_, all_;
};

}  // namespace limn
