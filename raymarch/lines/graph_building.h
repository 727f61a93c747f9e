#pragma once
// Internal: from cut curves to the view graph.

#include "raymarch/lines/curve_walk.h"
#include "raymarch/lines/invisibility.h"

namespace limn {

/// Vertices, and edges of the classes that are wanted; ends and joints at one place become one vertex.
void add_edges(const std::vector<SurfaceCurve>& curves, const CutCurves& cut, const LineTask& task, ViewGraph& graph);

/// Joins edges of the same class and invisibility, through vertices, into the longest strokes; straight on where there is a choice.
void add_chains(ViewGraph& graph);

/// Ends of contours on creases: the crease gets its joint at the very same point.
void snap_joints(std::vector<SurfaceCurve>& curves, const Camera& camera);

}  // namespace limn
