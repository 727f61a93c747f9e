#include "subdiv/block_potential.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "subdiv/winding_border.h"

namespace limn {
namespace {

/// Samples of gradients along a side of a block.
constexpr int kFewest = 3, kMost = 6;
/// Of the cube of samples, and where its center stands off the block's: on no edge of a border whose coordinates are round numbers, where
/// the winding number has no value.
constexpr double kHalfSide_voxels = 3.52;
constexpr glm::dvec3 kOffMiddle_voxels{0.0131, -0.0173, 0.0117};

/// Where they stand, half sides from the middle: where Chebyshev's polynomial of that degree vanishes, so that of a term of that order
/// 2^(1 - n) is left at most.
double sample_place(int k, int n) { return -std::cos((k + 0.5) * std::numbers::pi / n); }
double node_place(int node, int axis) { return (node - 3.5 - kOffMiddle_voxels[axis]) / kHalfSide_voxels; }

/// table[k][i]: what the k-th number along an axis adds to the i-th.
using AxisTable = std::vector<std::vector<double>>;

/// Coefficients of 1, x, x^2 ... of the polynomial through n samples (Lagrange).
AxisTable coefficients_of_samples(int n) {
  AxisTable table;
  for (int k = 0; k < n; ++k) {
    std::vector<double> coefficients{1.0};
    for (int i = 0; i < n; ++i) {
      if (i == k) continue;
      // Times (x - place) / (own place - place).
      const double place = sample_place(i, n), scale = 1.0 / (sample_place(k, n) - place);
      coefficients.push_back(0.0);
      for (size_t p = coefficients.size(); p-- > 0;)
        coefficients[p] = scale * ((p > 0 ? coefficients[p - 1] : 0.0) - place * coefficients[p]);
    }
    table.push_back(std::move(coefficients));
  }
  return table;
}

/// Values at nodes of 1, x, x^2 ..., so many.
AxisTable powers_at_nodes(int count, int axis) {
  AxisTable table(static_cast<size_t>(count), std::vector<double>(8, 1.0));
  for (size_t k = 1; k < table.size(); ++k)
    for (size_t node = 0; node < 8; ++node) table[k][node] = table[k - 1][node] * node_place(static_cast<int>(node), axis);
  return table;
}

/// Numbers of a cube, z fastest.
using Values = std::vector<double>;

/// Along the axis that is the slowest of the numbers in each of `outer` groups.
Values along_axis(const Values& from, const AxisTable& table, size_t outer) {
  const size_t inputs = table.size(), outputs = table.front().size(), inner = from.size() / (outer * inputs);
  Values to(outer * outputs * inner, 0.0);
  for (size_t o = 0; o < outer; ++o)
    for (size_t k = 0; k < inputs; ++k)
      for (size_t i = 0; i < outputs; ++i) {
        const double* const row = from.data() + (o * inputs + k) * inner;
        double* const out = to.data() + (o * outputs + i) * inner;
        for (size_t j = 0; j < inner; ++j) out[j] += table[k][i] * row[j];
      }
  return to;
}

Values along_all_axes(const Values& from, const std::array<AxisTable, 3>& tables) {
  const size_t outputs = tables[0].front().size();
  return along_axis(along_axis(along_axis(from, tables[0], 1), tables[1], outputs), tables[2], outputs * outputs);
}

/// What polynomials through n samples need along each axis.
struct Tables {
  std::array<AxisTable, 3> coefficients{}, values{}, values_of_integral{};

  explicit Tables(int n) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<size_t>(axis);
      coefficients[k] = coefficients_of_samples(n);
      values[k] = powers_at_nodes(n, axis);
      values_of_integral[k] = powers_at_nodes(n + 1, axis);
    }
  }
};

const Tables& tables_of(int n) {
  static const std::array<Tables, 4> tables{Tables(3), Tables(4), Tables(5), Tables(6)};
  return tables[static_cast<size_t>(n - kFewest)];
}

