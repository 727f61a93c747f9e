#include "subdiv/edge_topology.h"

#include <gtest/gtest.h>

#include "test_meshes.h"

namespace limn {
namespace {

using test::cube;

TEST(EdgeTopology, WeldsByPositionBridgesSliversAndCountsWhatItCannot) {
  const Mesh box = cube();
  EXPECT_EQ(build_edge_topology(box).edges.size(), 12u);
  Mesh soup;
  for (size_t c = 0; c < box.corner_vertices.size(); ++c) {
    soup.positions.push_back(box.positions[static_cast<size_t>(box.corner_vertices[c])]);
    soup.corner_vertices.push_back(static_cast<std::int32_t>(c));
  }
  soup.face_sizes = box.face_sizes;
  const EdgeTopology welded = build_edge_topology(soup);
  EXPECT_EQ(welded.edges.size(), 12u);
  for (const TopologyEdge& edge : welded.edges) EXPECT_GE(edge.face_b, 0);

  // Two triangles that meet in a sliver without area: it takes the normal of the one along its long side.
  Mesh sliver;
  sliver.positions = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, -1, 0}, {1, 1, 1}};
  sliver.corner_vertices = {0, 3, 1, 0, 1, 2, 0, 2, 4};
  sliver.face_sizes = {3, 3, 3};
  const EdgeTopology bridged = build_edge_topology(sliver);
  EXPECT_EQ(bridged.flat_faces, 0);
  EXPECT_GT(glm::dot(bridged.face_normals[1], bridged.face_normals[0]), 0.0);
  // Three sheets on one edge.
  Mesh book;
  book.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
  book.corner_vertices = {0, 1, 2, 0, 1, 3, 0, 1, 4};
  book.face_sizes = {3, 3, 3};
  EXPECT_EQ(build_edge_topology(book).non_manifold, 1);
}

}  // namespace
}  // namespace limn
