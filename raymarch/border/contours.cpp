// Contours: the lines of the model itself, traced as vectors with certified visibility and laid down with exact coverage.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/border.h"
#include "raymarch/border/exact_coverage.h"
#include "raymarch/border/stroke_forms.h"
#include "raymarch/border/vertex_widths.h"
#include "raymarch/lines.h"

namespace limn {

/// The lines of what is seen, as one call asked for them.
struct SharedLines {
  LineSettings settings{};
  std::vector<SceneObject> cages{};                   ///< All that is traced; empty where anything else is among it.
  std::vector<std::weak_ptr<const void>> surfaces{};  ///< Of the model that they were asked for; weak, so that none outlives its use.
  ViewGraph graph{};
  bool facets = false;  ///< A mesh as it is is among them.
  /// Coverage by a call's parameters: exact, so that it is the same for every sample of a pixel.
  mutable std::vector<std::pair<std::string, Image<float>>> inks{};
};

namespace {

constexpr double kArc_px = 0.005;  // between the arcs of an outline and their circles
constexpr double kCrumb_px = 4.0;

enum class WidthFrom { constant, depth, curvature, vertices };

constexpr std::array<std::pair<const char*, ColorChannel>, 4> kChannels{
    {{"luminance", ColorChannel::luminance}, {"red", ColorChannel::red}, {"green", ColorChannel::green}, {"blue", ColorChannel::blue}}};

struct Settings {
  double width_px, thin_px, inner_px, threshold;
  WidthFrom from;
  ColorChannel channel;  ///< Of the vertices' colours.
  bool hidden;
  double hidden_px, dash_px, shortest_px;
  Wobble wobble;
  LineSettings lines;
};

Settings read_settings(const Parameters& parameters) {
  Settings settings{
      .width_px = parameters.number("width"),
      .thin_px = parameters.number("thin_width"),
      .inner_px = parameters.number("inner_width"),
      .threshold = parameters.number("threshold"),
      .from = WidthFrom::constant,
      .channel = ColorChannel::luminance,
      .hidden = parameters.flag("hidden"),
      .hidden_px = parameters.number("hidden_width"),
      .dash_px = parameters.number("dash"),
      .shortest_px = parameters.number("shortest"),
      .wobble = {parameters.number("wobble"), parameters.number("wobble_length"), static_cast<std::uint64_t>(parameters.number("seed"))},
      .lines = {}};
  settings.thin_px = std::min(settings.thin_px, settings.width_px);
  const std::string& from = parameters.choice("width_from");
  if (from == "depth") settings.from = WidthFrom::depth;
  if (from == "curvature") settings.from = WidthFrom::curvature;
  for (const auto& [name, channel] : kChannels) {
    if (from == name) settings.from = WidthFrom::vertices, settings.channel = channel;
  }
  for (const LineClassDescriptor& one : line_classes()) {
    if (one.line_class != LineClass::rim && parameters.flag(one.about.name)) settings.lines.classes.push_back(one.line_class);
  }
  settings.lines.crease_angle_deg = parameters.number("crease_angle");
  settings.lines.smooth_meshes = parameters.flag("smooth");
  settings.lines.fairing_edges = parameters.number("fair");
  return settings;
}

bool same(const LineSettings& a, const LineSettings& b) {
  return a.classes == b.classes && a.threshold == b.threshold && a.crease_angle_deg == b.crease_angle_deg &&
         a.smooth_meshes == b.smooth_meshes && a.fairing_edges == b.fairing_edges && a.tolerance_px == b.tolerance_px;
}

bool draws_facets(const Scene& scene) {
  return std::any_of(scene.objects.begin(), scene.objects.end(), [](const SceneObject& object) {
    const auto* mesh = std::get_if<MeshSource>(&object.source);
    return mesh != nullptr && !mesh->scheme;
  });
}

bool any_painted(const Scene& scene) {
  return std::any_of(scene.objects.begin(), scene.objects.end(), [](const SceneObject& object) {
    const auto* mesh = std::get_if<MeshSource>(&object.source);
    return mesh != nullptr && !mesh->mesh->vertex_colors.empty();
  });
}

std::vector<std::weak_ptr<const void>> surfaces_of(const SceneModel& model) {
  std::vector<std::weak_ptr<const void>> surfaces;
  for (const Surface& surface : model.surfaces) surfaces.emplace_back(surface.state);
  return surfaces;
}

bool same(const std::vector<std::weak_ptr<const void>>& a, const std::vector<std::weak_ptr<const void>>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& one, const auto& other) { return !one.owner_before(other) && !other.owner_before(one); });
}