/// Coefficients of the integral of a gradient along the straight way from the middle, half sides, from those of the gradient: along the way
/// to (x, y, z) a term of the degree d takes the (d + 1)-th part of what it is there.
Values integral_of(const std::array<Values, 3>& gradient, size_t n) {
  const size_t m = n + 1;
  Values integral(m * m * m, 0.0);
  for (size_t x = 0; x < n; ++x)
    for (size_t y = 0; y < n; ++y)
      for (size_t z = 0; z < n; ++z) {
        const double part = 1.0 / static_cast<double>(x + y + z + 1);
        const size_t from = (x * n + y) * n + z, to = (x * m + y) * m + z;
        integral[to + m * m] += part * gradient[0][from];
        integral[to + m] += part * gradient[1][from];
        integral[to + 1] += part * gradient[2][from];
      }
  return integral;
}

struct alignas(64) EightDistances {
  double of[8];
};

/// Edges that are so far off.
struct EdgesAt {
  size_t count = 0;
  /// The gradient's derivatives of the orders 3 to 6, each over (order + 1)!, at most.
  std::array<double, 4> terms{};
};

/// Edges of the border by their distance from the ball about the block's nodes, half octave by half octave; those that come into it first.
class EdgeShells {
 public:
  EdgeShells(const Winding& winding, const glm::dvec3& center, double radius, double voxel_size)
      : voxel_size_(voxel_size), radius_(radius) {
    std::vector<EightDistances> distances(winding.border_groups().size());
    if (!distances.empty()) border_distances(winding.border_groups(), center, distances.front().of);
    for (size_t i = 0; i < winding.border().size(); ++i) {
      const Winding::BorderEdge& edge = winding.border()[i];
      const double distance = distances[i / 8].of[i % 8] - radius;
      shells_.push_back(shell_of(distance));
      EdgesAt& at = edges_[static_cast<size_t>(shells_.back())];
      ++at.count;
      if (shells_.back() == 0) continue;
      // As Winding::gradient_bound has it: the derivatives of the order n are no larger than (n + 1)! / |r|^(n + 2), and their integral
      // over an edge no larger than (n + 1)! / distance^n times what it pulls.
      const double length = glm::distance(edge.a, edge.b), per = 1.0 / distance;
      double term =
          edge.multiplicity * length / (4.0 * std::numbers::pi) * per * per * per / std::sqrt(distance * distance + 0.25 * length * length);
      for (double& sum : at.terms) sum += term *= per;
    }
  }

  /// From which shell on edges are far, and samples along a side: what takes least time.
  struct Choice {
    int first_far = kShells, samples = 0;
  };
  /// `slope`: of the winding number about there.
  Choice choose(double slope) const {
    // A node's integral takes half as long again as a gradient.
    const double all = static_cast<double>(shells_.size()), each_node = 1.5 * kBlockNodes;
    const double allowed = BlockPotential::kMostOff_voxels * voxel_size_ * slope / radius_;
    Choice best;
    double least = each_node * all;
    EdgesAt far;
    for (int shell = kShells - 1; shell > 0; --shell) {
      const EdgesAt& at = edges_[static_cast<size_t>(shell)];
      far.count += at.count;
      for (size_t k = 0; k < 4; ++k) far.terms[k] += at.terms[k];
      const auto count = static_cast<double>(far.count);
      for (int n = kFewest; n <= kMost; ++n) {
        const double takes = n * n * n * count + each_node * (all - count) + 16.0 * n * n;
        if (takes < least && most_missed(far, n) <= allowed) best = {shell, n}, least = takes;
      }
    }
    return best;
  }
  bool is_far(size_t edge, const Choice& choice) const { return shells_[edge] >= choice.first_far; }

 private:
  static constexpr int kShells = 64, kFirst = -12;

  int shell_of(double distance) const {
    const double voxels = distance / voxel_size_;
    return voxels > 0.0 ? std::clamp(std::ilogb(voxels * voxels) - kFirst, 0, kShells - 1) : 0;
  }

  /// What a product of polynomials through n samples may miss of the gradient: along each axis the rest of that order, which the samples
  /// along the axes before it add up by no more than Lebesgue's constant of six of Chebyshev's points, 2.11, each.
  double most_missed(const EdgesAt& far, int n) const {
    constexpr double kAxes = 1.0 + 2.11 + 2.11 * 2.11;
    return 2.0 * std::pow(0.5 * kHalfSide_voxels * voxel_size_, n) * kAxes * (n + 1) * far.terms[static_cast<size_t>(n - kFewest)];
  }

