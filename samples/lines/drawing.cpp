#include "samples/lines/drawing.h"

#include <algorithm>

#include "samples/lines/write_drawing.h"
#include "sdf/error.h"

namespace limn {
namespace {

size_t paint_order(LineClass line_class) {
  size_t order = 0;
  for (const LineClassDescriptor& one : line_classes()) {
    if (one.line_class == line_class) return order;
    ++order;
  }
  return order;
}

VertexKind kind_of(const ViewGraph& graph, int vertex) {
  return vertex < 0 ? VertexKind::end : graph.vertices[static_cast<size_t>(vertex)].kind;
}

Stroke stroke_of(const ViewGraph& graph, int index, const DrawingSettings& settings) {
  const LineChain& chain = graph.chains[static_cast<size_t>(index)];
  Stroke stroke{chain.line_class, chain.invisibility, chain.object, index, index, chain.closed,
                VertexKind::end,  VertexKind::end,    {},           {},    {}};
  const ChainLink &first = chain.links.front(), &last = chain.links.back();
  const LineEdge &first_edge = graph.edges[static_cast<size_t>(first.edge)], &last_edge = graph.edges[static_cast<size_t>(last.edge)];
  stroke.begin = kind_of(graph, first.reversed ? first_edge.end : first_edge.begin);
  stroke.finish = kind_of(graph, last.reversed ? last_edge.begin : last_edge.end);
  stroke.points = points_of(graph, chain);
  stroke.start = stroke.points.front().px;
  stroke.steps = fit_path(stroke.points, stroke.closed, settings.form, settings.fit_px);
  return stroke;
}

}  // namespace

LineDrawing make_drawing(const ViewGraph& graph, int width_px, int height_px, const DrawingSettings& settings,
                         const std::vector<int>& ids) {
  LineDrawing drawing{width_px, height_px, settings, {}};
  for (size_t i = 0; i < graph.chains.size(); ++i) {
    const int layers = graph.chains[i].invisibility;
    if (layers < settings.lowest_invisibility || layers > settings.highest_invisibility) continue;
    drawing.strokes.push_back(stroke_of(graph, static_cast<int>(i), settings));
    if (!ids.empty()) drawing.strokes.back().id = ids[i];
  }
  std::stable_sort(drawing.strokes.begin(), drawing.strokes.end(), [](const Stroke& a, const Stroke& b) {
    const bool a_seen = a.invisibility == 0, b_seen = b.invisibility == 0;
    return a_seen != b_seen ? b_seen : paint_order(a.line_class) < paint_order(b.line_class);
  });
  return drawing;
}

const StrokeStyle& style_of(const LineDrawing& drawing, const Stroke& stroke) {
  const DrawingStyle& style = drawing.settings.style;
  return (stroke.invisibility == 0 ? style.visible : style.hidden).at(stroke.line_class);
}

DrawingStyle built_in_style(const std::string& name) {
  DrawingStyle style;
  style.name = name;
  const auto set = [&](LineClass line_class, const StrokeStyle& visible, const StrokeStyle& hidden) {
    style.visible[line_class] = visible;
    style.hidden[line_class] = hidden;
  };
  if (name == "plain") {
    for (const LineClassDescriptor& one : line_classes()) set(one.line_class, {1.0}, {0.6, "#999999", {4.0, 3.0}});
    return style;
  }
  if (name == "technical") {
    // ISO 128: outlines and visible edges wide, hidden ones narrow and dashed, half as wide.
    for (const LineClassDescriptor& one : line_classes()) set(one.line_class, {0.8}, {0.6, "#555555", {6.0, 3.0}});
    style.visible[LineClass::contour] = style.visible[LineClass::boundary] = {1.6};
    style.visible[LineClass::intersection] = {1.0};
    style.visible[LineClass::rim] = {0.6, "#777777"};
    style.visible[LineClass::suggestive] = {0.8, "#333333"};
    style.visible[LineClass::ridge] = style.visible[LineClass::valley] = {0.5, "#555555"};
    return style;
  }
  if (name == "ink") {
    for (const LineClassDescriptor& one : line_classes())
      set(one.line_class, {1.2, "#1a1a1a", {}, true}, {0.6, "#b0a89c", {2.0, 3.0}, false});
    style.visible[LineClass::contour] = style.visible[LineClass::boundary] = {2.4, "#1a1a1a", {}, true};
    return style;
  }
  const std::vector<std::string> known = {"plain", "technical", "ink"};
  throw InputError({"", "style", name, "there is no such style", known_names(name, known)});
}

}  // namespace limn