bool same(const Affine& a, const Affine& b) { return a.linear == b.linear && a.translation == b.translation; }

/// Whether both are cages of one mesh in one place, whose lines are those of their limit surface, however often a model refines them.
bool is_same_cage(const SceneObject& a, const SceneObject& b) {
  const auto *of_a = std::get_if<MeshSource>(&a.source), *of_b = std::get_if<MeshSource>(&b.source);
  return of_a != nullptr && of_b != nullptr && of_a->scheme && of_a->scheme == of_b->scheme && &*of_a->mesh == &*of_b->mesh &&
         a.material == b.material && same(a.world_from_object, b.world_from_object);
}

bool same_cages(std::span<const SceneObject> a, std::span<const SceneObject> b) {
  return !a.empty() && std::equal(a.begin(), a.end(), b.begin(), b.end(), is_same_cage);
}

std::vector<SceneObject> cages_of(const Scene& scene) {
  const bool all = std::all_of(scene.objects.begin(), scene.objects.end(), [](const SceneObject& object) {
    const auto* mesh = std::get_if<MeshSource>(&object.source);
    return mesh != nullptr && mesh->scheme;
  });
  return all ? scene.objects : std::vector<SceneObject>{};
}

/// Solved once for all samples of a picture, for all calls with the same settings, and for all models of the same cages.
std::shared_ptr<const SharedLines> lines_of(const BorderInput& input, const LineSettings& settings) {
  const Scene scene = modelled_scene(input.scene, input.model);
  SharedLines lines{settings, cages_of(scene), surfaces_of(input.model)};
  lines.facets = draws_facets(scene);
  const SharedLines* of_cages = nullptr;
  if (input.shared != nullptr) {
    for (const auto& kept : input.shared->lines) {
      if (!same(kept->settings, settings)) continue;
      if (same(kept->surfaces, lines.surfaces)) return kept;
      if (!same_cages(kept->cages, lines.cages)) continue;
      // Widths may come from colours of vertices, which are read off each model's own polygons.
      if (!any_painted(scene)) return kept;
      of_cages = kept.get();
    }
  }
  lines.graph = of_cages != nullptr ? of_cages->graph : solve_lines(scene, input.camera, settings, {});
  auto solved = std::make_shared<const SharedLines>(std::move(lines));
  if (input.shared != nullptr) input.shared->lines.push_back(solved);
  return solved;
}

/// The width of a stroke from point to point.
struct PenWidth {
  const Settings& settings;
  const Camera& camera;
  const VertexWidths* vertices = nullptr;  ///< Where the width comes from these.
  double nearest = 1.0, farthest = 1.0;    ///< Depths of what is seen of the lines.

  double at(const LinePoint& point, int object) const {
    const auto between = [&](double share) {
      return settings.thin_px + std::clamp(share, 0.0, 1.0) * (settings.width_px - settings.thin_px);
    };
    if (vertices != nullptr) return between(vertices->at(object, point.position).value_or(1.0));
    const bool perspective = camera.projection == Projection::perspective;
    if (settings.from == WidthFrom::depth) {
      if (!(farthest > nearest)) return settings.width_px;
      // Linear in 1/Z as sizes are in perspective, so that a straight edge has a straight stroke.
      const double q = perspective ? 1.0 / point.depth : -point.depth, q_near = perspective ? 1.0 / nearest : -nearest,
                   q_far = perspective ? 1.0 / farthest : -farthest;
      return between((q - q_far) / (q_near - q_far));
    }
    // As far from the contour N.V reaches the threshold, to first order threshold^2 / (2 kr): what the rim inks, and a thick line where the
    // surface turns away slowly (Goodwin, Vollick and Hertzmann 2007, "Isophote distance").
    if (std::isnan(point.radial_curvature)) return settings.thin_px;
    if (!(point.radial_curvature > 0.0)) return settings.width_px;
    const double px_per_world = perspective ? camera.focal_px / point.depth : camera.pixels_per_unit;
    const double distance_px = 0.5 * settings.threshold * settings.threshold / point.radial_curvature * px_per_world;
    return std::clamp(distance_px, settings.thin_px, settings.width_px);
  }
};

/// Edges of the surface itself are drawn thinner where somebody says so.
bool is_inner(LineClass line_class) {
  return line_class != LineClass::contour && line_class != LineClass::boundary && line_class != LineClass::rim;
}

