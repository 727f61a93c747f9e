#include "raymarch/scene/curvature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

// Corner normals this near (cosine) belong to one sheet.
constexpr double kOneSheet = 0.9999;

/// Any unit vector across `normal`.
glm::dvec3 across(const glm::dvec3& normal) {
  const glm::dvec3 size = glm::abs(normal);
  const glm::dvec3 axis = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                          : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                               : glm::dvec3(0, 0, 1);
  return glm::normalize(glm::cross(normal, axis));
}

/// The turn that takes the unit vector a to b about their common perpendicular; the identity where they are opposite.
glm::dmat3 turn(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 v = glm::cross(a, b);
  const double c = glm::dot(a, b);
  if (!(c > -0.99)) return glm::dmat3(1.0);
  const glm::dmat3 skew(0, v.z, -v.y, -v.z, 0, v.x, v.y, -v.x, 0);
  return glm::dmat3(1.0) + skew + skew * skew / (1.0 + c);
}

/// Least squares over the three edges of a triangle: the symmetric map of the plane that takes each edge to the difference of its normals.
glm::dmat3 tensor_of_triangle(const std::array<glm::dvec3, 3>& p, const std::array<glm::dvec3, 3>& n, const glm::dvec3& facet) {
  const glm::dvec3 u = across(facet), v = glm::cross(facet, u);
  glm::dmat3 normal_equations(0.0);
  glm::dvec3 right(0.0);
  for (size_t i = 0; i < 3; ++i) {
    const glm::dvec3 edge = p[(i + 1) % 3] - p[i], change = n[(i + 1) % 3] - n[i];
    const glm::dvec3 row_u(glm::dot(edge, u), glm::dot(edge, v), 0.0), row_v(0.0, row_u.x, row_u.y);
    normal_equations += glm::outerProduct(row_u, row_u) + glm::outerProduct(row_v, row_v);
    right += glm::dot(change, u) * row_u + glm::dot(change, v) * row_v;
  }
  const glm::dvec3 efg = glm::inverse(normal_equations) * right;
  return efg.x * glm::outerProduct(u, u) + efg.y * (glm::outerProduct(u, v) + glm::outerProduct(v, u)) + efg.z * glm::outerProduct(v, v);
}

/// The part of a triangle's area that is nearest to each corner; of an obtuse one half goes to the obtuse corner (Meyer et al. 2003).
glm::dvec3 corner_areas(const std::array<glm::dvec3, 3>& p, double area) {
  glm::dvec3 squared, cotangent;
  for (int i = 0; i < 3; ++i) {
    const auto a = static_cast<size_t>(i), b = static_cast<size_t>((i + 1) % 3), c = static_cast<size_t>((i + 2) % 3);
    const glm::dvec3 opposite = p[c] - p[b];
    squared[i] = glm::dot(opposite, opposite);
    cotangent[i] = glm::dot(p[b] - p[a], p[c] - p[a]) / (2.0 * area);
  }
  glm::dvec3 share;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    if (cotangent[i] < 0.0) {
      share[i] = 0.5 * area;
    } else if (cotangent[j] < 0.0 || cotangent[k] < 0.0) {
      share[i] = 0.25 * area;
    } else {
      share[i] = 0.125 * (squared[j] * cotangent[j] + squared[k] * cotangent[k]);
    }
  }
  return share;
}

/// What a triangle gives to its corners: tensors turned to their normals, times their weights.
struct TriangleShares {
  std::array<glm::dmat3, 3> tensors;
  glm::dvec3 weights;
  bool valid = false;  ///< False of a triangle without area.
};
constexpr size_t kSharesTogether = size_t{1} << 14;

