// Lines of fields: contours and whole seams traced on bodies, layers counted along rays.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/lines/field_layers.h"
#include "raymarch/lines/form_layers.h"
#include "raymarch/lines/form_tracing.h"
#include "raymarch/lines/found_curves.h"
#include "raymarch/lines/line_memory.h"
#include "raymarch/lines/material_curves.h"
#include "raymarch/lines/tips.h"

namespace limn {
namespace {

// Curves in closed form lie no farther from their chords than this, as shares of the tolerance.
constexpr double kFormApart = 1.2, kFormNearer = 1.2;
constexpr double kFormTangency_px = 20.0;
constexpr double kSamePoint = 1e-9;  // of the extent

void add_notes(const FieldCurves& found, const std::string& name, LineContribution& out) {
  const auto note = [&](std::string text) { out.notes.push_back(fmt::format("{}: {}", name, text)); };
  if (found.cell_px > 6.0)
    note(fmt::format("searched in cells of {:.3g} px (the limit on cells is reached): closed curves within one cell may be missing",
                     found.cell_px));
  if (found.unsettled > 0) note(fmt::format("bounds leave {} places of less than {:.2g} px open", found.unsettled, found.cell_px));
  if (found.broken > 0)
    note(fmt::format("{} places hold two arms of a curve within {:.2g} px, which may be joined too early", found.broken, found.cell_px));
  if (found.rough > 0) note(fmt::format("{} points are known to within a cell of {:.2g} px only", found.rough, found.cell_px));
  if (found.domain_cut) note("is unbounded: its curves are followed in the scene's surroundings only, and its horizon is left out");
}

/// How a body's lines are found, and the layers of it that rays go through.
struct TracedBody {
  std::shared_ptr<const FormMeetings> form{};  ///< Where it is made of closed forms.
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

/// The trace by the samples of its curve: where a side of a seam turns between two points of the trace there is one more, brought from the
/// chord onto the curve here.
FormTrace by_samples(const FormTrace& trace, const Camera& camera, double extent, SurfaceCurve& curve) {
  FormTrace result{{}, trace.form, {}};
  const std::vector<CurvePoint>& points = trace.curve.points;
  size_t next = 0;
  for (CurveSample& sample : curve.samples) {
    if (next < points.size() && glm::distance(sample.p, points[next].p) < kSamePoint * extent) {
      result.parameters.push_back(trace.parameters[next++]);
      continue;
    }
    const glm::dvec3 before = points[next - 1].p, chord = points[next % points.size()].p - before;
    const double share = std::clamp(glm::dot(sample.p - before, chord) / glm::dot(chord, chord), 0.0, 1.0);
    result.parameters.push_back(parameter_beside(trace, next - 1, share));
    sample.p = point_at(trace, result.parameters.back());
    project_sample(camera, sample);
  }
  if (curve.closed) result.parameters.push_back(trace.parameters.back());
  return result;
}

/// Curves in closed form, whose points are known between samples, too.
std::vector<SurfaceCurve> exact_curves(const FieldTask& fields, const std::vector<FormTrace>& found, double tolerance_px) {
  std::vector<SurfaceCurve> curves = surface_curves(fields, found.size(), [&](size_t i) -> const FieldCurve& { return found[i].curve; });
  const auto traces = std::make_shared<std::vector<FormTrace>>(curves.size());
  for (size_t i = 0; i < curves.size(); ++i) {
    SurfaceCurve& curve = curves[i];
    curve.apart_px = kFormApart * tolerance_px;
    curve.nearer_px = kFormNearer * tolerance_px;
    curve.tangency_px = kFormTangency_px;
    curve.long_steps = true;
    (*traces)[i] = by_samples(found[i], fields.task.camera, fields.task.extent, curve);
    curve.between = [traces, i](size_t step, double share) { return point_beside((*traces)[i], step, share); };
  }
  return curves;
}

void append(std::vector<SurfaceCurve>& curves, std::vector<SurfaceCurve> more) {
  curves.insert(curves.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

std::shared_ptr<const FormMeetings> kept_forms(KeptLines& kept, size_t number, const Field& body, const ExecutionSettings& execution) {
  const auto known = kept.forms.find(number);
  if (known != kept.forms.end()) return known->second;
  std::optional<FormBody> form = form_body(body);
  std::shared_ptr<const FormMeetings> made;
  if (form) made = std::make_shared<const FormMeetings>(form_meetings(std::move(*form), execution));
  return kept.forms[number] = made;
}

/// Curves in closed form where there are any, found in cells of space elsewhere.
TracedBody trace_body(const FieldTask& fields, size_t number, const Field& body, const std::string& name,
                      const ExecutionSettings& execution, LineContribution& out) {
  const LineTask& task = fields.task;
  TracedBody traced;
  FieldCurveSettings settings = curve_settings(task);
  settings.memory = [&kept = task.kept.fields, number](int level) { return &kept[{number, level}]; };
  if (task.settings.closed_forms && settings.threshold == 0.0) traced.form = kept_forms(task.kept, number, body, execution);
  if (traced.form) {
    traced.exact_rays = has_ray_roots(traced.form->body);
    if (auto curves = trace_form_curves(*traced.form, task.camera, fields.viewer, settings.tolerance_px, execution)) {
      append(out.curves, exact_curves(fields, *curves, settings.tolerance_px));
      return traced;
    }
  }
  const FieldCurves found = trace_field_curves(body, task.camera, fields.viewer, settings, execution);
  add_notes(found, name, out);
  out.unrefined_px = std::max(out.unrefined_px, found.worst_unrefined_px);
  std::vector<SurfaceCurve> curves =
      surface_curves(fields, found.curves.size(), [&](size_t i) -> const FieldCurve& { return found.curves[i]; });
  lead_to_tips(tips_of(body, task.extent), task.camera, curves);
  append(out.curves, std::move(curves));
  return traced;
}

void add_material_curves(const FieldTask& fields, const std::string& name, const ExecutionSettings& execution, LineContribution& out) {
  std::vector<FieldCurves> found;
  append(out.curves, material_curves(fields, *fields.parts, curve_settings(fields.task), execution, found));
  for (const FieldCurves& curves : found) {
    add_notes(curves, name + ", between materials", out);
    out.unrefined_px = std::max(out.unrefined_px, curves.worst_unrefined_px);
  }
}

/// Layers of bodies in closed form by their roots, of the others by bounds along the ray.
std::function<LayersSeen(const CurveSample&)> layers_of(const LineTask& task, const std::vector<Field>& bodies,
                                                        const std::vector<TracedBody>& traced) {
  std::vector<Field> others;
  std::vector<std::shared_ptr<const FormMeetings>> forms;
  for (size_t i = 0; i < bodies.size(); ++i) {
    if (traced[i].exact_rays) {
      forms.push_back(traced[i].form);
    } else {
      others.push_back(bodies[i]);
    }
  }
  const auto layers = std::make_shared<const FieldLayers>(others, task.camera, task.extent);
  return [layers, forms, camera = task.camera, extent = task.extent](const CurveSample& sample) {
    int count = layers->before(sample);
    for (const auto& form : forms) count += layers_before(form->body, camera, extent, sample);
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
    FieldTask fields{task, bodies, bodies.bodies[i], make_viewer(task.camera, glm::dvec3(0.0)), evaluators};
    const std::optional<MaterialParts> parts = material_parts(fields);
    if (parts) fields.parts = &*parts;
    const std::string name = name_of_body(task.scene, objects, bodies.bodies[i]);
    traced.push_back(trace_body(fields, i, bodies.body_fields[i], name, execution, out));
    if (parts) add_material_curves(fields, name, execution, out);
    if (execution.progress) execution.progress(0.5 * static_cast<double>(i + 1) / static_cast<double>(bodies.bodies.size()));
  }
  out.layers_before = layers_of(task, bodies.body_fields, traced);
  return out;
}

}  // namespace limn
