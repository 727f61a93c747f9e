#include "subdiv/mesh_body.h"

#include <fmt/format.h>

#include <algorithm>

#include "sdf/error.h"
#include "sdf/once_alone.h"
#include "sdf/parallel.h"
#include "subdiv/first_hits.h"
#include "subdiv/weld.h"

namespace limn {
namespace {

/// `times`: how often each triangle is there; empty: once.
double signed_volume(const TriangleMesh& mesh, const std::vector<std::int32_t>& times) {
  double volume = 0.0;
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    const double own = glm::dot(mesh.positions[t.x], glm::cross(mesh.positions[t.y], mesh.positions[t.z])) / 6.0;
    volume += times.empty() ? own : static_cast<double>(times[i]) * own;
  }
  return volume;
}

Box used_bounds(const TriangleMesh& mesh) {
  Box box;
  for (const glm::uvec3& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) box = include(box, mesh.positions[t[i]]);
  return box;
}

}  // namespace

MeshBody::MeshBody(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw InputError({"", "", "", "the mesh has no triangle with an area", "at least one"});
  const Box box = used_bounds(mesh);
  origin_ = box.center();
  bounds_ = {box.lower - origin_, box.upper - origin_};
  mesh_.positions.resize(mesh.positions.size());
  parallel_parts(mesh.positions.size(), size_t{4096}, [&](const IndexRange<size_t>& part) {
    for (size_t i = part.first; i < part.last; ++i) mesh_.positions[i] = mesh.positions[i] - origin_;
  });
  const std::vector<std::uint32_t> first_at = first_at_position(mesh_.positions);
  MergedTriangles merged = merge_coincident(mesh, first_at);
  mesh_.triangles = std::move(merged.triangles);
  if (const double volume = signed_volume(mesh_, merged.times); volume < 0.0) {
    for (glm::uvec3& t : mesh_.triangles) std::swap(t.y, t.z);
    warnings_.push_back(fmt::format("the mesh is turned inside out (its volume is {:.4g}): its faces were turned round", volume));
  }
  winding_ = std::make_unique<const Winding>(mesh_, first_at, std::move(merged.times));
  if (!winding_->closed())
    warnings_.push_back(
        fmt::format("{} open edges: inside is where the winding number is above 1/2, which closes the holes", winding_->border().size()));
  for (const Winding::BorderEdge& edge : winding_->border()) {
    holes_ = include(include(holes_, edge.a), edge.b);
    length_of_holes_ += std::abs(edge.multiplicity) * glm::distance(edge.a, edge.b);
  }
}

const ClosestPointData& MeshBody::tree() const {
  once_alone(tree_made_, [this] { tree_ = std::make_unique<const ClosestPointData>(mesh_); });
  return *tree_;
}

const TriangleTree& MeshBody::boxes() const {
  once_alone(boxes_made_, [this] { boxes_ = TriangleTree(mesh_); });
  return boxes_;
}

double share_with_inside(const MeshBody& body, double depth) {
  if (body.winding().closed()) return 1.0;
  constexpr size_t kTriangles = 4096;
  const TriangleMesh& mesh = body.mesh();
  const size_t stride = std::max<size_t>(1, mesh.triangles.size() / kTriangles);
  double area = 0.0, with_inside = 0.0;
  for (size_t i = 0; i < mesh.triangles.size(); i += stride) {
    const glm::uvec3 t = mesh.triangles[i];
    const glm::dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z], normal = glm::cross(b - a, c - a);
    const double own = glm::length(normal);
    if (!(own > 0.0)) continue;
    area += own;
    if (body.winding().number((a + b + c) / 3.0 - depth / own * normal) > 0.5) with_inside += own;
  }
  return area > 0.0 ? with_inside / area : 0.0;
}

void warn_of_thin_sheets(const MeshBody& body, double voxel_size, std::vector<std::string>& warnings) {
  const ThinSamples samples = thin_samples(body.mesh(), body.bounds().longest_side(), 2.0 * voxel_size);
  const auto share_below = [](const std::vector<double>& widths, double limit) {
    const auto below = std::count_if(widths.begin(), widths.end(), [limit](double width) { return width < limit; });
    return widths.empty() ? 0.0 : static_cast<double>(below) / static_cast<double>(widths.size());
  };
  const double thin = share_below(samples.walls, 2.0 * voxel_size), narrow = share_below(samples.gaps, voxel_size);
  if (thin > kThinShare)
    warnings.push_back(
        fmt::format("{:.2g} % of the surface lies on walls thinner than two voxels ({:.3g}), which may break up: use smaller voxels",
                    100.0 * thin, 2.0 * voxel_size));
  if (narrow > kThinShare)
    warnings.push_back(
        fmt::format("{:.2g} % of the surface lies at gaps narrower than one voxel ({:.3g}), which may close: use smaller voxels",
                    100.0 * narrow, voxel_size));
}

}  // namespace limn
