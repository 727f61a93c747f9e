#include <algorithm>
#include <cmath>
#include <numbers>

#include "subdiv/opensubdiv_cage.h"

namespace limn {
namespace {

using Row = std::vector<double>;

double dot(const Row& a, const Row& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}
void add(Row& a, double factor, const Row& b) {
  for (size_t i = 0; i < a.size(); ++i) a[i] += factor * b[i];
}

/// Subdivision of a closed one-ring: row i holds the weights of the new point i. Points: centre, n edge neighbours, n diagonals.
std::vector<Row> subdivision_matrix(size_t n, const std::vector<float>& sharpness, Scheme scheme) {
  const size_t size = scheme == Scheme::loop ? n + 1 : 2 * n + 1;
  std::vector<Row> s(size, Row(size, 0.0));
  const double count = static_cast<double>(n);
  const auto sharp = [&sharpness](size_t i) { return sharpness[i] >= kInfiniteSharpness; };
  if (scheme == Scheme::loop) {
    // Loop 1987.
    const double c = 0.375 + 0.25 * std::cos(2.0 * std::numbers::pi / count), beta = (0.625 - c * c) / count;
    s[0][0] = 1.0 - count * beta;
    for (size_t i = 0; i < n; ++i) {
      s[0][1 + i] += beta;
      s[1 + i][0] = s[1 + i][1 + i] = sharp(i) ? 0.5 : 0.375;
      if (sharp(i)) continue;
      s[1 + i][1 + (i + 1) % n] += 0.125;
      s[1 + i][1 + (i + n - 1) % n] += 0.125;
    }
    return s;
  }
  // Catmull & Clark 1978; face i lies between edges i and i + 1.
  for (size_t i = 0; i < n; ++i)
    for (const size_t corner : {size_t{0}, 1 + i, 1 + (i + 1) % n, 1 + n + i}) s[1 + n + i][corner] += 0.25;
  s[0][0] = (count - 2.0) / count;
  for (size_t i = 0; i < n; ++i) {
    s[0][1 + i] += 1.0 / (count * count);
    add(s[0], 1.0 / (count * count), s[1 + n + i]);
    s[1 + i][0] = s[1 + i][1 + i] = sharp(i) ? 0.5 : 0.25;
    if (sharp(i)) continue;
    add(s[1 + i], 0.25, s[1 + n + i]);
    add(s[1 + i], 0.25, s[1 + n + (i + n - 1) % n]);
  }
  return s;
}

Row times(const Row& row, const std::vector<Row>& matrix) {
  Row result(row.size(), 0.0);
  for (size_t i = 0; i < row.size(); ++i)
    if (row[i] != 0.0) add(result, row[i], matrix[i]);
  return result;
}

glm::dvec3 weighted(const Row& row, const std::vector<glm::dvec3>& points) {
  glm::dvec3 sum(0.0);
  for (size_t i = 0; i < row.size(); ++i) sum += row[i] * points[i];
  return sum;
}

}  // namespace

// Doo & Sabin 1978: the limit is the left eigenvector of eigenvalue 1, the tangent plane the left invariant subspace of the next two.
// Both by power iteration, the second with the first taken out: the matrix is small and darts are few.
VertexLimit dart_limit(const OneRing& ring, Scheme scheme) {
  const size_t n = ring.face_total;
  const std::vector<Row> s = subdivision_matrix(n, ring.sharpness, scheme);
  std::vector<glm::dvec3> points{ring.center};
  points.insert(points.end(), ring.edges.begin(), ring.edges.end());
  points.insert(points.end(), ring.diagonals.begin(), ring.diagonals.end());

  constexpr int kIterations = 400;
  Row limit(s.size(), 0.0);
  limit[0] = 1.0;
  for (int k = 0; k < kIterations; ++k) limit = times(limit, s);

  Row tangents[2] = {Row(s.size(), 0.0), Row(s.size(), 0.0)};
  for (size_t i = 0; i < n; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n) + 0.3;
    tangents[0][1 + i] = std::cos(angle), tangents[1][1 + i] = std::sin(angle);
  }
  const Row ones(s.size(), 1.0);
  for (int k = 0; k < kIterations; ++k) {
    for (Row& row : tangents) {
      row = times(row, s);
      add(row, -dot(row, ones), limit);
    }
    add(tangents[1], -dot(tangents[1], tangents[0]) / dot(tangents[0], tangents[0]), tangents[0]);
    for (Row& row : tangents) {
      const double length = std::sqrt(dot(row, row));
      for (double& weight : row) weight /= length;
    }
  }
  return {weighted(limit, points), weighted(tangents[0], points), weighted(tangents[1], points)};
}

}  // namespace limn
