// Lines of fields: contours and whole seams traced on bodies, layers counted along rays.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/lines/field_layers.h"
#include "raymarch/lines/form_layers.h"
#include "raymarch/lines/form_tracing.h"
#include "raymarch/lines/seams.h"
#include "raymarch/lines/tips.h"
#include "raymarch/truth/field_bodies.h"
#include "raymarch/truth/field_curves.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

// Curves in closed form lie no farther from their chords than this, as shares of the tolerance.
constexpr double kFormApart = 1.2, kFormNearer = 1.2;
constexpr double kFormTangency_px = 20.0;

struct FieldTask {
  const LineTask& task;
  const FieldBodies& bodies;
  const std::vector<size_t>& body;
  Viewer viewer{};
  std::vector<FieldEvaluator>& evaluators;

  int object_of(const glm::dvec3& p, const glm::dvec3& normal) const {
    return static_cast<int>(bodies.numbers[static_cast<size_t>(object_at(evaluators, body, p, normal, bodies.extent))] + 1);
  }
};

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

/// Where two faces of sharp CSG meet: a crease, or an intersection where they are two objects'.
SurfaceCurve seam_curve(const FieldTask& fields, const FieldCurve& found) {
  Seam seam{found.closed, LineClass::crease, {}};
  for (const CurvePoint& point : found.points) {
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
    const int object = fields.object_of(point.p, one.normal);
    if (object != fields.object_of(point.p, two.normal)) seam.line_class = LineClass::intersection;
    seam.samples.push_back({point.p, {one, two}, object});
  }
  return curve_of_seam(fields.task.camera, seam);
}

void add_notes(const FieldCurves& found, const std::string& name, LineContribution& out) {
  const auto note = [&](std::string text) { out.notes.push_back(fmt::format("{}: {}", name, text)); };
  if (found.cell_px > 6.0)
    note(fmt::format("searched in cells of {:.3g} px (the limit on cells is reached): closed curves within one cell may be missing",
                     found.cell_px));
  if (found.unsettled > 0) note(fmt::format("bounds leave {} places of less than {:.2g} px open", found.unsettled, found.cell_px));
  if (found.rough > 0) note(fmt::format("{} points are known to within a cell of {:.2g} px only", found.rough, found.cell_px));
  if (found.domain_cut) note("is unbounded: its curves are followed in the scene's surroundings only, and its horizon is left out");
}

/// How a body's lines are found, and the layers of it that rays go through.
struct TracedBody {
  std::optional<FormBody> form{};  ///< Where it is made of closed forms.
  bool exact_rays = false;
};

FieldCurveSettings curve_settings(const LineTask& task) {
  FieldCurveSettings settings;
  settings.threshold = task.wants(LineClass::rim) ? task.settings.threshold : 0.0;
  settings.tolerance_px = task.settings.tolerance_px;
  settings.whole_seams = true;
  const double reach = 4.0 * (task.extent + glm::length(task.camera.eye));
  settings.unbounded_domain = {glm::dvec3(-reach), glm::dvec3(reach)};
  return settings;
}

std::vector<SurfaceCurve> converted(const FieldTask& fields, size_t count, const std::function<const FieldCurve&(size_t)>& found) {
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

/// Curves in closed form, whose points are known between samples, too.
std::vector<SurfaceCurve> exact_curves(const FieldTask& fields, std::vector<FormTrace> found, double tolerance_px) {
  const auto traces = std::make_shared<const std::vector<FormTrace>>(std::move(found));
  std::vector<SurfaceCurve> curves = converted(fields, traces->size(), [&](size_t i) -> const FieldCurve& { return (*traces)[i].curve; });
  for (size_t i = 0; i < curves.size(); ++i) {
    SurfaceCurve& curve = curves[i];
    curve.apart_px = kFormApart * tolerance_px;
    curve.nearer_px = kFormNearer * tolerance_px;
    curve.tangency_px = kFormTangency_px;
    curve.long_steps = true;
    // Where a side turns off the samples there are more of them.
    if (curve.samples.size() != (*traces)[i].curve.points.size()) continue;
    curve.between = [traces, i](size_t step, double share) { return point_beside((*traces)[i], step, share); };
  }
  return curves;
}

void append(std::vector<SurfaceCurve>& curves, std::vector<SurfaceCurve> more) {
  curves.insert(curves.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

/// Curves in closed form where there are any, found in cells of space elsewhere.
TracedBody trace_body(const FieldTask& fields, const Field& body, const std::string& name, const ExecutionSettings& execution,
                      LineContribution& out) {
  const LineTask& task = fields.task;
  TracedBody traced;
  const FieldCurveSettings settings = curve_settings(task);
  if (task.settings.closed_forms && settings.threshold == 0.0) traced.form = form_body(body);
  if (traced.form) {
    traced.exact_rays = has_ray_roots(*traced.form);
    if (auto curves = trace_form_curves(*traced.form, task.camera, fields.viewer, settings.tolerance_px, execution)) {
      append(out.curves, exact_curves(fields, std::move(*curves), settings.tolerance_px));
      return traced;
    }
  }
  const FieldCurves found = trace_field_curves(body, task.camera, fields.viewer, settings, execution);
  add_notes(found, name, out);
  out.unrefined_px = std::max(out.unrefined_px, found.worst_unrefined_px);
  std::vector<SurfaceCurve> curves = converted(fields, found.curves.size(), [&](size_t i) -> const FieldCurve& { return found.curves[i]; });
  lead_to_tips(tips_of(body, task.extent), task.camera, curves);
  append(out.curves, std::move(curves));
  return traced;
}

/// Layers of bodies in closed form by their roots, of the others by bounds along the ray.
std::function<LayersSeen(const CurveSample&)> layers_of(const LineTask& task, const std::vector<Field>& bodies,
                                                        std::vector<TracedBody> traced) {
  std::vector<Field> others;
  auto forms = std::make_shared<std::vector<FormBody>>();
  for (size_t i = 0; i < bodies.size(); ++i) {
    if (traced[i].exact_rays) {
      forms->push_back(std::move(*traced[i].form));
    } else {
      others.push_back(bodies[i]);
    }
  }
  const auto layers = std::make_shared<const FieldLayers>(others, task.camera, task.extent);
  return [layers, forms, camera = task.camera, extent = task.extent](const CurveSample& sample) {
    int count = layers->before(sample);
    for (const FormBody& form : *forms) count += layers_before(form, camera, extent, sample);
    return LayersSeen{count};
  };
}

}  // namespace

LineContribution field_lines(const LineTask& task, const std::vector<size_t>& objects, const ExecutionSettings& execution) {
  LineContribution out;
  const FieldBodies bodies = field_bodies(task.scene, objects, task.origin, task.extent);
  std::vector<FieldEvaluator> evaluators;
  for (const Field& field : bodies.fields) evaluators.emplace_back(field);
  std::vector<TracedBody> traced;
  for (size_t i = 0; i < bodies.bodies.size(); ++i) {
    const FieldTask fields{task, bodies, bodies.bodies[i], make_viewer(task.camera, glm::dvec3(0.0)), evaluators};
    traced.push_back(trace_body(fields, bodies.body_fields[i], name_of_body(task.scene, objects, bodies.bodies[i]), execution, out));
    if (execution.progress) execution.progress(0.5 * static_cast<double>(i + 1) / static_cast<double>(bodies.bodies.size()));
  }
  out.layers_before = layers_of(task, bodies.body_fields, std::move(traced));
  return out;
}

}  // namespace limn
