// Edge quads: every edge of a mesh decides by its two faces whether it is a line of the drawing.

#include <fmt/core.h>

#include <numbers>

#include "raymarch/border.h"
#include "raymarch/border/edge_visibility.h"
#include "raymarch/border/line_raster.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

struct EdgeSettings {
  bool contour, boundary, crease, material, taper;
  double crease_cosine, width_px, far_width_px;
};

EdgeSettings read_settings(const Parameters& parameters) {
  return {parameters.flag("contour"), parameters.flag("boundary"),
          parameters.flag("crease"),  parameters.flag("material"),
          parameters.flag("taper"),   std::cos(parameters.number("crease_angle") * std::numbers::pi / 180.0),
          parameters.number("width"), parameters.number("far_width")};
}

/// Width along an edge: constant, or from `width` at the scene's nearest depth to `far_width` at its farthest, linear in 1/Z as sizes are
/// in perspective (in Z in parallel projection), and so linear along the image of an edge.
struct LineWidth {
  double near_px, far_px, q_near, q_far;
  double at(double q) const {
    if (q_near == q_far) return near_px;
    return near_px + std::clamp((q - q_near) / (q_far - q_near), 0.0, 1.0) * (far_px - near_px);
  }
};

LineWidth line_width(const EdgeSettings& settings, const BorderInput& input, const EdgeVisibility& view) {
  LineWidth width{settings.width_px, settings.far_width_px, 0.0, 0.0};
  if (!settings.taper) return width;
  Box box;
  for (const Surface& surface : input.model.surfaces) {
    if (surface.bounds.finite()) box = merge(box, surface.bounds);
  }
  Interval depth{std::numeric_limits<double>::infinity(), 0.0};
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 corner((i & 1) ? box.upper.x : box.lower.x, (i & 2) ? box.upper.y : box.lower.y, (i & 4) ? box.upper.z : box.lower.z);
    const double z = -glm::dot(corner - view.camera().eye, view.camera().world_from_camera[2]);
    depth = {std::min(depth.lower, z), std::max(depth.upper, z)};
  }
  const bool perspective = view.camera().projection == Projection::perspective;
  if (!(depth.upper > 0.0)) return width;
  if (perspective) depth.lower = std::max(depth.lower, 1e-3 * depth.upper);
  width.q_near = perspective ? 1.0 / depth.lower : depth.lower;
  width.q_far = perspective ? 1.0 / depth.upper : depth.upper;
  return width;
}

/// The side from which a face is seen at a point of it. Edge on counts as from behind: a box seen straight on has (N1.V)(N2.V) = 0 all
/// around its front face, and the product's sign alone would draw no outline at all.
bool faces_eye(const glm::dvec3& normal, const glm::dvec3& to_eye) { return glm::dot(normal, to_eye) > 0.0; }

bool is_line(const EdgeSettings& settings, const TopologyEdge& edge, const EdgeTopology& topology, const glm::dvec3& to_eye) {
  if (edge.face_b < 0) return settings.boundary;
  if (edge.material && settings.material) return true;
  const glm::dvec3& n1 = topology.face_normals[static_cast<size_t>(edge.face_a)];
  const glm::dvec3 n2 = (edge.opposed ? -1.0 : 1.0) * topology.face_normals[static_cast<size_t>(edge.face_b)];
  if (n1 == glm::dvec3(0.0) || n2 == glm::dvec3(0.0)) return false;
  if (settings.contour && faces_eye(n1, to_eye) != faces_eye(n2, to_eye)) return true;
  return settings.crease && angle_exceeds(n1, n2, settings.crease_cosine);
}

void add_pieces(const ImageEdge& edge, std::span<const EdgeStretch> seen, const LineWidth& width, std::vector<LinePiece>& pieces) {
  const auto point = [&](double s) { return edge.a + s * (edge.b - edge.a); };
  const auto at = [&](double s) { return width.at(edge.q_a + s * (edge.q_b - edge.q_a)); };
  for (const EdgeStretch& stretch : seen) pieces.push_back({point(stretch.from), point(stretch.to), at(stretch.from), at(stretch.to)});
}

/// Edges that one task takes; the pieces of each block are joined in the order of the edges.
constexpr size_t kBlock = 1024;

void add_object(const EdgeSettings& settings, const Polygons& polygons, std::int32_t object, const EdgeVisibility& view,
                const LineWidth& width, std::vector<LinePiece>& pieces) {
  const Mesh& mesh = polygons.mesh();
  const EdgeTopology& topology = polygons.edges();
  const size_t blocks = (topology.edges.size() + kBlock - 1) / kBlock;
  const double margin_px = std::max(settings.width_px, settings.far_width_px) + 1.0;
  std::vector<std::vector<LinePiece>> of_block(blocks);
  const auto work = [&](size_t block) {
    std::vector<EdgeStretch> seen;
    EdgeVisibility::Scratch scratch;
    for (size_t i = block * kBlock; i < std::min(topology.edges.size(), (block + 1) * kBlock); ++i) {
      const TopologyEdge& edge = topology.edges[i];
      const glm::dvec3 &a = mesh.positions[static_cast<size_t>(edge.vertex_a)], &b = mesh.positions[static_cast<size_t>(edge.vertex_b)];
      // Both faces hold the edge, so that any point of it tells their sides.
      const glm::dvec3 to_eye = view_vector(view.camera(), 0.5 * (a + b));
      if (!is_line(settings, edge, topology, to_eye)) continue;
      ImageEdge image;
      if (!view.place(a, b, margin_px, image)) continue;
      image.object = object;
      image.face_a = edge.face_a;
      image.face_b = edge.face_b;
      image.turned_away = edge.face_b >= 0 && !edge.opposed &&
                          !faces_eye(topology.face_normals[static_cast<size_t>(edge.face_a)], to_eye) &&
                          !faces_eye(topology.face_normals[static_cast<size_t>(edge.face_b)], to_eye);
      seen.clear();
      view.visible_stretches(image, scratch, seen);
      add_pieces(image, seen, width, of_block[block]);
    }
  };
  parallel_each(blocks, work);
  for (const std::vector<LinePiece>& part : of_block) pieces.insert(pieces.end(), part.begin(), part.end());
}

