#pragma once
// A view graph as JSON: everything that limn knows of the lines of a view.

#include "raymarch/lines.h"
#include "samples/output/output.h"

namespace limn {

/// The certificate alone: conflicts with their places, counts of vertices, the bound.
Json certificate_json(const ViewGraph& graph);
/// With all vertices, edges and chains. Points in px, y down; positions in world units.
Json graph_json(const ViewGraph& graph, int width_px, int height_px);

}  // namespace limn
