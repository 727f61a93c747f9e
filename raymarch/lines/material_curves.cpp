#include "raymarch/lines/material_curves.h"

#include <algorithm>

#include "sdf/shape.h"

namespace limn {
namespace {

constexpr int kCuts = 60;
constexpr double kBracket = 1e-11;  // of the extent, to which ends and turns are bracketed
constexpr double kBeside =
    1e-9;  // of the extent: so far off a seam its sides are asked for their parts, where these have the same values on it
constexpr double kOnSeam = 1e-8;  // of the extent: what nowhere leaves a seam by more is that seam

/// Of each node: the material of all shapes below it, or kSeveralMaterials.
std::vector<int> materials_below(const FieldParts& parts) {
  std::vector<int> result;
  for (const FieldNode& node : parts.tree()) {
    if (node.left < 0) {
      result.push_back(parts.leaf(node.instruction.leaf).material);
      continue;
    }
    const int one = result[static_cast<size_t>(node.left)], other = node.right < 0 ? one : result[static_cast<size_t>(node.right)];
    result.push_back(one == other ? one : kSeveralMaterials);
  }
  return result;
}

/// One line between the two sides of a node, on one branch of a body.
class Meeting {
 public:
  Meeting(const FieldTask& fields, const Field& branch, const FieldParts& parts, int node, const Field& zeros)
      : fields_(fields), branch_(branch), zeros_(zeros), parts_(parts), node_(node) {}

  /// The stretches of a curve of equal values along which the surface belongs to the node and its two sides differ in material.
  void add_stretches(const FieldCurve& found, std::vector<SurfaceCurve>& curves) {
    const size_t n = found.points.size();
    std::vector<char> on(n);
    for (size_t i = 0; i < n; ++i) on[i] = separates(found.points[i].p);
    const auto off = std::find(on.begin(), on.end(), 0);
    const bool whole = off == on.end();
    const size_t first = found.closed && !whole ? static_cast<size_t>(off - on.begin()) : 0;
    std::vector<glm::dvec3> run;
    const auto finish = [&](bool closed) {
      if (run.size() > (closed ? 2u : 1u)) curves.push_back(curve_of(run, closed));
      run.clear();
    };
    for (size_t k = 0; k < n; ++k) {
      const size_t i = (first + k) % n, next = (i + 1) % n;
      if (on[i]) run.push_back(found.points[i].p);
      if (k + 1 == n && !found.closed) break;
      if (on[i] == on[next]) continue;
      const glm::dvec3 end =
          bisect(found.points[on[i] ? i : next].p, found.points[on[i] ? next : i].p, [&](const glm::dvec3& p) { return separates(p); });
      run.push_back(end);
      if (on[i]) finish(false);
    }
    finish(found.closed && whole);
  }

 private:
  bool separates(const glm::dvec3& p) {
    parts_.look(p, place_);
    const FieldNode& node = parts_.tree()[static_cast<size_t>(node_)];
    const auto material = [&](int child) { return parts_.leaf(place_.owners[static_cast<size_t>(child)]).material; };
    return parts_.ownership(place_, node_) > 0.0 && material(node.left) != material(node.right);
  }

  /// The last point of the line for which `holds`, on the way from one for which it does to one for which it does not.
  template <class Holds>
  glm::dvec3 bisect(glm::dvec3 yes, glm::dvec3 no, const Holds& holds) {
    for (int cut = 0; cut < kCuts && glm::distance(yes, no) > kBracket * fields_.task.extent; ++cut) {
      const glm::dvec3 middle = 0.5 * (yes + no);
      const auto point = polish_seam(branch_, zeros_, middle, 0.5 * glm::distance(yes, no));
      const glm::dvec3 p = point ? point->p : middle;
      (holds(p) ? yes : no) = p;
    }
    return yes;
  }

  bool faces_eye(const glm::dvec3& p) { return sample_surface(branch_, fields_.viewer, p).facing > 0.0; }

  CurveSample sample_of(const glm::dvec3& p) {
    CurveSample sample;
    const FieldJet jet = branch_.jet(p);
    const double length = glm::length(jet.gradient);
    const glm::dvec3 v = fields_.viewer.toward_eye(p), n = jet.gradient / length, w = v - glm::dot(n, v) * n;
    sample.p = p;
    sample.high = sample.low = n;
    sample.radial_curvature = glm::dot(w, jet.hessian * w) / (length * glm::dot(w, w));
    sample.lift = v;
    sample.line_class = LineClass::material;
    sample.object = fields_.object_of(p, n);
    project_sample(fields_.task.camera, sample);
    return sample;
  }

