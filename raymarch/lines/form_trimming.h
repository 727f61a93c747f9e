#pragma once
// Internal: which stretches of a curve lie on the surface of a body.

#include "raymarch/gbuffer.h"
#include "raymarch/lines/form_curves.h"

namespace limn {

/// From one parameter to a larger one, which of a closed curve may lie a turn beyond its end.
struct FormArc {
  double from = 0.0, to = 0.0;
  bool closed = false;   ///< The whole of a closed curve.
  bool concave = false;  ///< Of a seam: the body fills more than half of the space around it.
};

/// Between the places where the curve goes through other surfaces than its own, one point says whether it lies on the body's surface.
/// `box` holds all that does, and `tree` is what is undecided in it.
std::vector<FormArc> trimmed(const FormBody& body, const FormCurve& curve, const Box& box, const FormTree& tree);

/// A surface of a body where it may have contours, or two of them and their seams: the same in all views.
struct FormMeeting {
  int first = -1, second = -1;  ///< A contour has no second.
  Box box{};
  FormTree tree{};
  struct TrimmedCurve {
    FormCurve curve{};
    std::vector<FormArc> arcs{};
  };
  std::vector<TrimmedCurve> seams{};
};
struct FormMeetings {
  FormBody body{};
  std::vector<FormMeeting> all{};
  bool known = true;  ///< False where two surfaces meet in a curve without closed form.
};
FormMeetings form_meetings(FormBody body, const ExecutionSettings& execution);

}  // namespace limn
