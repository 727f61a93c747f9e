#include "samples/stability/checks/contour_curves.h"

#include "raymarch/scene/curvature.h"
#include "raymarch/truth/field_curves.h"
#include "sdf/error.h"
#include "sdf/shape.h"

namespace limn {

std::vector<WholeContour> whole_contours(const Scene& scene, const Camera& camera, const ExecutionSettings& how) {
  std::vector<Field> fields;
  for (const SceneObject& object : scene.objects) {
    const auto* field = std::get_if<Field>(&object.source);
    if (field == nullptr)
      throw InputError({scene.name, "object", "", "no field whose contours could be followed", "shapes, or a [[reference]] of shapes"});
    fields.push_back(*field);
  }
  const glm::dvec3 origin = bounds(scene).center();
  const Field field = translate(combine(Csg::union_, fields), -origin);
  const Camera local = moved(camera, origin);
  const Viewer viewer = make_viewer(local, glm::dvec3(0.0));
  FieldCurveSettings settings;
  settings.threshold = 0.0;
  FieldEvaluator evaluator(field);
  std::vector<WholeContour> contours;
  for (const FieldCurve& curve : trace_field_curves(field, local, viewer, settings, how).curves) {
    WholeContour contour{curve.closed, {}};
    for (const CurvePoint& point : curve.points) {
      const double curvature = point.crease ? std::numeric_limits<double>::quiet_NaN()
                                            : curvature_along(curvature_of_jet(evaluator.jet(point.p)), view_vector(local, point.p));
      contour.points.push_back({glm::dvec2(project(local, point.p)), curvature});
    }
    contours.push_back(std::move(contour));
  }
  return contours;
}

}  // namespace limn