/// A chain that is drawn.
struct DrawnChain {
  const LineChain* chain;
  size_t number;  ///< Of the graph's.
  std::vector<LinePoint> points;
};

double length_px(const std::vector<LinePoint>& points) {
  double length = 0.0;
  for (size_t i = 1; i < points.size(); ++i) length += glm::distance(points[i - 1].px, points[i].px);
  return length;
}

std::vector<DrawnChain> drawn_chains(const ViewGraph& graph, bool hidden, double shortest_px) {
  std::vector<DrawnChain> chains;
  for (size_t i = 0; i < graph.chains.size(); ++i) {
    if ((graph.chains[i].invisibility != 0) != hidden) continue;
    std::vector<LinePoint> points = points_of(graph, graph.chains[i]);
    if (!(length_px(points) < shortest_px)) chains.push_back({&graph.chains[i], i, std::move(points)});
  }
  return chains;
}

std::vector<StrokePoint> stroke_of(const DrawnChain& drawn, const Settings& settings, const PenWidth& pen) {
  const bool inner = settings.inner_px > 0.0 && is_inner(drawn.chain->line_class);
  std::vector<StrokePoint> stroke;
  stroke.reserve(drawn.points.size());
  for (const LinePoint& point : drawn.points)
    stroke.push_back({point.px, inner                                  ? settings.inner_px
                                : settings.from == WidthFrom::constant ? settings.width_px
                                                                       : pen.at(point, drawn.chain->object)});
  return settings.wobble.px > 0.0 ? wobbling(stroke, drawn.chain->closed, settings.wobble, drawn.number) : stroke;
}

std::vector<Outline> outlines(const ViewGraph& graph, const Settings& settings, const BorderInput& input) {
  const std::vector<DrawnChain> visible = drawn_chains(graph, false, settings.shortest_px);
  std::optional<VertexWidths> vertices;
  if (settings.from == WidthFrom::vertices) vertices.emplace(input.scene, input.model, settings.channel);
  PenWidth pen{settings, input.camera, vertices ? &*vertices : nullptr, std::numeric_limits<double>::infinity(), 0.0};
  for (const DrawnChain& drawn : visible) {
    for (const LinePoint& point : drawn.points) {
      pen.nearest = std::min(pen.nearest, point.depth);
      pen.farthest = std::max(pen.farthest, point.depth);
    }
  }
  std::vector<Outline> result;
  result.reserve(visible.size());
  for (const DrawnChain& drawn : visible) result.push_back(outline_of(stroke_of(drawn, settings, pen), drawn.chain->closed, kArc_px));
  if (!settings.hidden) return result;
  for (const DrawnChain& drawn : drawn_chains(graph, true, settings.shortest_px)) {
    std::vector<StrokePoint> stroke;
    for (const LinePoint& point : drawn.points) stroke.push_back({point.px, settings.hidden_px});
    for (const std::vector<StrokePoint>& dash : dashes_of(stroke, drawn.chain->closed, settings.dash_px))
      result.push_back(outline_of(dash, false, kArc_px));
  }
  return result;
}

/// Pieces of contour that only single facets have, which fold over each other beside the smooth surface's contour.
size_t crumbs_of(const ViewGraph& graph) {
  const auto is_crumb = [&](const LineChain& chain) {
    if (chain.line_class != LineClass::contour || chain.invisibility != 0) return false;
    return length_px(points_of(graph, chain)) < kCrumb_px;
  };
  return static_cast<size_t>(std::count_if(graph.chains.begin(), graph.chains.end(), is_crumb));
}

void add_notes(const SharedLines& lines, double shortest_px, std::vector<std::string>& notes) {
  const ViewGraph& graph = lines.graph;
  if (const size_t crumbs = lines.facets && !lines.settings.smooth_meshes && shortest_px < kCrumb_px ? crumbs_of(graph) : 0; crumbs > 0) {
    notes.push_back(
        fmt::format("contours: {} of the mesh's contours are shorter than {:.0f} px: folds of single facets; smooth = true draws the "
                    "smooth surface through its vertices",
                    crumbs, kCrumb_px));
  }
  if (!graph.conflicts.empty()) {
    const LineConflict& first = graph.conflicts.front();
    notes.push_back(fmt::format("contours: {} conflict{} in the visibility of {} chains, the first at {:.1f}, {:.1f}: {}",
                                graph.conflicts.size(), graph.conflicts.size() == 1 ? "" : "s", graph.chains.size(), first.px.x, first.px.y,
                                first.what));
  }
  for (const std::string& note : graph.notes) notes.push_back("contours: " + note);
}

