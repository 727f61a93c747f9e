#include "tests/bench/convert_suite.h"

#include <fmt/format.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/enumerable_thread_specific.h>

#include "subdiv/mesh_level_set.h"
#include "tests/bench/bench_cases.h"
#include "tests/bench/timing.h"
#include "tests/bench/vdb_grid.h"

namespace limn::bench {
namespace {

constexpr double kHalfWidth = 3.0;
constexpr int kThreads = 2;

struct PeerInput {
  openvdb::math::Transform::Ptr transform;
  std::vector<openvdb::Vec3s> points;  ///< Index coordinates.
  std::vector<openvdb::Vec3I> triangles;
};

PeerInput peer_input(const TriangleMesh& mesh, double voxel_size) {
  openvdb::initialize();
  PeerInput input;
  input.transform = openvdb::math::Transform::createLinearTransform(voxel_size);
  for (const glm::dvec3& p : mesh.positions)
    input.points.emplace_back(float(p.x / voxel_size), float(p.y / voxel_size), float(p.z / voxel_size));
  for (const glm::uvec3& t : mesh.triangles) input.triangles.emplace_back(t.x, t.y, t.z);
  return input;
}

openvdb::FloatGrid::Ptr mesh_to_volume(const PeerInput& input) {
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(input.points, input.triangles);
  return openvdb::tools::meshToVolume<openvdb::FloatGrid>(adapter, *input.transform, float(kHalfWidth), float(kHalfWidth));
}

struct Errors {
  double largest_voxels = 0.0;
  std::int64_t nodes = 0;
};

/// Of |value| against the exact distance, at every active node.
Errors errors_of(const openvdb::FloatGrid& grid, const ClosestPointQuery& exact) {
  using Leaf = openvdb::FloatTree::LeafNodeType;
  std::vector<const Leaf*> leaves;
  grid.tree().getNodes(leaves);
  tbb::enumerable_thread_specific<Errors> parts;
  tbb::parallel_for(size_t{0}, leaves.size(), [&](size_t i) {
    Errors& part = parts.local();
    for (auto it = leaves[i]->cbeginValueOn(); it; ++it) {
      const openvdb::Vec3d p = grid.transform().indexToWorld(it.getCoord());
      const double distance = exact.closest({p.x(), p.y(), p.z()}).distance;
      part.largest_voxels = std::max(part.largest_voxels, std::fabs(std::fabs(double(*it)) - distance) / grid.voxelSize()[0]);
      ++part.nodes;
    }
  });
  Errors sum;
  for (const Errors& part : parts) sum = {std::max(sum.largest_voxels, part.largest_voxels), sum.nodes + part.nodes};
  return sum;
}

nlohmann::json convert_row(const BenchObject& object, int voxels, const ConvertBenchSettings& settings) {
  Box box;
  for (const glm::dvec3& p : object.mesh.positions) box = include(box, p);
  const double voxel_size = box.longest_side() / voxels;
  const PeerInput input = peer_input(object.mesh, voxel_size);
  std::optional<LevelSet> ours;
  const auto warnings = level_set_from_mesh(object.mesh, {.voxel_size = voxel_size, .half_width_voxels = kHalfWidth}).warnings;
  const bool open =
      std::any_of(warnings.begin(), warnings.end(), [](const std::string& w) { return w.find("open edges") != std::string::npos; });
  openvdb::FloatGrid::Ptr theirs;
  const std::vector<Times> times = time_interleaved(
      {[&] { ours = level_set_from_mesh(object.mesh, {.voxel_size = voxel_size, .half_width_voxels = kHalfWidth}).level_set; },
       [&] { theirs = mesh_to_volume(input); }},
      settings.runs, kThreads);
  const ClosestPointQuery exact(object.mesh);
  const Errors our_errors = errors_of(*openvdb_grid(*ours), exact), their_errors = errors_of(*theirs, exact);
  fmt::print(settings.table, "{:16} {:6} {:9} {:10.1f} {:10.1f} {:6.2f} {:12.3g} {:12.3g} {:10} {:10}{}\n", object.name, voxels,
             object.mesh.triangles.size(), times[0].median_ms(), times[1].median_ms(), times[0].median_ms() / times[1].median_ms(),
             our_errors.largest_voxels, their_errors.largest_voxels, our_errors.nodes, their_errors.nodes,
             open ? "  open: our band goes on over its holes" : "");
  std::fflush(settings.table);
  return {{"kind", "convert"},
          {"object", object.name},
          {"voxels", voxels},
          {"threads", kThreads},
          {"triangles", object.mesh.triangles.size()},
          {"open", open},
          {"ours_ms", times[0].median_ms()},
          {"openvdb_ms", times[1].median_ms()},
          {"ours_error_voxels", our_errors.largest_voxels},
          {"openvdb_error_voxels", their_errors.largest_voxels},
          {"ours_nodes", our_errors.nodes},
          {"openvdb_nodes", their_errors.nodes}};
}

}  // namespace

nlohmann::json bench_convert(const ConvertBenchSettings& settings) {
  std::vector<BenchObject> objects;
  const std::vector<std::string> names =
      settings.objects.empty() ? std::vector<std::string>{"sphere", "torus", "rook", "teacup", "pipe_junction"} : settings.objects;
  for (const std::string& name : names) objects.push_back(bench_object(name));
  for (const std::string& file : settings.meshes) objects.push_back(bench_mesh_file(file));
  fmt::print(settings.table,
             "\nmesh to level set, {} threads, half width {:g} voxels; errors in voxels, the largest over all active nodes\n", kThreads,
             kHalfWidth);
  fmt::print(settings.table, "{:16} {:>6} {:>9} {:>10} {:>10} {:>6} {:>12} {:>12} {:>10} {:>10}\n", "object", "voxels", "triangles",
             "ours ms", "openvdb ms", "ratio", "our error", "its error", "our nodes", "its nodes");
  nlohmann::json rows = nlohmann::json::array();
  for (const int voxels : settings.voxels.empty() ? std::vector<int>{128, 256, 512} : settings.voxels)
    for (const BenchObject& object : objects) rows.push_back(convert_row(object, voxels, settings));
  return rows;
}

}  // namespace limn::bench
