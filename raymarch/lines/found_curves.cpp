#include "raymarch/lines/found_curves.h"

#include "raymarch/lines/material_curves.h"
#include "raymarch/lines/seams.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

CurveSample sample_of(const FieldTask& fields, const CurvePoint& point) {
  CurveSample sample;
  sample.p = point.p;
  sample.high = point.high;
  sample.low = point.low;
  if (!point.crease) sample.radial_curvature = point.radial_curvature;
  project_sample(fields.task.camera, sample);
  return sample;
}

/// A contour on smooth surface, or the level curve of the rim.
SurfaceCurve smooth_curve(const FieldTask& fields, const FieldCurve& found) {
  SurfaceCurve curve{found.closed, found.c == 0.0, {}};
  curve.samples.reserve(found.points.size());
  for (const CurvePoint& point : found.points) {
    CurveSample sample = sample_of(fields, point);
    const glm::dvec3 v = fields.viewer.toward_eye(sample.p);
    sample.line_class = found.c == 0.0 ? LineClass::contour : LineClass::rim;
    sample.lift = found.c != 0.0 || point.crease ? v : sample.radial_curvature < 0.0 ? -sample.high : sample.high;
    sample.object = fields.object_of(sample.p, sample.low);
    curve.samples.push_back(sample);
  }
  if (curve.smooth) set_fold(fields.task.camera, curve);
  return curve;
}

/// Where two faces of sharp CSG meet: a crease; where they are two objects' an intersection, or an edge of materials.
SurfaceCurve seam_curve(const FieldTask& fields, const FieldCurve& found) {
  Seam seam{found.closed, LineClass::crease, {}};
  const MarkedSeam marked = fields.parts != nullptr ? mark_materials(fields, *fields.parts, found) : MarkedSeam{};
  const std::vector<CurvePoint>& points = fields.parts != nullptr ? marked.points : found.points;
  for (size_t i = 0; i < points.size(); ++i) {
    const CurvePoint& point = points[i];
    const glm::dvec3 v = fields.viewer.toward_eye(point.p);
    // From the seam a face goes on to where the other one is outside, or inside, of the body.
    const double way = found.concave ? 1.0 : -1.0, cosine = glm::dot(point.high, point.low);
    SeamSide one{point.high, way * (point.low - cosine * point.high), glm::dot(point.high, v)};
    SeamSide two{point.low, way * (point.high - cosine * point.low), glm::dot(point.low, v)};
    // Faces keep their order all along, whichever has the higher N.V.
    if (!seam.samples.empty()) {
      const std::vector<SeamSide>& before = seam.samples.back().sides;
      const double kept = glm::dot(before[0].normal, one.normal) + glm::dot(before[1].normal, two.normal);
      const double swapped = glm::dot(before[0].normal, two.normal) + glm::dot(before[1].normal, one.normal);
      if (swapped > kept) std::swap(one, two);
    }
    const int object = fields.object_of(point.p, one.normal), other = fields.object_of(point.p, two.normal);
    if (object != other) {
      // Of objects with parts these say which materials meet.
      seam.line_class = fields.parts != nullptr
                            ? LineClass::intersection
                            : fields.task.class_of_meeting(fields.task.material_of(object), fields.task.material_of(other));
    }
    seam.samples.push_back(
        {point.p, {one, two}, object, fields.parts != nullptr && marked.differ[i], fields.parts != nullptr && marked.line_ends[i]});
  }
  const auto class_or_material = [&](LineClass drawn) { return fields.task.wants(drawn) ? drawn : LineClass::material; };
  seam.fold_of_materials = class_or_material(LineClass::contour);
  seam.edge_of_materials = class_or_material(seam.line_class);
  return curve_of_seam(fields.task.camera, seam);
}

}  // namespace

std::vector<SurfaceCurve> surface_curves(const FieldTask& fields, size_t count, const std::function<const FieldCurve&(size_t)>& found) {
  std::vector<SurfaceCurve> curves(count);
  const auto convert = [&](size_t i) { curves[i] = found(i).seam ? seam_curve(fields, found(i)) : smooth_curve(fields, found(i)); };
  // Which of several objects a point lies on their evaluators say, one after the other.
  if (fields.body.size() == 1) {
    parallel_for(size_t{0}, count, convert);
  } else {
    for (size_t i = 0; i < count; ++i) convert(i);
  }
  return curves;
}

}  // namespace limn
