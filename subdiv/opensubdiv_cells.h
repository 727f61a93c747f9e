#pragma once
// Faces whose neighbours OpenSubdiv's Bfr cannot gather, cut into the faces that subdivision makes of them until it can. Included by this
// folder's .cpp files only.

#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/far/topologyRefiner.h>

#include <array>
#include <memory>
#include <vector>

#include "subdiv/refine.h"

namespace limn {

namespace Bfr = OpenSubdiv::Bfr;
namespace Far = OpenSubdiv::Far;

/// A surface of Bfr with its points. Its factory and refiner are needed no longer.
struct BfrPatch {
  Bfr::Surface<double> surface{};
  std::vector<double> points{};
};
/// Bfr's surface of one face of a refiner's base level; not valid where it has none.
BfrPatch make_patch(const Bfr::RefinerSurfaceFactory<>& factory, int face, const std::vector<glm::dvec3>& positions);
/// How finely all surfaces approximate extraordinary vertices and semi-sharp features.
Bfr::SurfaceFactory::Options patch_options();
/// Position and derivatives by the patch's own coordinates.
void evaluate_patch(const BfrPatch& patch, Scheme scheme, double u, double v, LimitOrder order, LimitPoint& out);

/// Bfr gathers a face's neighbours corner by corner, and overruns its buffers where one neighbour is met again at a corner that is not
/// the next (two faces that share two edges, tubes of fewer than three faces) or where an edge has more than two faces.
bool simple_neighbourhood(const Far::TopologyLevel& level, int face);

/// Where no subdivision helps, because the two faces at an interior vertex of valence 2 share two edges on every level: what is left of the
/// face after so many levels that it is a point (4^-10 of the face), with the tangents at the vertex.
struct LimitTip {
  std::array<glm::dvec3, 4> corners{};
  glm::dvec3 tangent1{0.0}, tangent2{0.0};  ///< Of the patch's side; 0 where there is no tangent plane.
};

/// A face, or a part of one: Bfr's surface, or the faces that one subdivision makes of it, or a tip; else nothing.
struct LimitCell {
  BfrPatch patch{};
  std::vector<LimitCell> children{};  ///< By corner; of a triangle under Loop's scheme the middle one comes last.
  std::unique_ptr<LimitTip> tip{};
  int corners = 4;

  bool valid() const;
};

/// The cell of a face of the refiner's base level, whose points the mesh has; without a surface where a corner is not manifold.
LimitCell make_cell(const Far::TopologyRefiner& refiner, const Mesh& mesh, Scheme scheme, int face);
/// False where the cell has no surface there. Coordinates and derivatives as LimitSurface::evaluate.
bool evaluate_cell(const LimitCell& cell, Scheme scheme, int sub_face, double u, double v, LimitOrder order, LimitPoint& out);

/// Whether a face's corner (of a sub-face where it has any) is a tip.
bool has_tip(const LimitCell& cell, int sub_face, int corner);

/// A cage cut along its edges with more than two faces (or two that disagree on the outside) and along infinitely sharp ones, and apart at
/// vertices where sheets merely touch, so that each sheet is a surface with an open edge. OpenSubdiv makes the former infinitely sharp too:
/// the sheets' limits are the same.
struct SeparatedCage {
  Mesh mesh{};  ///< Faces as in the given one.
  std::unique_ptr<Far::TopologyRefiner> refiner{};
  std::vector<char> same_limit;  ///< For each face: its rules could be carried over.
};
SeparatedCage separate_sheets(const Far::TopologyLevel& level, const Mesh& clean, Scheme scheme);

}  // namespace limn
