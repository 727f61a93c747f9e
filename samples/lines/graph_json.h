#pragma once
// A view graph as JSON: everything that limn knows of the lines of a view.

#include "raymarch/line_tracks.h"
#include "samples/output/output.h"

namespace limn {

/// The certificate alone: conflicts with their places, counts of vertices, the bound.
Json certificate_json(const ViewGraph& graph);
/// With all vertices, edges and chains. Points in px, y down; positions in world units. `ids`: of chains, kept from frame to frame.
Json graph_json(const ViewGraph& graph, int width_px, int height_px, const std::vector<int>& ids = {});
/// How many ids there are, and each event.
Json tracks_json(const LineTracks& tracks);

}  // namespace limn
