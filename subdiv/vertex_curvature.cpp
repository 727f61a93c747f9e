#include "subdiv/vertex_curvature.h"

#include <algorithm>
#include <cmath>

#include "subdiv/fair_mesh.h"

namespace limn {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

constexpr double kSingular = 1e-12;  // of the product of the diagonal: a sliver's equations say nothing across it

/// A triangle's plane: unit x and y along it.
struct Frame {
  glm::dvec3 x{0.0}, y{0.0}, normal{0.0};
  bool valid = false;
  glm::dvec2 in(const glm::dvec3& v) const { return {glm::dot(v, x), glm::dot(v, y)}; }
};

Frame frame_of(const std::vector<glm::dvec3>& positions, const Triangle& t) {
  Frame frame;
  const glm::dvec3 e = positions[t[1]] - positions[t[0]], f = positions[t[2]] - positions[t[0]], cross = glm::cross(e, f);
  const double length = glm::length(cross), side = glm::length(e);
  if (!(length > 0.0 && side > 0.0)) return frame;
  frame.normal = cross / length;
  frame.x = e / side;
  frame.y = glm::cross(frame.normal, frame.x);
  frame.valid = true;
  return frame;
}

/// The shortest turn that takes the unit vector `from` to `to`; the identity where they are opposite.
glm::dmat3 turn_between(const glm::dvec3& from, const glm::dvec3& to) {
  const double cosine = glm::dot(from, to);
  if (!(cosine > -1.0 + 1e-9)) return glm::dmat3(1.0);
  const glm::dvec3 axis = glm::cross(from, to);
  const glm::dmat3 across(0.0, axis.z, -axis.y, -axis.z, 0.0, axis.x, axis.y, -axis.x, 0.0);
  return glm::dmat3(1.0) + across + across * across / (1.0 + cosine);
}

/// What of each corner's vertex is the triangle's own: Voronoi areas, halved and quartered where it is obtuse (Meyer, Desbrun, Schroeder &
/// Barr 2003).
std::array<double, 3> corner_areas(const std::vector<glm::dvec3>& positions, const Triangle& t) {
  std::array<glm::dvec3, 3> e;  // Opposite to each corner.
  for (size_t k = 0; k < 3; ++k) e[k] = positions[t[(k + 2) % 3]] - positions[t[(k + 1) % 3]];
  const double area = 0.5 * glm::length(glm::cross(e[0], e[1]));
  std::array<double, 3> areas{};
  for (size_t k = 0; k < 3; ++k) {
    if (glm::dot(e[(k + 1) % 3], e[(k + 2) % 3]) >= 0.0) {
      areas.fill(0.25 * area);
      areas[k] = 0.5 * area;
      return areas;
    }
  }
  // The squares of the sides at a corner, each times the cotangent of the angle opposite to it, are eight times its area.
  const auto part = [&](size_t k) { return -glm::dot(e[k], e[k]) * glm::dot(e[(k + 1) % 3], e[(k + 2) % 3]) / (16.0 * area); };
  for (size_t k = 0; k < 3; ++k) areas[k] = part((k + 1) % 3) + part((k + 2) % 3);
  return areas;
}

void add_normals(const std::vector<glm::dvec3>& positions, const Triangle& t, std::vector<VertexCurvature>& vertices) {
  for (size_t k = 0; k < 3; ++k) {
    const glm::dvec3 &p = positions[t[k]], a = positions[t[(k + 1) % 3]] - p, b = positions[t[(k + 2) % 3]] - p;
    const double weight = glm::dot(a, a) * glm::dot(b, b);
    if (weight > 0.0) vertices[t[k]].normal += glm::cross(a, b) / weight;
  }
}

/// The quadratic form that takes each side of the triangle to how the normal changes along it.
glm::dmat3 shape_of(const std::vector<glm::dvec3>& positions, const Triangle& t, const Frame& frame,
                    const std::vector<VertexCurvature>& vertices) {
  double uu = 0.0, uv = 0.0, vv = 0.0;
  glm::dvec3 wanted(0.0);
  for (size_t k = 0; k < 3; ++k) {
    const std::uint32_t a = t[k], b = t[(k + 1) % 3];
    const glm::dvec2 e = frame.in(positions[b] - positions[a]), n = frame.in(vertices[b].normal - vertices[a].normal);
    uu += e.x * e.x, uv += e.x * e.y, vv += e.y * e.y;
    wanted += glm::dvec3(e.x * n.x, e.y * n.x + e.x * n.y, e.y * n.y);
  }
  const glm::dmat3 squares(uu, uv, 0.0, uv, uu + vv, uv, 0.0, uv, vv);
  if (!(glm::determinant(squares) > kSingular * uu * vv * (uu + vv))) return glm::dmat3(0.0);
  const glm::dvec3 form = glm::inverse(squares) * wanted;
  return form.x * glm::outerProduct(frame.x, frame.x) + form.z * glm::outerProduct(frame.y, frame.y) +
         form.y * (glm::outerProduct(frame.x, frame.y) + glm::outerProduct(frame.y, frame.x));
}

/// The cubic form, a x^3 + 3 b x^2 y + 3 c x y^2 + d y^3 as {a, b, c, d}, that takes each side to how the quadratic form changes along it.
glm::dvec4 change_of(const std::vector<glm::dvec3>& positions, const Triangle& t, const Frame& frame,
                     const std::vector<VertexCurvature>& vertices) {
  std::array<glm::dvec3, 3> forms;  // xx, xy, yy
  for (size_t k = 0; k < 3; ++k) {
    const glm::dmat3 turn = turn_between(frame.normal, vertices[t[k]].normal);
    const glm::dvec3 x = turn * frame.x, y = turn * frame.y;
    const glm::dmat3& shape = vertices[t[k]].shape;
    forms[k] = {glm::dot(x, shape * x), glm::dot(x, shape * y), glm::dot(y, shape * y)};
  }
  double uu = 0.0, uv = 0.0, vv = 0.0;
  glm::dvec4 wanted(0.0);
  for (size_t k = 0; k < 3; ++k) {
    const glm::dvec2 e = frame.in(positions[t[(k + 1) % 3]] - positions[t[k]]);
    const glm::dvec3 d = forms[(k + 1) % 3] - forms[k];
    uu += e.x * e.x, uv += e.x * e.y, vv += e.y * e.y;
    wanted += glm::dvec4(e.x * d.x, e.y * d.x + 2.0 * e.x * d.y, 2.0 * e.y * d.y + e.x * d.z, e.y * d.z);
  }
  // Of xy there are two in the tensor.
  const glm::dmat4 squares(uu, uv, 0.0, 0.0, uv, vv + 2.0 * uu, 2.0 * uv, 0.0, 0.0, 2.0 * uv, 2.0 * vv + uu, uv, 0.0, 0.0, uv, vv);
  const double size = uu + vv;
  if (!(glm::determinant(squares) > kSingular * size * size * size * size)) return glm::dvec4(0.0);
  return glm::inverse(squares) * wanted;
}

std::array<glm::dmat3, 3> tensor_of(const glm::dvec4& form, const glm::dvec3& x, const glm::dvec3& y) {
  const glm::dmat3 xx = glm::outerProduct(x, x), yy = glm::outerProduct(y, y), xy = glm::outerProduct(x, y) + glm::outerProduct(y, x);
  const glm::dmat3 along_x = form.x * xx + form.y * xy + form.z * yy, along_y = form.y * xx + form.z * xy + form.w * yy;
  std::array<glm::dmat3, 3> tensor;
  for (int k = 0; k < 3; ++k) tensor[static_cast<size_t>(k)] = x[k] * along_x + y[k] * along_y;
  return tensor;
}

}  // namespace

