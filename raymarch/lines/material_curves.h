#pragma once
// Internal: lines between materials of one field.

#include "raymarch/lines/found_curves.h"
#include "raymarch/truth/branches.h"
#include "sdf/field_tree.h"

namespace limn {

/// A body with a material on every shape, taken apart at its sharp unions and intersections as curves on it count the branches.
struct MaterialParts {
  Field field;
  SharpField sharp{};
  std::vector<FieldParts> branches{};
  std::vector<int> only{};  ///< Of each branch: its one material, or kSeveralMaterials.
};
inline constexpr int kSeveralMaterials = -2;

/// Nothing where none of the body's objects has materials of its own, or nobody asks for lines between them.
std::optional<MaterialParts> material_parts(const FieldTask& fields);

/// Where two parts of different materials meet on smooth surface: where the values that a blend, or what is below one, takes are equal.
/// Meetings along seams of sharp CSG are those seams (mark_materials).
std::vector<SurfaceCurve> material_curves(const FieldTask& fields, const MaterialParts& parts, const FieldCurveSettings& settings,
                                          const ExecutionSettings& execution, std::vector<FieldCurves>& found);

/// A seam's points, and more of them where on one of its sides one part ends and another of another material begins.
struct MarkedSeam {
  std::vector<CurvePoint> points{};
  std::vector<char> differ{};     ///< Along the step to the next point the parts on the two sides differ in material.
  std::vector<char> line_ends{};  ///< The line between the two parts on one of the sides ends here.
};
MarkedSeam mark_materials(const FieldTask& fields, const MaterialParts& parts, const FieldCurve& seam);

}  // namespace limn
