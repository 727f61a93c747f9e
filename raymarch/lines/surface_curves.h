#pragma once
// Internal: whole curves on surfaces, hidden parts included, as every kind of surface brings them to the view graph.

#include <functional>

#include "raymarch/lines.h"
#include "raymarch/lines/exact_hits.h"

namespace limn {

/// A place within a step where the curve goes through another surface.
struct Piercing {
  double t = 0.0;  ///< Share of the step.
  int layers = 0;  ///< Added to what lies in front, walking along.
  /// Image length along the curve within which rays from beside it may miss the other surface: long where the curve goes through flatly.
  double unclear_px = 0.0;
};

/// A point of a curve on a surface, solver space, and what is true of the step from it to the next.
struct CurveSample {
  glm::dvec3 p{0.0};
  glm::dvec2 px{0.0};
  double depth = 0.0;
  glm::dvec3 high{0.0}, low{0.0};  ///< Unit normals of the sides of higher and lower N.V; the same on smooth surface.
  double radial_curvature = std::numeric_limits<double>::quiet_NaN();
  /// Unit: where a ray to the eye starts beside the surface, so that it meets what lies in front of the curve and not the curve's own
  /// surface. A contour that bends towards the eye has its own material there.
  glm::dvec3 lift{0.0};
  double lift_share = 1.0;                    ///< Of how far rays start off the surface: less beside a nearer line.
  LineClass line_class = LineClass::contour;  ///< Of the step.
  int object = 1;                             ///< Of the step; from 1.
  /// Of the step: how many more sheets of the surface lie on its left in the image than on its right, walking along: 2 and -2 on a fold, 1
  /// and -1 on an open edge, 0 where the surface goes on.
  int more_on_left = 0;
  /// The curve changes its nature here: a contour leads into it, or it becomes a fold.
  bool joint = false;
  std::vector<Piercing> pierced{};  ///< Within the step.
  /// Of a step along a mesh's own edge: its vertices; of one along which two faces go through each other: these. In the mesh's tree.
  std::array<std::uint32_t, 2> edge{kNoIndex, kNoIndex}, faces{kNoIndex, kNoIndex};
  bool on_chord = false;  ///< Between two samples, off the curve by up to the tolerance.
};

/// Of one object's surface, or of two that meet.
struct SurfaceCurve {
  bool closed = false;
  bool smooth = false;  ///< A contour on smooth surface, whose cusps are where its radial curvature is 0.
  std::vector<CurveSample> samples{};
  /// Steps are straight edges of a mesh, or lie in two faces of it: rays start from their middles, and everything about them is exact.
  bool straight = false;
  /// How far two such curves must lie apart, px at their depth, to be told from each other: across the view, and along it.
  double apart_px = 0.03, nearer_px = 0.05;
  double tangency_px = 3.0;  ///< From a place where two curves touch they may run together for so long.
  /// The curve's own point beside a place on a step's chord, where it is known; called from many threads.
  std::function<glm::dvec3(size_t step, double share)> between{};
  bool long_steps = false;  ///< As long as the tolerance allows: between two samples another curve may go anywhere.
};

/// What a ray from a sample towards the eye goes through.
struct LayersSeen {
  int count = 0;
  /// World units to the first of them; infinite where there is none, NaN where that is not known.
  double nearest = std::numeric_limits<double>::quiet_NaN();
};

/// What objects of one kind bring. Functions are called from many threads and own what they need.
struct LineContribution {
  std::vector<SurfaceCurve> curves{};
  /// What of its surfaces lies between the sample, lifted off, and the eye; empty: another contribution counts them.
  std::function<LayersSeen(const CurveSample& sample)> layers_before{};
  /// Points on contours that the sample's ray goes close by; empty where nobody knows.
  std::function<std::vector<glm::dvec3>(const CurveSample& sample)> contours_before{};
  bool exact = true;
  double unrefined_px = 0.0;  ///< What the bound has to grow by.
  std::vector<std::string> notes{};
};

/// What every kind goes by.
struct LineTask {
  const Scene& scene;
  Camera camera{};         ///< Solver space: world axes, origin at the scene's middle.
  glm::dvec3 origin{0.0};  ///< World: solver space's.
  double extent = 1.0;     ///< Radius of the whole scene.
  LineSettings settings{};
  KeptLines& kept;
  /// On contours that rays told of and the search for curves had missed: level sets follow them from there, too.
  std::vector<glm::dvec3> missed{};

  bool wants(LineClass line_class) const;
  /// Of a line along which two surfaces go through each other: an intersection, or where nobody asks for those the edge of their materials.
  LineClass class_of_meeting(int material, int other_material) const;
  int material_of(int object) const { return scene.objects[static_cast<size_t>(object) - 1].material; }
};

LineContribution field_lines(const LineTask& task, const std::vector<size_t>& objects, const ExecutionSettings& execution);
LineContribution cage_lines(const LineTask& task, const std::vector<size_t>& objects, const ExecutionSettings& execution);
LineContribution mesh_lines(const LineTask& task, const std::vector<size_t>& objects, const ExecutionSettings& execution);
LineContribution level_set_lines(const LineTask& task, const std::vector<size_t>& objects, const ExecutionSettings& execution);
/// Suggestive contours, ridges and valleys of all objects; the others count the layers.
LineContribution feature_lines(const LineTask& task, const ExecutionSettings& execution);

/// Suggestive contours, ridges and valleys.
inline bool is_of_curvature(LineClass line_class) {
  return line_class == LineClass::suggestive || line_class == LineClass::ridge || line_class == LineClass::valley;
}

/// Image point and depth of `sample.p`.
void project_sample(const Camera& camera, CurveSample& sample);

}  // namespace limn
