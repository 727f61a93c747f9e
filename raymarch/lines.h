#pragma once
// The lines of a scene as vectors: contour generators split by occlusion, boundaries, creases, intersections, joined into a view graph
// whose edges know how many layers of surface lie in front of them, and a certificate that the graph agrees with itself and with rays.

#include <memory>
#include <string>
#include <vector>

#include "raymarch/gbuffer.h"
#include "raymarch/scene.h"
#include "sdf/registry.h"

namespace limn {

/// What a line is. Creases and boundaries behind which the surface turns away count as contours: there the object ends in the picture.
enum class LineClass : std::uint8_t {
  contour,       ///< N.V changes sign: the contour generator.
  boundary,      ///< An open edge of a surface.
  crease,        ///< Two normals of one object meet at an angle.
  intersection,  ///< Two objects pass through each other.
  material,      ///< Two materials meet, where no class asked for comes before: parts of a field, faces of a mesh, objects (intersection).
  rim,           ///< N.V = threshold, the inner border of the rim.
  suggestive,    ///< Radial curvature 0, growing towards the eye: a contour of views nearby (DeCarlo et al. 2003).
  ridge,         ///< Extremal principal curvature, where the surface bends away from its normal (Ohtake et al. 2004).
  valley,        ///< The same where it bends towards its normal.
};

/// A class of lines, for lists and options.
struct LineClassDescriptor {
  Description about{};                        ///< Name, help and source.
  LineClass line_class = LineClass::contour;  ///< See LineClass.
  bool by_default = true;                     ///< Drawn where nobody says which.
};
/// All classes, in the order in which they are painted.
const Registry<LineClassDescriptor>& line_classes();
/// As in line_classes(): "contour".
const std::string& name_of(LineClass line_class);

/// About so many bytes each triangle of a mesh takes with LineSettings::smooth_meshes.
inline constexpr std::int64_t kSmoothBytes = 5000;

/// Which lines are solved, and how precisely.
struct LineSettings {
  std::vector<LineClass> classes{};  ///< Empty: those drawn by default.
  double threshold = 0.4;            ///< Of the rim, above 0 and below 1; read where LineClass::rim is asked for.
  double crease_angle_deg = 40.0;    ///< Edges of meshes are creases where their faces' normals differ by more. In (0, 180).
  /// Of meshes that are no cages the lines are those of the smooth surface through their vertices, sharp along creases and open edges
  /// (subdiv/interpolating_cage.h). InputError where their triangles take more than `max_bytes`, by kSmoothBytes.
  bool smooth_meshes = false;
  /// Waves of such meshes, as short as this, are smoothed away first, so that the noise of scans draws no lines (subdiv/fair_mesh.h): with
  /// smooth_meshes of what is drawn, else of what the curvature of suggestive contours, ridges and valleys is taken from. In mean edges;
  /// 0 (none), or up to 1000. InputError where neither is asked for.
  double fairing_edges = 0.0;
  double suggestive_angle_deg = 20.0;  ///< Suggestive contours: least angle between normal and view. In [0, 90).
  /// Suggestive contours: least derivative of the radial curvature along the view's tangential part, times the object's radius squared.
  /// From 0 up. A line goes on down to half of it.
  double suggestive_slope = 2.0;
  /// Ridges and valleys: least principal curvature, times the object's radius. Above 0. A line goes on down to half of it.
  double ridge_strength = 4.0;
  double tolerance_px = 0.005;                     ///< How far the polylines may lie from the curves.
  std::int64_t max_bytes = std::int64_t{4} << 30;  ///< For the meshes that rays are cast against, and for smooth_meshes.
  /// Sharp CSG of quadrics and tori by closed forms. Off: searched for in cells of space, as all other fields are.
  bool closed_forms = true;
};

/// A point of a line.
struct LinePoint {
  glm::dvec2 px{0.0};             ///< Image point (sdf/image.h).
  double depth = 0.0;             ///< Z, world units.
  glm::dvec3 position{0.0};       ///< World.
  glm::dvec3 normal{0.0};         ///< World, unit; at a crease that of the side of higher N.V.
  double radial_curvature = 0.0;  ///< 1 / world unit; NaN on creases and boundaries.
};

/// What happens at a vertex of the view graph.
enum class VertexKind : std::uint8_t {
  crossing,  ///< T-junction: a nearer contour or boundary crosses the line in the image.
  cusp,      ///< The radial curvature is 0: the line of sight follows the contour generator.
  joint,     ///< Several curves of the surface meet: a contour ends on a crease, creases meet at a corner.
  end,       ///< The curve ends, with nothing found that it leads into.
  frame,     ///< The picture's frame.
};
/// As it is written into files: "crossing".
const char* name_of(VertexKind kind);

/// Of the view graph.
struct LineVertex {
  VertexKind kind = VertexKind::end;  ///< See VertexKind.
  glm::dvec2 px{0.0};                 ///< Image point.
  double depth = 0.0;                 ///< Z of the line that is crossed, world units.
  int crossed_by = -1;                ///< Of a crossing: the edge in front of it, index into ViewGraph::edges; -1 where it was cut away.
};

/// A stretch of line along which its class and its quantitative invisibility stay the same.
struct LineEdge {
  LineClass line_class = LineClass::contour;  ///< See LineClass.
  int object = 1;                             ///< Index from 1.
  int invisibility = 0;                       ///< How many layers of surface lie in front of it (Appel 1967).
  bool certain = true;                        ///< False where the certificate found a conflict along it.
  bool crease = false;                        ///< Runs along a sharp edge, whatever its class.
  int curve = 0;                              ///< Which curve on the surface it is a piece of; from 0.
  int begin = -1,                             ///< Index into ViewGraph::vertices; -1: closed, and without a vertex.
      end = -1;                               ///< The same, of its end.
  /// At least two. Of contours and boundaries what they bound lies on the left, walking along (border_curves.h).
  std::vector<LinePoint> points{};
};

/// One of a chain's edges.
struct ChainLink {
  int edge = 0;           ///< Index into ViewGraph::edges.
  bool reversed = false;  ///< The chain runs along it from end to begin.
};
/// The longest stroke of one class and invisibility: edges joined through the vertices that do not change it.
struct LineChain {
  LineClass line_class = LineClass::contour;  ///< See LineClass.
  int object = 1;                             ///< Of its first edge.
  int invisibility = 0;                       ///< 0: visible.
  bool closed = false;                        ///< The last edge ends where the first begins.
  std::vector<ChainLink> links{};             ///< At least one, in order.
};

/// A place where the graph disagrees with itself or with a ray.
struct LineConflict {
  std::string what{};  ///< In words.
  glm::dvec2 px{0.0};  ///< Image point.
};

/// The lines of one view, hidden ones included, within the picture.
struct ViewGraph {
  std::vector<LineVertex> vertices{};     ///< Where edges end.
  std::vector<LineEdge> edges{};          ///< In an order that does not depend on threads.
  std::vector<LineChain> chains{};        ///< All edges are in one chain each.
  std::vector<LineConflict> conflicts{};  ///< Empty: the certificate holds.
  std::int64_t rays = 0;                  ///< That were cast for the certificate.
  bool exact = true;                      ///< False where a part of the scene is left out or approximated: `notes`.
  double bound_px = 0.0;                  ///< No point lies farther from its line than this.
  std::string from{};                     ///< What it was solved on, in words: "the field".
  std::vector<std::string> notes{};       ///< What the bound does not cover.
};

struct KeptLines;  // raymarch/lines/line_memory.h
/// What views of one scene share (refined cages, trees of triangles), so that the next takes less time; the lines are the same without it.
/// For one scene, one setting of smooth_meshes, fairing_edges and crease_angle_deg, and one call at a time. Empty at first.
struct LineMemory {
  std::shared_ptr<KeptLines> kept{};  ///< Made by the first call.
};

/// Throws InputError for settings outside their ranges. Cancelled as elsewhere. `memory` may be null.
ViewGraph solve_lines(const Scene& scene, const Camera& camera, const LineSettings& settings, const ExecutionSettings& execution,
                      LineMemory* memory = nullptr);

/// The points of a chain in order, each once; a closed one's first is not repeated. Where two of its edges end beside each other at their
/// vertex, both ends are there.
std::vector<LinePoint> points_of(const ViewGraph& graph, const LineChain& chain);

}  // namespace limn
