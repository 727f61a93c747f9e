#pragma once
// What each ray really meets, and how wrong a contestant's picture is.

#include <functional>
#include <vector>

#include "tests/bench/contestant.h"

namespace limn::bench {

/// The lowest value of a distance on a stretch of a ray (negative inside), and where; world units.
struct Lowest {
  double value = std::numeric_limits<double>::infinity(), t = 0.0;
};

/// A surface by closed form or by exhaustive search, in double precision.
struct TrueSurface {
  struct Hit {
    double t = std::numeric_limits<double>::infinity();
    glm::dvec3 normal{0.0};
  };
  std::function<Hit(const glm::dvec3& origin, const glm::dvec3& direction)> first_hit{};
  std::function<Lowest(const glm::dvec3& origin, const glm::dvec3& direction, double from, double to)> lowest{};
};

/// The picture that a perfect contestant would draw.
struct TruePicture {
  TrueSurface surface{};
  std::vector<double> distance{};
  std::vector<glm::dvec3> normal{};
};

TrueSurface true_sphere(double radius);
/// About the y axis.
TrueSurface true_torus(double major, double minor);
/// The zero surface of the grid's trilinear values, cell by cell; normals by central differences, interpolated.
TrueSurface true_grid_surface(const LevelSet& level_set);
/// The triangles themselves.
TrueSurface true_mesh(const TriangleMesh& mesh);
TruePicture true_picture(TrueSurface surface, const Camera& camera);

struct Accuracy {
  std::int64_t hits = 0;
  std::int64_t wrong_hits = 0;     ///< Hits where there is nothing, misses where there is something.
  double farthest_wrong_px = 0.0;  ///< How far from the true silhouette the worst of them is.
  std::int64_t through = 0;        ///< Hits behind a place where the ray is inside by more than 0.05 px.
  double normal_p99_deg = 0.0, depth_p99_voxels = 0.0;
};
Accuracy judge(const Frame& frame, const TruePicture& truth, const Camera& camera, double voxel_size);

}  // namespace limn::bench