  /// Past its own contour a line has a layer more in front: the curve gets a joint there.
  SurfaceCurve curve_of(const std::vector<glm::dvec3>& points, bool closed) {
    SurfaceCurve curve{closed, false, {}};
    const size_t n = points.size();
    for (size_t i = 0; i < n; ++i) {
      curve.samples.push_back(sample_of(points[i]));
      if (i + 1 == n && !closed) break;
      const glm::dvec3& next = points[(i + 1) % n];
      const bool front = faces_eye(points[i]);
      if (front == faces_eye(next)) continue;
      curve.samples.push_back(sample_of(bisect(points[i], next, [&](const glm::dvec3& p) { return faces_eye(p) == front; })));
      curve.samples.back().joint = true;
    }
    const auto same = [](const CurveSample& a, const CurveSample& b) { return a.p == b.p; };
    // A turn at a sample is that sample's.
    for (size_t i = 0; i + 1 < curve.samples.size(); ++i) {
      if (same(curve.samples[i], curve.samples[i + 1])) curve.samples[i].joint |= curve.samples[i + 1].joint;
    }
    curve.samples.erase(std::unique(curve.samples.begin(), curve.samples.end(), same), curve.samples.end());
    return curve;
  }

  const FieldTask& fields_;
  FieldEvaluator branch_, zeros_;
  const FieldParts& parts_;
  FieldParts::Place place_{};
  int node_;
};

/// A seam and the parts on its two sides.
class SeamSides {
 public:
  SeamSides(const FieldTask& fields, const MaterialParts& parts, const FieldCurve& seam)
      : first_(branch(parts, seam.first)),
        second_(branch(parts, seam.second)),
        first_parts_(parts.branches[static_cast<size_t>(seam.first)]),
        second_parts_(parts.branches[static_cast<size_t>(seam.second)]),
        way_(seam.concave ? 1.0 : -1.0),
        extent_(fields.task.extent) {}

  /// Materials of the two sides.
  using Pair = std::pair<int, int>;
  Pair materials(const glm::dvec3& p) {
    const glm::dvec3 n = normal(first_, p), m = normal(second_, p);
    const double cosine = glm::dot(n, m);
    return {material_at(first_parts_, p, way_ * (m - cosine * n)), material_at(second_parts_, p, way_ * (n - cosine * m))};
  }

  struct Change {
    CurvePoint point{};
    Pair materials{};  ///< From it on.
  };
  /// Where on the way from `a` to `b` one of the sides changes, in order.
  std::vector<Change> changes_between(const glm::dvec3& a, const Pair& at_a, glm::dvec3 b, Pair at_b) {
    std::vector<Change> changes;
    while (at_a != at_b) {
      // From the last one back.
      glm::dvec3 before = a, after = b;
      Pair at_before = at_a;
      for (int cut = 0; cut < kCuts && glm::distance(before, after) > kBracket * extent_; ++cut) {
        const glm::dvec3 middle = 0.5 * (before + after);
        const auto point = polish_seam(first_, second_, middle, 0.5 * glm::distance(before, after));
        const glm::dvec3 p = point ? point->p : middle;
        const Pair here = materials(p);
        if (here == at_b) {
          after = p;
        } else {
          before = p;
          at_before = here;
        }
      }
      changes.push_back({seam_point(after), at_b});
      b = before;
      at_b = at_before;
    }
    std::reverse(changes.begin(), changes.end());
    return changes;
  }

 private:
  static const Field& branch(const MaterialParts& parts, int number) { return parts.sharp.branches[static_cast<size_t>(number)]; }
  static glm::dvec3 normal(FieldEvaluator& evaluator, const glm::dvec3& p) { return glm::normalize(evaluator.jet(p).gradient); }

  CurvePoint seam_point(const glm::dvec3& p) {
    CurvePoint point;
    point.p = p;
    point.high = normal(first_, p);
    point.low = normal(second_, p);
    point.crease = true;
    return point;
  }
  int material_at(const FieldParts& parts, const glm::dvec3& p, const glm::dvec3& into) {
    const double length = glm::length(into);
    return parts.leaf(parts.owner(length > 0.0 ? p + kBeside * extent_ / length * into : p, place_)).material;
  }

