#include "raymarch/local/mesh_part.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "raymarch/local/brick_demand.h"

namespace limn {
namespace {

/// Beyond so many near a block the tree is quicker.
constexpr size_t kManyTriangles = 20'000;

/// The surface over the holes of an open mesh, where the winding number is one half: whether a box may hold some of it, and how it faces.
struct Membrane {
  bool passes = false;
  bool faces_anywhere = false;          ///< Too close to a hole's edge to tell.
  std::array<glm::dvec3, 9> normals{};  ///< At the middle and the corners; where it faces the way they do.
};

/// Away from the triangles the number is smooth; a box that they pass may hold some all the same, on one of their sides.
Membrane membrane_in(const MeshPart& part, const Box& box, bool with_normals) {
  Membrane membrane;
  const Winding& winding = part.body->winding();
  if (winding.closed()) return membrane;
  const double radius = 0.5 * glm::length(box.size());
  // Whole numbers apart on the sides of triangles: the distance to one half is taken from the nearest of them.
  const double number = winding.number(box.center()), from_half = std::abs(number - std::floor(number) - 0.5);
  // As if all edges were as near as the nearest could be: quicker than asking each.
  const glm::dvec3 away = box.center() - glm::clamp(box.center(), part.body->holes().lower, part.body->holes().upper);
  const double distance = glm::length(away) - radius;
  if (distance > 0.0 &&
      from_half > part.body->length_of_holes() / (4.0 * std::numbers::pi * distance * distance) * radius + Winding::kFarError)
    return membrane;
  const double slope = winding.gradient_bound(box.center(), radius);
  membrane.passes = !(from_half > slope * radius + Winding::kFarError);
  membrane.faces_anywhere = membrane.passes && !std::isfinite(slope);
  if (!membrane.passes || membrane.faces_anywhere || !with_normals) return membrane;
  std::array<glm::dvec3, 9> places{box.center()};
  for (size_t k = 0; k < 8; ++k) places[k + 1] = glm::mix(box.lower, box.upper, glm::dvec3(k & 1, k >> 1 & 1, k >> 2));
  std::array<Winding::Potential, 9> potentials;
  winding.potentials(places, potentials);
  for (size_t k = 0; k < 9; ++k) {
    const glm::dvec3& gradient = potentials[k].gradient;
    const double length = glm::length(gradient);
    if (!(length > 0.0)) membrane.faces_anywhere = true;
    membrane.normals[k] = length > 0.0 ? -gradient / length : glm::dvec3(0.0);
  }
  return membrane;
}

/// The surface near a brick, as its facets tell.
struct Facets {
  Membrane membrane{};
  bool faces_anywhere = false;  ///< Nothing is known of how it faces.
  double longest_edge = 0.0;
  GradientBounds bounds{};  ///< Of the distance's gradient; the value's are not set.
};

Facets facets_in(const MeshPart& part, const Box& reach) {
  Facets facets;
  FacetBounds found = part.body->boxes().facets(reach);
  facets.membrane = membrane_in(part, reach, true);
  if (facets.membrane.passes && !facets.membrane.faces_anywhere)
    for (const glm::dvec3& n : facets.membrane.normals) found.lower = glm::min(found.lower, n), found.upper = glm::max(found.upper, n);
  facets.longest_edge = found.longest_edge;
  facets.faces_anywhere = facets.membrane.faces_anywhere || found.empty();
  for (int axis = 0; axis < 3; ++axis)
    facets.bounds.gradient[static_cast<size_t>(axis)] =
        facets.faces_anywhere ? Interval{-1.0, 1.0} : Interval{found.lower[axis], found.upper[axis]};
  return facets;
}

/// N.V of the facets in a box, from least to most.
Interval facing_of(const MeshPart& part, const Facets& facets, const Box& reach, const Camera& camera) {
  if (facets.faces_anywhere) return {-1.0, 1.0};
  const glm::dvec3 v = view_vector(camera, reach.center());
  Interval range = part.body->boxes().facing(reach, v);
  if (facets.membrane.passes)
    for (const glm::dvec3& n : facets.membrane.normals)
      range = {std::min(range.lower, glm::dot(n, v)), std::max(range.upper, glm::dot(n, v))};
  return range;
}

/// By how much N.V may differ from that at the box's middle because the eye is seen in another direction.
double parallax(const Box& reach, const Camera& camera) {
  if (camera.projection == Projection::orthographic) return 0.0;
  const double radius = 0.5 * glm::length(reach.size()), away = glm::distance(camera.eye, reach.center());
  return away > 2.0 * radius ? radius / (away - radius) : 2.0;
}

/// What voxels of that size are predicted to move the border by, world units. Facets that are larger than voxels show as such: their edges
/// are rounded off by about a voxel. Smaller ones are as good as the smooth surface that they are of.
double predicted_shift(const Facets& facets, const Interval& facing, const Box& reach, double voxel_size,
                       const LocalBrickSettings& settings) {
  if (facets.faces_anywhere || facets.longest_edge > voxel_size) return voxel_size;
  const auto& g = facets.bounds.gradient;
  const double side = reach.longest_side();
  const double turn = glm::length(glm::dvec3(g[0].width(), g[1].width(), g[2].width()));
  // Two curvatures; a chord of length h stands off by h^2 / 8 of their sum.
  const double off = voxel_size * voxel_size / 8.0 * 2.0 * turn / side;
  if (settings.local.thresholds.empty()) return off;
  const double angle = settings.gradient->normal_constant * std::pow(turn / side * voxel_size, settings.gradient->order);
  return off + angle / std::max(facing.width() / side, 1e-12);
}

bool border_needs(const MeshPart& part, const Facets& facets, const Box& reach, double voxel_size, const Camera& camera,
                  double pixels_per_unit, const LocalBrickSettings& settings) {
  constexpr double kMargin = 0.02;
  const Interval facing = facing_of(part, facets, reach, camera);
  const double margin = kMargin + parallax(reach, camera);
  const auto holds = [&](double value) { return facing.lower < value + margin && facing.upper > value - margin; };
  const std::vector<double>& thresholds = settings.local.thresholds;
  if (!holds(0.0) && !std::any_of(thresholds.begin(), thresholds.end(), holds)) return false;
  return kDemandSafety * predicted_shift(facets, facing, reach, voxel_size, settings) * pixels_per_unit > settings.local.tolerance_px;
}

}  // namespace

bool may_hold_surface(const MeshPart& part, const Box& box) {
  return part.body->boxes().any_meets(part.body->mesh(), box) || membrane_in(part, box, false).passes;
}

bool needs_smaller_voxels(const MeshPart& part, const Box& box, double voxel_size, double /*smaller*/, const LocalBrickSettings& settings) {
  const Box reach = dilate(box, kStencilReach_voxels * voxel_size);
  const Facets facets = facets_in(part, reach);
  return pictures_need_smaller(facets.bounds, box, voxel_size, settings, [&](const Camera& camera, double pixels_per_unit) {
    return border_needs(part, facets, reach, voxel_size, camera, pixels_per_unit, settings);
  });
}

void prepare_trees(const MeshPart& part, double half_width_voxels) {
  part.body->boxes();
  if (half_width_voxels > kScatterReach_voxels || part.body->mesh().triangles.size() > kManyTriangles) part.body->tree();
}

void block_distances(const MeshPart& part, const glm::ivec3& origin, const NodeLattice& lattice, FilledBlocks& filled,
                     std::array<float, 512>& values) {
  const MeshBody& body = *part.body;
  const auto [h, half_width, smallest] = lattice;
  bool by_tree = half_width > kScatterReach_voxels * h;
  std::vector<std::uint32_t> near;
  if (!by_tree) {
    const Box nodes{h * glm::dvec3(origin), h * glm::dvec3(origin + 7)};
    body.boxes().find(dilate(nodes, 1.000001 * half_width), near);
    by_tree = !smallest && near.size() > kManyTriangles;
  }
  BlockDistanceArray distances;
  if (by_tree)
    measure_block(origin, body.tree(), h, half_width, distances);
  else
    band_distances(body.mesh(), near, origin, h, half_width, distances);
  LevelSetBlock block;
  fill_block(origin, distances, {.winding = body.winding(), .triangles = near, .filled = &filled}, {h, half_width, 0.0}, block);
  std::copy_n(block.values, 512, values.begin());
}

}  // namespace limn