/// Pairs of neighbouring pixels that show different objects and have no line near them.
std::int64_t bare_boundaries(const GBuffer& seen, const Image<float>& ink) {
  std::int64_t count = 0;
  for (int y = 0; y + 1 < seen.height; ++y) {
    for (int x = 0; x + 1 < seen.width; ++x) {
      const std::int32_t id = seen.id.at(x, y), right = seen.id.at(x + 1, y), below = seen.id.at(x, y + 1);
      const bool meets = id != 0 && ((right != 0 && right != id) || (below != 0 && below != id));
      if (!meets) continue;
      bool inked = false;
      for (int v = std::max(0, y - 1); v <= std::min(seen.height - 1, y + 2); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(seen.width - 1, x + 2); ++u) inked = inked || ink.at(u, v) > 0.0f;
      }
      count += !inked;
    }
  }
  return count;
}

void add_notes(const BorderInput& input, const Image<float>& ink, std::vector<std::string>& notes) {
  if (input.model.surfaces.size() > 1) {
    if (const std::int64_t bare = bare_boundaries(input.gbuffer, ink); bare > 0)
      notes.push_back(
          fmt::format("edge_quads: no line at {} places where one object's pixels meet another's: meshes that pass through each "
                      "other have no edge there",
                      bare));
  }
  std::int64_t non_manifold = 0, flat = 0, without = 0;
  for (const Surface& surface : input.model.surfaces) {
    without += surface.polygons == nullptr;
    if (!surface.polygons) continue;
    non_manifold += surface.polygons->edges().non_manifold;
    flat += surface.polygons->edges().flat_faces;
  }
  if (without > 0)
    notes.push_back(fmt::format("edge_quads: {} of {} objects have no polygons, and so no lines", without, input.model.surfaces.size()));
  if (non_manifold > 0)
    notes.push_back(
        fmt::format("edge_quads: {} edge{} with more than two faces; the first two decide", non_manifold, non_manifold == 1 ? "" : "s"));
  if (flat > 0)
    notes.push_back(
        fmt::format("edge_quads: {} face{} without area and without a neighbour: no contour or crease there", flat, flat == 1 ? "" : "s"));
}

Border draw(const BorderInput& input, const Parameters& parameters) {
  const EdgeSettings settings = read_settings(parameters);
  Border border;
  border.color = glm::vec3(parameters.vector3("color"));
  border.coverage = {input.gbuffer.width, input.gbuffer.height, 0.0f};
  const EdgeVisibility view(input);
  const LineWidth width = line_width(settings, input, view);
  std::vector<LinePiece> pieces;
  for (size_t i = 0; i < input.model.surfaces.size(); ++i) {
    if (const Polygons* polygons = input.model.surfaces[i].polygons.get())
      add_object(settings, *polygons, static_cast<std::int32_t>(i), view, width, pieces);
  }
  draw_lines(pieces, border.coverage);
  add_notes(input, border.coverage, border.notes);
  return border;
}

std::string unsupported(const SceneModel& model, const Scene&) {
  for (const Surface& surface : model.surfaces) {
    if (surface.polygons) return {};
  }
  return "it draws the edges of polygons, and no object is modelled by any; surface = mesh makes them";
}

}  // namespace

BorderMethod edge_quads_method() {
  return {
      {"edge_quads", "edges of the mesh: contour, boundary, crease and material edges as lines, hidden ones removed",
       "Card and Mitchell 2002; McGuire and Hughes 2004"},
      {"Z", "id", "face", "mesh"},
      {a_number("width", 2.0).in(0.0, 64.0).unit("px").help("of the lines; with taper: at the scene's nearest depth"),
       a_flag("taper", false).help("near lines thick, far lines thin"),
       a_number("far_width", 0.5).in(0.0, 64.0).unit("px").help("with taper: at the scene's farthest depth"),
       a_flag("contour", true).help("edges between a face seen from the front and one seen from behind"),
       a_flag("boundary", true).help("edges with one face only"),
       a_flag("crease", true).help("edges whose faces turn by more than the crease angle"),
       a_number("crease_angle", 40.0).in(0.0, 180.0).unit("deg").help("between the normals of the two faces"),
       a_flag("material", true).help("edges whose faces differ in material"), a_color("color", {0.0, 0.0, 0.0}).help("ink, linear RGB")},
      unsupported,
      draw};
}

}  // namespace limn
