// A view graph as JSON.

#include "samples/lines/graph_json.h"

#include <map>

namespace limn {
namespace {

Json pair(const glm::dvec2& p) { return {p.x, p.y}; }
Json triple(const glm::dvec3& p) { return {p.x, p.y, p.z}; }

Json vertices_json(const ViewGraph& graph) {
  Json all = Json::array();
  for (const LineVertex& vertex : graph.vertices) {
    Json one = {{"kind", name_of(vertex.kind)}, {"px", pair(vertex.px)}, {"depth", number_or_null(vertex.depth)}};
    if (vertex.crossed_by >= 0) one["crossed_by"] = vertex.crossed_by;
    all.push_back(std::move(one));
  }
  return all;
}

Json edges_json(const ViewGraph& graph) {
  Json all = Json::array();
  for (const LineEdge& edge : graph.edges) {
    Json px = Json::array(), depth = Json::array(), position = Json::array(), bend = Json::array();
    for (const LinePoint& point : edge.points) {
      px.push_back(pair(point.px));
      depth.push_back(number_or_null(point.depth));
      position.push_back(triple(point.position));
      bend.push_back(number_or_null(point.radial_curvature));
    }
    all.push_back({{"class", name_of(edge.line_class)},
                   {"object", edge.object},
                   {"invisibility", edge.invisibility},
                   {"certain", edge.certain},
                   {"crease", edge.crease},
                   {"curve", edge.curve},
                   {"begin", edge.begin},
                   {"end", edge.end},
                   {"px", std::move(px)},
                   {"depth", std::move(depth)},
                   {"position", std::move(position)},
                   {"radial_curvature", std::move(bend)}});
  }
  return all;
}

Json chains_json(const ViewGraph& graph, const std::vector<int>& ids) {
  Json all = Json::array();
  for (const LineChain& chain : graph.chains) {
    Json links = Json::array();
    for (const ChainLink& link : chain.links) links.push_back({{"edge", link.edge}, {"reversed", link.reversed}});
    all.push_back({{"class", name_of(chain.line_class)},
                   {"object", chain.object},
                   {"invisibility", chain.invisibility},
                   {"closed", chain.closed},
                   {"edges", std::move(links)}});
    if (!ids.empty()) all.back()["id"] = ids[all.size() - 1];
  }
  return all;
}

}  // namespace

Json certificate_json(const ViewGraph& graph) {
  Json conflicts = Json::array();
  for (const LineConflict& conflict : graph.conflicts) conflicts.push_back({{"what", conflict.what}, {"px", pair(conflict.px)}});
  std::map<std::string, int> kinds;
  for (const LineVertex& vertex : graph.vertices) ++kinds[name_of(vertex.kind)];
  return {{"chains", graph.chains.size()},
          {"conflicts", std::move(conflicts)},
          {"bound_px", graph.bound_px},
          {"exact", graph.exact},
          {"rays", graph.rays},
          {"vertices", kinds},
          {"from", graph.from},
          {"notes", graph.notes}};
}

Json graph_json(const ViewGraph& graph, int width_px, int height_px, const std::vector<int>& ids) {
  return {{"width_px", width_px},
          {"height_px", height_px},
          {"certificate", certificate_json(graph)},
          {"vertices", vertices_json(graph)},
          {"edges", edges_json(graph)},
          {"chains", chains_json(graph, ids)}};
}

Json tracks_json(const LineTracks& tracks) {
  Json events = Json::array();
  for (const ChainEvent& event : tracks.events) {
    events.push_back({{"change", name_of(event.change)},
                      {"cause", name_of(event.cause)},
                      {"class", name_of(event.line_class)},
                      {"id", event.id},
                      {"from", event.from},
                      {"to", event.to},
                      {"px", pair(event.px)},
                      {"length_px", number_or_null(event.length_px)}});
    if (event.other >= 0) events.back()["other"] = event.other;
    if (event.beside_conflict) events.back()["beside_conflict"] = true;
  }
  return {{"ids", tracks.ids}, {"unexplained", unexplained(tracks)}, {"solved_between", tracks.solved}, {"events", std::move(events)}};
}

}  // namespace limn
