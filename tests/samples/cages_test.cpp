// The built-in scenes, by what can be counted: closed cages of the genus they claim, creases, unusual vertices.

#include <gtest/gtest.h>

#include <map>

#include "samples/scenes/scenes.h"
#include "subdiv/mesh_audit.h"

namespace limn {
namespace {

const Mesh& cage_of_object(const Scene& scene, size_t index) { return std::get<MeshSource>(scene.objects.at(index).source).mesh; }

struct Topology {
  int euler = 0;
  int open_edges = 0, bad_edges = 0, turned_edges = 0;
  double volume = 0.0;
};

Topology topology_of(const Mesh& mesh) {
  Topology topology;
  const auto edges = build_edges(mesh);
  for (const Edge& edge : edges) {
    topology.open_edges += edge.face_count == 1;
    topology.bad_edges += edge.face_count > 2;
    topology.turned_edges += !edge.consistent;
  }
  topology.euler = static_cast<int>(mesh.vertex_count()) - static_cast<int>(edges.size()) + static_cast<int>(mesh.face_count());
  const auto first = first_corners(mesh);
  for (size_t face = 0; face < mesh.face_count(); ++face) {
    const auto corner = [&](int k) {
      return mesh.positions[static_cast<size_t>(mesh.corner_vertices[static_cast<size_t>(first[face] + k)])];
    };
    for (int k = 2; k < mesh.face_sizes[face]; ++k) topology.volume += glm::dot(corner(0), glm::cross(corner(k - 1), corner(k))) / 6.0;
  }
  return topology;
}

struct CageCase {
  const char* scene;
  size_t object;
  int genus;
};

class Cages : public testing::TestWithParam<CageCase> {};

TEST_P(Cages, AreClosedManifoldsOfTheirGenusWithCreasesAndUnusualVertices) {
  const Scene scene = find_scene(GetParam().scene)->make();
  const Mesh& mesh = cage_of_object(scene, GetParam().object);
  validate(mesh, GetParam().scene);
  const Topology topology = topology_of(mesh);
  EXPECT_EQ(topology.open_edges, 0);
  EXPECT_EQ(topology.bad_edges, 0);
  EXPECT_EQ(topology.turned_edges, 0);
  EXPECT_EQ(topology.euler, 2 - 2 * GetParam().genus);
  EXPECT_GT(topology.volume, 0.0) << "inside out";
  EXPECT_FALSE(mesh.creases.empty());

  std::map<std::int32_t, int> valence;
  for (const Edge& edge : build_edges(mesh)) {
    ++valence[edge.vertex_a];
    ++valence[edge.vertex_b];
  }
  EXPECT_EQ(valence.size(), mesh.vertex_count()) << "unused vertices";
}

INSTANTIATE_TEST_SUITE_P(Samples, Cages,
                         testing::Values(CageCase{"teacup", 0, 1}, CageCase{"teacup", 1, 0}, CageCase{"rook", 0, 0},
                                         CageCase{"pipe_junction", 0, 3}, CageCase{"bracket", 0, 3}),
                         [](const auto& test) { return std::string(test.param.scene) + std::to_string(test.param.object); });

TEST(Scenes, HaveNamesHelpAndSomethingToFrame) {
  std::map<std::string, int> names;
  for (const SceneDescriptor& scene : scenes()) {
    ++names[scene.about.name];
    EXPECT_FALSE(scene.about.help.empty());
    const Scene made = scene.make();
    ASSERT_FALSE(made.objects.empty()) << scene.about.name;
    EXPECT_TRUE(bounds(made).finite()) << scene.about.name;
    EXPECT_NO_THROW(resolve_camera(made.camera, bounds(made))) << scene.about.name;
  }
  for (const auto& [name, count] : names) EXPECT_EQ(count, 1) << name;
}

}  // namespace
}  // namespace limn
