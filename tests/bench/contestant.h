#pragma once
// The contestants of the marching benchmark: each draws the same picture from the same rays.

#include <hwy/aligned_allocator.h>

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "raymarch/surface.h"
#include "sdf/camera.h"
#include "sdf/level_set.h"

namespace limn::bench {

/// What every contestant has to fill, 16 bytes a pixel: distance along the ray (infinite for a miss) and the unit normal (x, y, z).
struct Frame {
  int width = 0, height = 0;
  hwy::AlignedFreeUniquePtr<float[]> distance{};
  hwy::AlignedFreeUniquePtr<float[]> normal{};  ///< Three a pixel.

  Frame(int width_px, int height_px);
  size_t pixels() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
  glm::vec3 normal_at(size_t i) const { return {normal[3 * i], normal[3 * i + 1], normal[3 * i + 2]}; }
  void hit(size_t i, float t, const glm::vec3& n) {
    distance[i] = t;
    normal[3 * i] = n.x, normal[3 * i + 1] = n.y, normal[3 * i + 2] = n.z;
  }
  void miss(size_t i) { hit(i, std::numeric_limits<float>::infinity(), glm::vec3(0.0f)); }
};
/// FNV-1a over a picture's bytes: whether two runs gave the same.
std::string checksum(const Frame& frame);

enum class Role { ours, peer, floor };
/// Which surface a contestant draws: that of the grid (for shapes of closed form: that form), or the mesh that the grid was made from.
enum class Drawn { grid, original, nothing };

struct Contestant {
  std::string key{};   ///< Short, for the summary: "limn.central".
  std::string name{};  ///< For the table.
  Role role = Role::peer;
  Drawn drawn = Drawn::grid;
  std::function<void()> draw{};        ///< Timed. Uses as many threads as the surrounding task arena has.
  std::function<void(Frame&)> take{};  ///< Untimed: hands the last picture over.
};

/// Rays of a pinhole by linear forms: what a renderer computes once a picture, so that no contestant pays for double precision a pixel.
template <class T>
struct RayForms {
  glm::vec<3, T> eye{}, corner{}, right{}, down{};
  /// Unit; through the middle of pixel (x, y).
  glm::vec<3, T> direction(int x, int y) const {
    const glm::vec<3, T> d = corner + static_cast<T>(x) * right + static_cast<T>(y) * down;
    return d * (T(1) / std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z));
  }
};
RayForms<double> ray_forms(const Camera& camera);
RayForms<float> single(const RayForms<double>& forms);

/// One object at one resolution.
struct BenchCase {
  std::string object{};
  int voxels = 0;
  double voxel_size = 0.0;  ///< World.
  Camera camera{};
  Scene scene{};  ///< The object itself: a field, or a mesh taken as it is.
  LevelSet level_set;
  LevelSet wide_level_set;  ///< The same with the band that cubic normals need.
  TriangleMesh original{};  ///< The mesh that the grid was made from; of a field a fine regular one.
};

/// Calls `tile(x0, y0, x1, y1)` for squares of 16 pixels, on the threads of the surrounding arena.
template <class Work>
void for_each_tile(int width, int height, const Work& tile);

std::vector<Contestant> vdb_peers(const BenchCase& bench_case);
std::vector<Contestant> embree_peers(const BenchCase& bench_case);
std::vector<Contestant> limn_contestants(const BenchCase& bench_case);
Contestant limn_surface(const std::string& key, const std::string& name, const Scene& scene, const SurfaceSettings& settings,
                        const Camera& camera, Drawn drawn);
/// The memory-write floor, and for a sphere its closed form in SIMD.
std::vector<Contestant> floors(const BenchCase& bench_case);
Contestant write_floor(const Camera& camera);
Contestant closed_form_sphere(const Camera& camera, const glm::dvec3& center, double radius);

/// What the grid of a case takes.
struct GridCost {
  double openvdb_bytes = 0.0, nanovdb_bytes = 0.0;
  double nanovdb_conversion_ms = 0.0;      ///< Best of five, on two threads.
  double ours_bytes = 0.0, ours_ms = 0.0;  ///< The ray-ready form, as measured the same way.
};
GridCost vdb_cost(const BenchCase& bench_case);
void add_our_cost(const BenchCase& bench_case, GridCost& cost);

}  // namespace limn::bench

#include "tests/bench/tiles.h"
