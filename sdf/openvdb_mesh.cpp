#include <openvdb/tools/VolumeToMesh.h>

#include "sdf/error.h"
#include "sdf/openvdb_grid.h"
#include "sdf/volume_module.h"

namespace limn {

PolygonSoup volumes::mesh_from_level_set(const LevelSet& level_set) {
  const auto grid = thaw(level_set);
  // Extracted in index space and mapped in double: OpenVDB's float points would lose their digits far from the origin.
  grid->setTransform(openvdb::math::Transform::createLinearTransform(1.0));
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, quads, 0.0);

  const Affine& world_from_index = level_set.info().world_from_index;
  const bool mirrored = glm::determinant(world_from_index.linear) < 0.0;
  PolygonSoup soup;
  soup.positions.reserve(points.size());
  for (const openvdb::Vec3s& p : points)
    soup.positions.push_back(world_from_index.point({static_cast<double>(p.x()), static_cast<double>(p.y()), static_cast<double>(p.z())}));
  soup.face_sizes.assign(quads.size(), 4);
  soup.corner_vertices.reserve(quads.size() * 4);
  // OpenVDB winds its polygons clockwise seen from outside.
  for (const openvdb::Vec4I& quad : quads)
    for (int k = 0; k < 4; ++k) soup.corner_vertices.push_back(static_cast<std::int32_t>(quad[mirrored ? k : 3 - k]));
  return soup;
}

}  // namespace limn