TriangleShares shares_of(const TriangleMesh& mesh, size_t t, const std::vector<std::uint32_t>& of_corner,
                         const std::vector<glm::dvec3>& normals) {
  TriangleShares shares;
  std::array<glm::dvec3, 3> p, n;
  for (size_t i = 0; i < 3; ++i) {
    p[i] = mesh.positions[mesh.triangles[t][static_cast<int>(i)]];
    n[i] = glm::dvec3(mesh.corner_normals[3 * t + i]);
  }
  const glm::dvec3 cross = glm::cross(p[1] - p[0], p[2] - p[0]);
  const double twice_area = glm::length(cross);
  if (!(twice_area > 0.0)) return shares;
  const glm::dvec3 facet = cross / twice_area;
  const glm::dmat3 tensor = tensor_of_triangle(p, n, facet);
  if (!std::isfinite(tensor[0][0] + tensor[1][1] + tensor[2][2])) return shares;
  shares.weights = corner_areas(p, 0.5 * twice_area);
  for (size_t i = 0; i < 3; ++i) {
    const glm::dmat3 onto = turn(facet, normals[of_corner[3 * t + i]]);
    shares.tensors[i] = shares.weights[static_cast<int>(i)] * (onto * tensor * glm::transpose(onto));
  }
  shares.valid = true;
  return shares;
}

/// Numbers the corners by vertex and normal; `normals` holds the first normal met of each number.
std::vector<std::uint32_t> number_corners(const TriangleMesh& mesh, std::vector<glm::dvec3>& normals) {
  constexpr auto none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> first(mesh.positions.size(), none), next, number(3 * mesh.triangles.size());
  for (size_t corner = 0; corner < number.size(); ++corner) {
    const std::uint32_t vertex = mesh.triangles[corner / 3][static_cast<int>(corner % 3)];
    const glm::dvec3 normal(mesh.corner_normals[corner]);
    std::uint32_t found = first[vertex];
    while (found != none && glm::dot(normals[found], normal) < kOneSheet) found = next[found];
    if (found == none) {
      found = static_cast<std::uint32_t>(normals.size());
      normals.push_back(normal);
      next.push_back(first[vertex]);
      first[vertex] = found;
    }
    number[corner] = found;
  }
  return number;
}

}  // namespace

SurfaceCurvature no_curvature() {
  SurfaceCurvature none;
  none.k1 = none.k2 = std::numeric_limits<double>::quiet_NaN();
  return none;
}

SurfaceCurvature curvature_of_tensor(const glm::dmat3& tensor, const glm::dvec3& normal) {
  SurfaceCurvature result;
  result.normal = normal;
  const glm::dvec3 u = across(normal), v = glm::cross(normal, u);
  set_principal(result, u, v, glm::dot(u, tensor * u), glm::dot(u, tensor * v), glm::dot(v, tensor * v));
  return result;
}

SurfaceCurvature curvature_of_jet(const FieldJet& jet) {
  const double length = glm::length(jet.gradient);
  if (!(length > 0.0) || !std::isfinite(length)) return no_curvature();
  return curvature_of_tensor(jet.hessian / length, jet.gradient / length);
}

SurfaceCurvature facing(SurfaceCurvature surface, const glm::dvec3& outward) {
  if (glm::dot(surface.normal, outward) >= 0.0) return surface;
  const glm::dvec3 direction2 = glm::cross(surface.normal, surface.direction1);
  return {-surface.normal, -surface.k2, -surface.k1, direction2};
}

CornerTensors corner_tensors(const TriangleMesh& mesh) {
  LIMN_CHECK(mesh.corner_normals.size() == 3 * mesh.triangles.size());
  CornerTensors result;
  std::vector<glm::dvec3> normals;
  result.of_corner = number_corners(mesh, normals);
  result.tensors.assign(normals.size(), glm::dmat3(0.0));
  std::vector<double> weights(normals.size(), 0.0);
  // Threads find the triangles' shares, which are added up in the triangles' order.
  std::vector<TriangleShares> shares(std::min(kSharesTogether, mesh.triangles.size()));
  for (size_t first = 0; first < mesh.triangles.size(); first += shares.size()) {
    const size_t count = std::min(shares.size(), mesh.triangles.size() - first);
    parallel_for(size_t{0}, count, [&](size_t k) { shares[k] = shares_of(mesh, first + k, result.of_corner, normals); });
    for (size_t corner = 0; corner < 3 * count; ++corner) {
      const TriangleShares& share = shares[corner / 3];
      if (!share.valid) continue;
      const std::uint32_t group = result.of_corner[3 * first + corner];
      result.tensors[group] += share.tensors[corner % 3];
      weights[group] += share.weights[static_cast<int>(corner % 3)];
    }
  }
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] > 0.0) result.tensors[i] /= weights[i];
  }
  return result;
}

}  // namespace limn