const Image<float>& ink_of(const SharedLines& lines, const Settings& settings, const BorderInput& input, const std::string& call) {
  for (const auto& [known, ink] : lines.inks)
    if (known == call) return ink;
  const int width = input.gbuffer.width, height = input.gbuffer.height;
  const bool drawn = settings.width_px > 0.0 && !settings.lines.classes.empty();
  Image<float> ink = drawn ? covered_by(outlines(lines.graph, settings, input), width, height) : Image<float>(width, height, 0.0f);
  return lines.inks.emplace_back(call, std::move(ink)).second;
}

Border draw(const BorderInput& input, const Parameters& parameters) {
  const Settings settings = read_settings(parameters);
  Border border;
  border.color = glm::vec3(parameters.vector3("color"));
  const auto lines = lines_of(input, settings.lines);
  border.coverage = ink_of(*lines, settings, input, parameters.text());
  add_notes(*lines, settings.shortest_px, border.notes);
  if (settings.from == WidthFrom::vertices && !any_painted(input.scene)) {
    border.notes.push_back(
        fmt::format("contours: width_from = {} has no effect: no mesh here has colours at its vertices", parameters.choice("width_from")));
  }
  return border;
}

std::string unsupported(const SceneModel&, const Scene&) { return {}; }

}  // namespace

BorderMethod contours_method() {
  return {
      {"contours", "the lines of what is traced, of a cage its limit surface's, as vectors with certified visibility and exact coverage",
       "Appel 1967; widths by curvature: Goodwin et al. 2007; tracing and certificate: limn"},
      {"id"},
      {a_number("width", 2.0).in(0.0, 64.0).unit("px").help("of the lines; where it varies: of the thickest"),
       a_choice("width_from", {"constant", "depth", "curvature", "luminance", "red", "green", "blue"})
           .help("the same everywhere; thick where near and thin where far; thick where the surface turns away slowly; or by the colours "
                 "of a mesh's vertices, linear: thick where that channel is 1, thin where it is 0"),
       a_number("thin_width", 0.5).in(0.0, 64.0).unit("px").help("where the width varies: of the thinnest"),
       a_number("inner_width", 0.0)
           .in(0.0, 64.0)
           .unit("px")
           .help("of creases, intersections, material edges and lines of curvature; 0: that of the other lines"),
       a_number("threshold", 0.2).in(0.0, 1.0).help("by curvature: the width is the distance at which N.V reaches this"),
       a_flag("contour", true).help("where N.V is 0"),
       a_flag("boundary", true).help("open edges"),
       a_flag("crease", true).help("where two normals of an object meet at an angle"),
       a_flag("intersection", true).help("where objects pass through each other"),
       a_flag("material", true).help("where materials of one object meet"),
       a_flag("suggestive", false).help("contours of views nearby"),
       a_flag("ridge", false).help("where the surface bends outwards most"),
       a_flag("valley", false).help("where the surface bends inwards most"),
       a_flag("smooth", false).help("of meshes: the lines of the smooth surface through their vertices, not edges of facets"),
       a_number("fair", 0.0)
           .in(0.0, 1000.0)
           .help("of meshes: waves as short as so many mean edges are smoothed away, such as a scan's noise; without smooth for lines of "
                 "curvature alone; 0: none"),
       a_number("shortest", 0.0).in(0.0, 1000.0).unit("px").help("chains that are shorter are left out"),
       a_flag("hidden", false).help("hidden lines too, dashed"),
       a_number("hidden_width", 1.0).in(0.0, 64.0).unit("px").help("of hidden lines"),
       a_number("dash", 5.0).in(0.5, 1000.0).unit("px").help("length of a hidden line's dashes; gaps are 0.8 times as long"),
       a_number("wobble", 0.0).in(0.0, 16.0).unit("px").help("how far lines sway about their place, as a hand does; 0: not at all"),
       a_number("wobble_length", 60.0).in(2.0, 10'000.0).unit("px").help("from one sway to the next"),
       an_integer("seed", 1.0).in(0.0, 1e9).help("of the sway: another number sways otherwise"),
       a_number("crease_angle", 40.0).in(0.001, 179.999).unit("deg").help("of meshes: between the normals of two faces"),
       a_color("color", {0.0, 0.0, 0.0}).help("ink, linear RGB")},
      unsupported,
      draw};
}

}  // namespace limn
