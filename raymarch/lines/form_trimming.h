#pragma once
// Internal: which stretches of a curve lie on the surface of a body.

#include "raymarch/lines/form_curves.h"

namespace limn {

/// From one parameter to a larger one, which of a closed curve may lie a turn beyond its end.
struct FormArc {
  double from = 0.0, to = 0.0;
  bool closed = false;   ///< The whole of a closed curve.
  bool concave = false;  ///< Of a seam: the body fills more than half of the space around it.
};

/// Between the places where the curve goes through other surfaces than its own, one point says whether it lies on the body's surface.
/// `box` holds all that does.
std::vector<FormArc> trimmed(const FormBody& body, const FormCurve& curve, const Box& box);

}  // namespace limn