  double voxel_size_, radius_;
  std::vector<int> shells_{};  ///< By edge.
  std::array<EdgesAt, kShells> edges_{};
};

EightPoints eight_from(std::span<const glm::dvec3> places, size_t first) {
  EightPoints eight;
  for (size_t i = 0; i < 8; ++i)
    for (int axis = 0; axis < 3; ++axis) eight.at[axis][i] = places[std::min(first + i, places.size() - 1)][axis];
  return eight;
}

/// Of each node by itself.
void add_near(const std::vector<SeenEdge>& near, const BlockNodes& nodes, std::vector<Winding::Potential>& potentials) {
  std::array<glm::dvec3, kBlockNodes> places;
  for (int node = 0; node < kBlockNodes; ++node) places[static_cast<size_t>(node)] = nodes.world(node);
  for (size_t first = 0; first < places.size(); first += 8) {
    EightPotentials changes;
    border_changes(near, eight_from(places, first), changes);
    const auto& [x, y, z] = changes.gradients.at;
    for (size_t i = 0; i < 8; ++i) {
      potentials[first + i].part += std::atan2(changes.across[i], changes.along[i]) / (2.0 * std::numbers::pi);
      potentials[first + i].gradient += glm::dvec3(x[i], y[i], z[i]);
    }
  }
}

/// By polynomials of their gradient.
void add_far(const std::vector<Winding::BorderEdge>& far, int n, const glm::dvec3& center, double half_side,
             std::vector<Winding::Potential>& potentials) {
  std::vector<glm::dvec3> places;
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z)
        places.push_back(center + half_side * glm::dvec3(sample_place(x, n), sample_place(y, n), sample_place(z, n)));
  std::array<Values, 3> gradient;
  for (Values& values : gradient) values.resize(places.size());
  for (size_t first = 0; first < places.size(); first += 8) {
    EightPoints found;
    border_gradients(far, eight_from(places, first), found);
    for (size_t axis = 0; axis < 3; ++axis)
      std::copy_n(found.at[axis], std::min<size_t>(8, places.size() - first), gradient[axis].begin() + static_cast<std::ptrdiff_t>(first));
  }
  const Tables& tables = tables_of(n);
  for (Values& values : gradient) values = along_all_axes(values, tables.coefficients);
  const Values change = along_all_axes(integral_of(gradient, static_cast<size_t>(n)), tables.values_of_integral);
  for (Values& values : gradient) values = along_all_axes(values, tables.values);
  for (size_t node = 0; node < kBlockNodes; ++node) {
    potentials[node].part += half_side * change[node];
    potentials[node].gradient += glm::dvec3(gradient[0][node], gradient[1][node], gradient[2][node]);
  }
}

}  // namespace

BlockPotential::BlockPotential(const BlockNodes& nodes, const Winding& winding) : potentials_(kBlockNodes) {
  const double half_side = kHalfSide_voxels * nodes.voxel_size;
  const glm::dvec3 center = nodes.world(0) + nodes.voxel_size * (3.5 + kOffMiddle_voxels);
  const Winding::Potential middle = winding.potential(center);
  const EdgeShells shells(winding, center, std::sqrt(3.0) * half_side, nodes.voxel_size);
  const EdgeShells::Choice choice = shells.choose(glm::length(middle.gradient));
  std::vector<SeenEdge> near;
  std::vector<Winding::BorderEdge> far;
  for (size_t i = 0; i < winding.border().size(); ++i) {
    const Winding::BorderEdge& edge = winding.border()[i];
    if (shells.is_far(i, choice))
      far.push_back(edge);
    else
      near.push_back(seen_from(center, edge));
  }
  for (Winding::Potential& one : potentials_) one.part = middle.part;
  if (!near.empty()) add_near(near, nodes, potentials_);
  if (!far.empty()) add_far(far, choice.samples, center, half_side, potentials_);
}

}  // namespace limn
