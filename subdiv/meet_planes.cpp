#include <algorithm>
#include <array>
#include <cmath>

#include "subdiv/surface_snap.h"

namespace limn {
namespace {

struct Eigen {
  glm::dvec3 values{0.0};
  glm::dmat3 vectors{1.0};  ///< Columns.
};

/// Jacobi rotations (Golub & Van Loan 1996, section 8.4): a symmetric 3x3 matrix settles in a few sweeps.
Eigen eigen_of(glm::dmat3 m) {
  Eigen result;
  for (int sweep = 0; sweep < 12; ++sweep)
    for (const auto& [p, q] : {std::array{0, 1}, std::array{0, 2}, std::array{1, 2}}) {
      if (std::abs(m[p][q]) <= 1e-18 * (std::abs(m[p][p]) + std::abs(m[q][q]))) continue;
      const double theta = 0.5 * (m[q][q] - m[p][p]) / m[p][q];
      const double t = (theta >= 0.0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
      const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
      glm::dmat3 rotation(1.0);
      rotation[p][p] = rotation[q][q] = c;
      rotation[q][p] = s, rotation[p][q] = -s;
      m = glm::transpose(rotation) * m * rotation;
      result.vectors = result.vectors * rotation;
    }
  result.values = {m[0][0], m[1][1], m[2][2]};
  return result;
}

}  // namespace

glm::dvec3 meet_planes(const std::vector<glm::dvec3>& points, const std::vector<glm::dvec3>& normals, const glm::dvec3& start) {
  glm::dmat3 matrix(0.0);
  glm::dvec3 right(0.0);
  for (size_t i = 0; i < points.size(); ++i) {
    matrix += glm::outerProduct(normals[i], normals[i]);
    right += glm::dot(normals[i], points[i] - start) * normals[i];
  }
  const Eigen eigen = eigen_of(matrix);
  const double largest = std::max({eigen.values.x, eigen.values.y, eigen.values.z});
  glm::dvec3 step(0.0);
  for (int i = 0; i < 3; ++i)
    if (eigen.values[i] > 0.01 * largest) step += glm::dot(eigen.vectors[i], right) / eigen.values[i] * eigen.vectors[i];
  return start + step;
}

}  // namespace limn