  FieldEvaluator first_, second_;
  const FieldParts &first_parts_, &second_parts_;
  double way_, extent_;
  FieldParts::Place place_{};
};

/// The curve runs along the seam of its branch with another one.
bool is_seam(const MaterialParts& parts, size_t branch, const FieldCurve& found, double extent) {
  for (size_t other = 0; other < parts.sharp.branches.size(); ++other) {
    if (other == branch) continue;
    FieldEvaluator evaluator(parts.sharp.branches[other]);
    const auto on_it = [&](const CurvePoint& point) { return std::fabs(evaluator.value(point.p)) < kOnSeam * extent; };
    if (std::all_of(found.points.begin(), found.points.end(), on_it)) return true;
  }
  return false;
}

}  // namespace

std::optional<MaterialParts> material_parts(const FieldTask& fields) {
  if (!fields.task.wants(LineClass::material)) return {};
  bool any = false;
  std::vector<Field> of_objects;
  for (const size_t place : fields.body) {
    const SceneObject& object = fields.task.scene.objects[fields.bodies.numbers[place]];
    any |= has_materials(std::get<Field>(object.source));
    of_objects.push_back(with_material(fields.bodies.fields[place], object.material, {}));
  }
  if (!any) return {};
  MaterialParts parts{combine(Csg::union_, of_objects)};
  const Box& bounds = parts.field.traits().bounds;
  parts.sharp = split_branches(parts.field, bounds.finite() ? bounds.radius() : fields.task.extent, true);
  for (const Field& branch : parts.sharp.branches) {
    parts.branches.emplace_back(branch);
    parts.only.push_back(materials_below(parts.branches.back()).back());
  }
  return parts;
}

std::vector<SurfaceCurve> material_curves(const FieldTask& fields, const MaterialParts& parts, const FieldCurveSettings& settings,
                                          const ExecutionSettings& execution, std::vector<FieldCurves>& found) {
  std::vector<SurfaceCurve> curves;
  for (size_t b = 0; b < parts.branches.size(); ++b) {
    if (parts.only[b] != kSeveralMaterials) continue;
    const Field& branch = parts.sharp.branches[b];
    const FieldParts& of_branch = parts.branches[b];
    const std::vector<int> below = materials_below(of_branch);
    for (size_t i = 0; i < below.size(); ++i) {
      const FieldNode& node = of_branch.tree()[i];
      if (below[i] != kSeveralMaterials || node.right < 0) continue;
      const Field zeros = difference_of_values(subtree(branch, of_branch.tree(), node.left), subtree(branch, of_branch.tree(), node.right));
      found.push_back(trace_zeros_on_branch(parts.field, cut_by(parts.sharp, zeros), static_cast<int>(b), fields.task.camera, fields.viewer,
                                            settings, execution));
      Meeting meeting(fields, branch, of_branch, static_cast<int>(i), zeros);
      for (const FieldCurve& curve : found.back().curves) {
        if (!is_seam(parts, b, curve, fields.task.extent)) meeting.add_stretches(curve, curves);
      }
    }
  }
  return curves;
}

MarkedSeam mark_materials(const FieldTask& fields, const MaterialParts& parts, const FieldCurve& seam) {
  const size_t n = seam.points.size();
  const int one = parts.only[static_cast<size_t>(seam.first)], other = parts.only[static_cast<size_t>(seam.second)];
  if (one != kSeveralMaterials && other != kSeveralMaterials)
    return {seam.points, std::vector<char>(n, one != other), std::vector<char>(n, 0)};
  SeamSides sides(fields, parts, seam);
  std::vector<SeamSides::Pair> materials;
  for (const CurvePoint& point : seam.points) materials.push_back(sides.materials(point.p));
  MarkedSeam marked;
  const auto add = [&marked](const CurvePoint& point, const SeamSides::Pair& from, bool line_ends) {
    marked.points.push_back(point);
    marked.differ.push_back(from.first != from.second);
    marked.line_ends.push_back(line_ends);
  };
  for (size_t i = 0; i < n; ++i) {
    add(seam.points[i], materials[i], false);
    const size_t next = (i + 1) % n;
    if (next == 0 && !seam.closed) break;
    for (const auto& change : sides.changes_between(seam.points[i].p, materials[i], seam.points[next].p, materials[next])) {
      if (change.point.p != seam.points[next].p) add(change.point, change.materials, true);
    }
  }
  return marked;
}

}  // namespace limn
