#include "subdiv/fair_mesh.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "sdf/parallel.h"
#include "subdiv/sharp_edges.h"

namespace limn {
namespace {

using Complex = std::complex<double>;
using Matrix = Eigen::SparseMatrix<Complex, Eigen::RowMajor>;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;

// Cotangents of slivers would tie their vertices together, or push them apart. That of an equilateral triangle is 0.58.
constexpr double kLeastCotangent = 0.02, kMostCotangent = 10.0;
constexpr double kTolerance = 1e-8;  // of the right-hand side

/// Vertices tied by springs; each stands for so much of the surface, or of a crease.
struct Springs {
  struct Spring {
    std::int32_t a = 0, b = 0;
    double weight = 0.0;
  };
  std::vector<Spring> all{};     ///< Two vertices may have several.
  std::vector<double> shares{};  ///< Of each vertex; 0 where it is none of them.
};

Springs springs_of_surface(const Mesh& mesh) {
  Springs springs;
  springs.shares.assign(mesh.positions.size(), 0.0);
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const std::int32_t* const corners = &mesh.corner_vertices[3 * f];
    for (size_t k = 0; k < 3; ++k) {
      const std::int32_t at = corners[k], next = corners[(k + 1) % 3], last = corners[(k + 2) % 3];
      const glm::dvec3 &p = mesh.positions[static_cast<size_t>(at)], a = mesh.positions[static_cast<size_t>(next)] - p,
                       b = mesh.positions[static_cast<size_t>(last)] - p;
      const double twice_area = glm::length(glm::cross(a, b));
      const double cotangent = twice_area > 0.0 ? glm::dot(a, b) / twice_area : kMostCotangent;
      springs.all.push_back({next, last, 0.5 * std::clamp(cotangent, kLeastCotangent, kMostCotangent)});
      springs.shares[static_cast<size_t>(at)] += twice_area / 6.0;
    }
  }
  return springs;
}

Springs springs_along(const std::vector<std::pair<std::int32_t, std::int32_t>>& edges, const std::vector<glm::dvec3>& positions) {
  Springs springs;
  springs.shares.assign(positions.size(), 0.0);
  for (const auto& [a, b] : edges) {
    const double length = glm::distance(positions[static_cast<size_t>(a)], positions[static_cast<size_t>(b)]);
    if (!(length > 0.0)) continue;
    springs.all.push_back({a, b, 1.0 / length});
    for (const std::int32_t v : {a, b}) springs.shares[static_cast<size_t>(v)] += 0.5 * length;
  }
  return springs;
}

/// Moves those marked in `moves` to where |x - x0|^2 + (t Laplacian x)^2, added up by their shares, is least. The others hold them.
void settle(const Springs& springs, const std::vector<char>& moves, double t, std::vector<glm::dvec3>& positions) {
  std::vector<Eigen::Index> place(positions.size(), -1);
  std::vector<size_t> vertices;
  for (size_t v = 0; v < positions.size(); ++v) {
    if (moves[v] == 0 || !(springs.shares[v] > 0.0)) continue;
    place[v] = static_cast<Eigen::Index>(vertices.size());
    vertices.push_back(v);
  }
  const auto count = static_cast<Eigen::Index>(vertices.size());
  if (count == 0) return;
  Columns start(count, 3), held = Columns::Zero(count, 3);
  Eigen::VectorXd shares(count), ties = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const glm::dvec3& p = positions[vertices[static_cast<size_t>(i)]];
    start.row(i) << p.x, p.y, p.z;
    shares[i] = springs.shares[vertices[static_cast<size_t>(i)]];
  }
  std::vector<Eigen::Triplet<Complex>> entries;
  for (const auto& [a, b, weight] : springs.all) {
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
      const Eigen::Index row = place[static_cast<size_t>(from)], column = place[static_cast<size_t>(to)];
      if (row < 0) continue;
      ties[row] += weight;
      const glm::dvec3& p = positions[static_cast<size_t>(to)];
      if (column < 0) {
        held.row(row) += weight * Eigen::RowVector3d(p.x, p.y, p.z);
      } else {
        entries.emplace_back(row, column, Complex(0.0, -t * weight));
      }
    }
  }
  for (Eigen::Index i = 0; i < count; ++i) entries.emplace_back(i, i, Complex(shares[i], t * ties[i]));
  Matrix system(count, count);
  system.setFromTriplets(entries.begin(), entries.end());
  // 1 / (1 + s^2) is the real part of 1 / (1 + i s): of the Laplacian itself, whose matrix is far better conditioned than its square's.
  parallel_each(Eigen::Index{3}, [&](Eigen::Index column) {
    Eigen::BiCGSTAB<Matrix> solver(system);
    solver.setTolerance(kTolerance);
    Eigen::VectorXcd wanted(count);
    wanted.real() = shares.cwiseProduct(start.col(column));
    wanted.imag() = t * held.col(column);
    const Eigen::VectorXcd guess = start.col(column).cast<Complex>();
    start.col(column) = Eigen::VectorXcd(solver.solveWithGuess(wanted, guess)).real();
  });
  for (Eigen::Index i = 0; i < count; ++i) positions[vertices[static_cast<size_t>(i)]] = {start(i, 0), start(i, 1), start(i, 2)};
}

}  // namespace

double mean_edge(const Mesh& triangles) {
  double sum = 0.0;
  const std::vector<std::int32_t>& corners = triangles.corner_vertices;
  for (size_t c = 0; c < corners.size(); ++c)
    sum += glm::distance(triangles.positions[static_cast<size_t>(corners[c])],
                         triangles.positions[static_cast<size_t>(corners[c % 3 == 2 ? c - 2 : c + 1])]);
  return corners.empty() ? 0.0 : sum / static_cast<double>(corners.size());
}

std::vector<glm::dvec3> faired_positions(const Mesh& triangles, double wavelength) {
  std::vector<glm::dvec3> positions = triangles.positions;
  // A wave of wave number k keeps 1 / (1 + (t k^2)^2) of its height.
  const double wave_number = 2.0 * std::numbers::pi / wavelength, t = 1.0 / (wave_number * wave_number);
  const auto sharp = sharp_edges(triangles);
  std::vector<int> meeting(positions.size(), 0);
  for (const auto& [a, b] : sharp) ++meeting[static_cast<size_t>(a)], ++meeting[static_cast<size_t>(b)];
  std::vector<char> along(positions.size()), inside(positions.size());
  for (size_t v = 0; v < positions.size(); ++v) along[v] = meeting[v] == 2, inside[v] = meeting[v] == 0;
  settle(springs_along(sharp, positions), along, t, positions);
  settle(springs_of_surface(triangles), inside, t, positions);
  return positions;
}

double fair(double edges, Mesh& triangles) {
  const double wavelength = edges * mean_edge(triangles);
  drop_short_creases(wavelength, triangles);
  const std::vector<glm::dvec3> faired = faired_positions(triangles, wavelength);
  double moved = 0.0;
  for (size_t v = 0; v < faired.size(); ++v) moved = std::max(moved, glm::distance(faired[v], triangles.positions[v]));
  triangles.positions = faired;
  return moved;
}

}  // namespace limn
