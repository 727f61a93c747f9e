#pragma once
// Internal: contours and seams of a body in closed form, sampled as the view graph needs them.

#include "raymarch/lines/form_trimming.h"
#include "raymarch/truth/field_curves.h"

namespace limn {

struct FormTrace {
  FieldCurve curve{};
  FormCurve form{};
  std::vector<double> parameters{};  ///< Of the curve's points; of a closed one that of the first again, a turn later.
};
glm::dvec3 point_at(const FormTrace& trace, double parameter);
/// Of the point of the curve that lies beside a place on the chord of a step.
double parameter_beside(const FormTrace& trace, size_t step, double share);
/// That point.
glm::dvec3 point_beside(const FormTrace& trace, size_t step, double share);

/// As trace_field_curves() finds them with whole seams and no level but 0; nothing where two surfaces of the body meet in a curve without
/// closed form, or touch along one.
std::optional<std::vector<FormTrace>> trace_form_curves(const FormMeetings& meetings, const Camera& camera, const Viewer& viewer,
                                                        double tolerance_px, const ExecutionSettings& execution);

}  // namespace limn