std::vector<VertexCurvature> vertex_curvature(const std::vector<glm::dvec3>& positions, const std::vector<Triangle>& triangles) {
  std::vector<VertexCurvature> vertices(positions.size());
  std::vector<double> areas(positions.size(), 0.0);
  std::vector<Frame> frames(triangles.size());
  for (size_t f = 0; f < triangles.size(); ++f) {
    const Triangle& t = triangles[f];
    frames[f] = frame_of(positions, t);
    if (!frames[f].valid) continue;
    add_normals(positions, t, vertices);
    const std::array<double, 3> own = corner_areas(positions, t);
    for (size_t k = 0; k < 3; ++k) areas[t[k]] += own[k];
  }
  for (VertexCurvature& vertex : vertices) {
    if (const double length = glm::length(vertex.normal); length > 0.0) vertex.normal /= length;
  }
  // First the shapes of all vertices, then from these how they change.
  for (const bool of_shapes : {true, false}) {
    for (size_t f = 0; f < triangles.size(); ++f) {
      const Triangle& t = triangles[f];
      if (!frames[f].valid) continue;
      const glm::dmat3 shape = of_shapes ? shape_of(positions, t, frames[f], vertices) : glm::dmat3(0.0);
      const glm::dvec4 change = of_shapes ? glm::dvec4(0.0) : change_of(positions, t, frames[f], vertices);
      const std::array<double, 3> own = corner_areas(positions, t);
      for (size_t k = 0; k < 3; ++k) {
        VertexCurvature& vertex = vertices[t[k]];
        if (!(areas[t[k]] > 0.0)) continue;
        const double weight = own[k] / areas[t[k]];
        const glm::dmat3 turn = turn_between(frames[f].normal, vertex.normal);
        if (of_shapes) {
          vertex.shape += weight * (turn * shape * glm::transpose(turn));
        } else {
          const auto tensor = tensor_of(change, turn * frames[f].x, turn * frames[f].y);
          for (size_t axis = 0; axis < 3; ++axis) vertex.change[axis] += weight * tensor[axis];
        }
      }
    }
  }
  return vertices;
}

SmoothCurvature smooth_curvature(const Mesh& triangles) {
  SmoothCurvature result{part_at_sharp_edges(triangles)};
  std::vector<glm::dvec3> positions;
  positions.reserve(result.triangles.vertex.size());
  for (const std::uint32_t vertex : result.triangles.vertex) positions.push_back(triangles.positions[vertex]);
  result.vertices = vertex_curvature(positions, result.triangles.corners);
  result.mean_edge = mean_edge(triangles);
  return result;
}

VertexCurvature curvature_between(const SmoothCurvature& curvature, size_t triangle, const glm::dvec3& weights) {
  VertexCurvature between;
  for (int k = 0; k < 3; ++k) {
    const VertexCurvature& corner = curvature.vertices[curvature.triangles.corners[triangle][static_cast<size_t>(k)]];
    between.normal += weights[k] * corner.normal;
    between.shape += weights[k] * corner.shape;
    for (size_t axis = 0; axis < 3; ++axis) between.change[axis] += weights[k] * corner.change[axis];
  }
  return between;
}

double change_along(const VertexCurvature& curvature, const glm::dvec3& tangent) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) sum += tangent[axis] * glm::dot(tangent, curvature.change[static_cast<size_t>(axis)] * tangent);
  return sum;
}

}  // namespace limn
