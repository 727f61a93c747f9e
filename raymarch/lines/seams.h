#pragma once
// Internal: curves along which sheets of surface end or meet, and on which side of them these lie in the image.

#include "raymarch/lines/surface_curves.h"

namespace limn {

/// A sheet that ends on a seam.
struct SeamSide {
  glm::dvec3 normal{0.0};  ///< Unit.
  glm::dvec3 into{0.0};    ///< From the seam along the sheet, any length.
  double facing = 0.0;     ///< N.V
};

/// A point of a seam with its sheets, in the same order all along: one at an open edge, two at a crease.
struct SeamSample {
  glm::dvec3 p{0.0};
  std::vector<SeamSide> sides{};
  int object = 1;
  bool materials_meet = false;  ///< Of the step to the next: two parts of one object meet there that differ in material.
  bool line_ends = false;       ///< A line between materials ends here, on one of the sides.
};

struct Seam {
  bool closed = false;
  LineClass line_class = LineClass::crease;  ///< Where it is no fold.
  std::vector<SeamSample> samples{};
  /// Where parts of different materials meet: of folds, and of what is none.
  LineClass fold_of_materials = LineClass::contour, edge_of_materials = LineClass::crease;
};

/// Where sheets turn from front to back there is a joint; between joints the sheets on either side in the image are counted. Where two and
/// more lie all on one side the seam is a fold, of class contour.
SurfaceCurve curve_of_seam(const Camera& camera, const Seam& seam);

/// Of a contour on smooth surface: both sheets lie on the same side of it all along, across cusps too.
void set_fold(const Camera& camera, SurfaceCurve& curve);

}  // namespace limn
