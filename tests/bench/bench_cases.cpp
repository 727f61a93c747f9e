#include "tests/bench/bench_cases.h"

#include <filesystem>
#include <numbers>

#include "samples/scenes/scenes.h"
#include "sdf/error.h"
#include "subdiv/import.h"
#include "subdiv/mesh_level_set.h"
#include "subdiv/refine.h"

namespace limn::bench {
namespace {

constexpr double kTorusMajor = 0.7, kTorusMinor = 0.3;
constexpr unsigned kAround = 1024, kAcross = 512;  // a million triangles

/// A closed regular mesh of points at(u, v), both in [0, 1] and u periodic. `rows`: how many there are with points of their own; the
/// vertices of row j are those of row j % rows. Triangles without area, as at a sphere's poles, are left out.
template <class At>
TriangleMesh regular_mesh(unsigned rows, const At& at) {
  TriangleMesh mesh;
  for (unsigned j = 0; j < rows; ++j)
    for (unsigned i = 0; i < kAround; ++i) mesh.positions.push_back(at(static_cast<double>(i) / kAround, static_cast<double>(j) / kAcross));
  const auto vertex = [&](unsigned i, unsigned j) {
    const unsigned first = j % rows * kAround, index = first + i % kAround;
    // All of a pole's are one.
    return mesh.positions[index] == mesh.positions[first] ? first : index;
  };
  const auto add = [&mesh](unsigned a, unsigned b, unsigned c) {
    if (a != b && b != c && c != a) mesh.triangles.emplace_back(a, b, c);
  };
  for (unsigned j = 0; j < kAcross; ++j) {
    for (unsigned i = 0; i < kAround; ++i) {
      const unsigned a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i, j + 1), d = vertex(i + 1, j + 1);
      add(a, b, d);
      add(a, d, c);
    }
  }
  return mesh;
}

TriangleMesh sphere_mesh() {
  return regular_mesh(kAcross + 1, [](double u, double v) {
    const double p = 2.0 * std::numbers::pi * u, t = std::numbers::pi * v;
    const double ring = v < 1.0 ? std::sin(t) : 0.0;
    return glm::dvec3(ring * std::sin(p), -std::cos(t), ring * std::cos(p));
  });
}

TriangleMesh torus_mesh() {
  return regular_mesh(kAcross, [](double u, double v) {
    const double p = 2.0 * std::numbers::pi * u, t = 2.0 * std::numbers::pi * v;
    const double ring = kTorusMajor + kTorusMinor * std::cos(t);
    return glm::dvec3(ring * std::sin(p), kTorusMinor * std::sin(t), ring * std::cos(p));
  });
}

BenchObject from_mesh(const std::string& name, TriangleMesh mesh) {
  Box box;
  for (const glm::uvec3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) box = include(box, mesh.positions[t[k]]);
  for (glm::dvec3& p : mesh.positions) p = (p - box.center()) * (2.0 / box.longest_side());
  BenchObject object;
  object.name = name;
  object.mesh = std::move(mesh);
  return object;
}

}  // namespace

BenchObject bench_object(const std::string& name) {
  BenchObject object;
  object.name = name;
  if (name == "sphere") {
    object.field = make_shape("sphere", {{"radius", {1.0}}});
    object.mesh = sphere_mesh();
    object.closed_form = true_sphere(1.0);
    return object;
  }
  if (name == "torus") {
    object.field = make_shape("torus", {{"major", {kTorusMajor}}, {"minor", {kTorusMinor}}});
    object.mesh = torus_mesh();
    object.closed_form = true_torus(kTorusMajor, kTorusMinor);
    return object;
  }
  const SceneDescriptor* found = find_scene(name);
  const Scene scene = found ? found->make() : Scene{};
  for (const SceneObject& cage : scene.objects) {
    const MeshSource* source = std::get_if<MeshSource>(&cage.source);
    if (!source || !source->scheme) continue;
    constexpr int kLevel = 4;
    return from_mesh(name,
                     triangulate(refine(source->mesh, {.scheme = *source->scheme, .level = kLevel}, source->file), NormalKind::vertex));
  }
  throw InputError({{}, "--object", name, "no such object", "sphere, torus, or a built-in scene with a subdivision cage"});
}

BenchObject bench_mesh_file(const std::string& file) {
  return from_mesh(std::filesystem::path(file).stem().string(), triangulate(load_mesh(file), NormalKind::vertex));
}

BenchCase bench_case(const BenchObject& object, int voxels, int width_px, int height_px) {
  Scene scene;
  if (object.field) {
    scene.objects.push_back({.name = object.name, .source = *object.field});
  } else {
    Mesh mesh;
    mesh.positions = object.mesh.positions;
    mesh.face_sizes.assign(object.mesh.triangles.size(), 3);
    for (const glm::uvec3& t : object.mesh.triangles)
      for (int k = 0; k < 3; ++k) mesh.corner_vertices.push_back(static_cast<std::int32_t>(t[k]));
    scene.objects.push_back({.name = object.name, .source = MeshSource{.mesh = std::move(mesh)}});
  }
  scene.camera.width_px = width_px;
  scene.camera.height_px = height_px;
  const Camera camera = resolve_camera(scene.camera, bounds(scene));
  const double voxel_size = bounds(scene).longest_side() / voxels;
  const auto grid = [&](double half_width) {
    const LevelSetSettings settings{.voxel_size = voxel_size, .half_width_voxels = half_width};
    return object.field ? level_set_from_field(*object.field, settings) : level_set_from_mesh(object.mesh, settings).level_set;
  };
  constexpr double kUsualHalfWidth = 3.0;
  return {object.name, voxels, voxel_size, camera, scene, grid(kUsualHalfWidth), grid(find_gradient("cubic").half_width_voxels),
          object.mesh};
}

}  // namespace limn::bench
