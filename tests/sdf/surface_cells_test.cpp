// Bounds of a level set's spline by cells, against the spline itself at random points.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <span>
#include <tuple>

#include "sdf/level_set_data.h"
#include "sdf/level_set_reconstruction.h"
#include "sdf/shape.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

constexpr int kPoints = 20;  // in each cell

using Node = std::tuple<int, int, int>;

struct Case {
  Reconstruction made;
  std::map<Node, SurfaceCell> cells{};
};

/// A box with sharp edges, or a smooth torus, of few voxels.
Case random_case(std::mt19937& random, bool box) {
  std::uniform_real_distribution<double> real(0.0, 1.0);
  const Field shape = box ? make_shape("box", {{"half", {0.3 + 0.4 * real(random), 0.3 + 0.4 * real(random), 0.5}}})
                          : make_shape("torus", {{"major", {0.6}}, {"minor", {0.12 + 0.2 * real(random)}}});
  const glm::dvec3 axis = glm::normalize(glm::dvec3(real(random), real(random), real(random)) + 0.1);
  LevelSetSettings settings;
  settings.voxel_size = 0.04 + 0.06 * real(random);
  settings.half_width_voxels = 4.2;
  Case one{reconstruct(level_set_from_field(rotate(shape, axis, 6.0 * real(random)), settings))};
  for (const SurfaceCell& cell : surface_cells(one.made.completed)) one.cells[{cell.node.x, cell.node.y, cell.node.z}] = cell;
  return one;
}

struct CellBounds {
  double least = 0.0, most = 0.0;
  void add(double x) {
    least = std::min(least, x);
    most = std::max(most, x);
  }
  bool changes_sign() const { return least < 0.0 && most > 0.0; }
};

/// A place in the cell where the spline and its slope towards the eye both vanish, by Newton's iteration from `start`; index coordinates.
bool leads_to_contour(FieldEvaluator& evaluator, const LevelSetInfo& info, const glm::dvec3& first, const glm::dvec3& start,
                      const glm::dvec3& eye, double w) {
  const glm::dmat3& axes = info.world_from_index.linear;
  glm::dvec3 p = start;
  for (int step = 0; step < 20; ++step) {
    const FieldJet jet = evaluator.jet(info.world_from_index.point(p));
    const glm::dvec3 gradient = glm::transpose(axes) * jet.gradient, way = eye - w * p,
                     of_slope = glm::transpose(axes) * jet.hessian * axes * way - w * gradient;
    const double slope = glm::dot(gradient, way), ff = glm::dot(gradient, gradient), fs = glm::dot(gradient, of_slope),
                 ss = glm::dot(of_slope, of_slope), determinant = ff * ss - fs * fs;
    if (!(determinant > 1e-12 * ff * ss)) return false;
    const glm::dvec3 move = ((jet.value * ss - slope * fs) * gradient + (slope * ff - jet.value * fs) * of_slope) / determinant;
    p -= move;
    if (glm::length(p - start) > 3.0) return false;
    if (glm::length(move) < 1e-10) return glm::all(glm::greaterThan(p, first + 1e-6)) && glm::all(glm::lessThan(p, first + (1.0 - 1e-6)));
  }
  return false;
}

TEST(SurfaceCells, HoldTheSurfaceAndAllNormalsOfTheSpline) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> real(0.0, 1.0);
  std::int64_t held = 0, bounded = 0, flat = 0, told_out = 0, contours = 0;
  for (int k = 0; k < 3; ++k) {
    const Case one = random_case(random, k == 0);
    const LevelSetInfo& info = one.made.completed.info();
    FieldEvaluator evaluator(one.made.field);
    const glm::dvec3 eye = 40.0 * (glm::dvec3(real(random), real(random), real(random)) - 0.5);
    const double w = real(random) < 0.7 ? 1.0 : 0.0;
    // All cells about the surface, and one more on every side.
    std::map<Node, int> around;
    for (const auto& [node, cell] : one.cells)
      for (int i = 0; i < 27; ++i)
        around[{std::get<0>(node) + i % 3 - 1, std::get<1>(node) + i / 3 % 3 - 1, std::get<2>(node) + i / 9 - 1}] = 1;
    std::vector<SurfaceCell> asked;
    for (const auto& [node, unused] : around) asked.push_back({glm::ivec3(std::get<0>(node), std::get<1>(node), std::get<2>(node))});
    std::set<Node> may_hold;
    for (const SurfaceCell& cell : one.made.cells.that_may_hold_contours(asked, eye, w))
      may_hold.insert({cell.node.x, cell.node.y, cell.node.z});
    for (const auto& [node, unused] : around) {
      const glm::ivec3 first(std::get<0>(node), std::get<1>(node), std::get<2>(node));
      const auto found = one.cells.find(node);
      CellBounds values, slopes;
      for (int i = 0; i < kPoints; ++i) {
        const glm::dvec3 index = glm::dvec3(first) + glm::dvec3(real(random), real(random), real(random));
        const FieldJet jet = evaluator.jet(info.world_from_index.point(index));
        const glm::dvec3 by_index = glm::transpose(info.world_from_index.linear) * jet.gradient;
        values.add(jet.value);
        slopes.add(glm::dot(by_index, eye - w * index));
        if (found == one.cells.end() || found->second.normal == glm::vec3(0.0f)) continue;
        ++bounded;
        const glm::dvec3 normal(found->second.normal), n = glm::normalize(jet.gradient);
        const double angle = std::atan2(glm::length(glm::cross(n, normal)), glm::dot(n, normal));
        EXPECT_LE(angle, static_cast<double>(found->second.spread));
        flat += static_cast<double>(found->second.spread) < 0.3;
      }
      if (values.changes_sign()) {
        EXPECT_NE(found, one.cells.end()) << "the surface goes through an unlisted cell";
        ++held;
      }
      const bool may = may_hold.count(node) > 0;
      // Whichever cells are asked about together.
      const SurfaceCell alone{first};
      EXPECT_EQ(one.made.cells.that_may_hold_contours(std::span(&alone, 1), eye, w).size(), may ? 1u : 0u);
      told_out += !may && found != one.cells.end();
      if (!values.changes_sign() || !slopes.changes_sign()) continue;
      for (int i = 0; i < 8; ++i) {
        const glm::dvec3 start = glm::dvec3(first) + glm::dvec3(real(random), real(random), real(random));
        if (!leads_to_contour(evaluator, info, glm::dvec3(first), start, eye, w)) continue;
        EXPECT_TRUE(may) << "told out";
        ++contours;
      }
    }
  }
  // It would say nothing of cells that nothing is known of.
  EXPECT_GT(held, 500);
  EXPECT_GT(bounded, kPoints * held / 4);
  EXPECT_GT(flat, 0);
  EXPECT_GT(told_out, held / 3);
  EXPECT_GT(contours, 100);
}

TEST(SplineCellReader, TellsCornersAndEdgesAsTheFieldDoes) {
  constexpr double kClose = 0.01;
  std::mt19937 random(random_seed());
  std::int64_t edges_met = 0, found = 0;
  for (const bool box : {true, false}) {
    const Case one = random_case(random, box);
    const LevelSetInfo& info = one.made.completed.info();
    FieldEvaluator evaluator(one.made.field);
    SplineCellReader reader(one.made.cells);
    std::map<Node, double> known;  // of nodes
    for (const auto& [node, cell] : one.cells) {
      reader.read(cell.node);
      const std::array<double, 8> values = reader.corner_values();
      const glm::ivec3 first = cell.node;
      const auto corner = [&](size_t k) { return first + glm::ivec3(k & 1u, k >> 1u & 1u, k >> 2u); };
      for (size_t k = 0; k < 8; ++k) {
        const glm::ivec3 at = corner(k);
        EXPECT_NEAR(values[k], evaluator.value(info.world_from_index.point(glm::dvec3(at))), 1e-12);
        const auto [before, added] = known.insert({{at.x, at.y, at.z}, values[k]});
        EXPECT_EQ(before->second, values[k]) << "two cells disagree about their corner";
      }
      std::vector<CellEdge> edges;
      for (std::uint8_t a = 0; a < 8; ++a)
        for (std::uint8_t b = 0; b < 8; ++b)
          if (a != b && (values[a] < 0.0) != (values[b] < 0.0)) edges.push_back({a, b});
      std::vector<EdgePoint> points(edges.size());
      reader.find_on_edges(edges, kClose, points);
      for (size_t i = 0; i < edges.size(); ++i) {
        ++edges_met;
        if (!points[i].found) continue;
        ++found;
        EXPECT_GE(points[i].share, 0.0);
        EXPECT_LE(points[i].share, 1.0);
        // Within so much of a place where the sign changes.
        const glm::dvec3 from(corner(edges[i].from)), to(corner(edges[i].to));
        const auto value_at = [&](double share) { return evaluator.value(info.world_from_index.point(glm::mix(from, to, share))); };
        const double before = value_at(std::max(0.0, points[i].share - kClose)), after = value_at(std::min(1.0, points[i].share + kClose));
        EXPECT_NE(before < 0.0, after < 0.0);
        const glm::dvec3 place = info.world_from_index.point(glm::mix(from, to, points[i].share));
        EXPECT_LT(glm::distance(points[i].gradient, evaluator.jet(place).gradient), 0.2);
      }
    }
  }
  EXPECT_GT(found, 1000);
  EXPECT_GT(found, edges_met * 9 / 10);
}

TEST(Reconstruction, OnePointAloneGivesTheJetThatManyGive) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> real(-0.8, 0.8);
  for (const bool turned : {false, true}) {
    const Case one = random_case(random, false);
    const Field field =
        turned ? rotate(one.made.field, glm::normalize(glm::dvec3(real(random), 1.0, real(random))), real(random)) : one.made.field;
    FieldEvaluator evaluator(field);
    for (int i = 0; i < 300; ++i) {
      const glm::dvec3 p(real(random), real(random), real(random));
      FieldJet many;
      evaluator.jets(std::span(&p, 1), std::span(&many, 1));
      const FieldJet alone = evaluator.jet(p);
      EXPECT_EQ(alone.value, many.value);
      EXPECT_EQ(alone.gradient, many.gradient);
      EXPECT_EQ(alone.hessian, many.hessian);
    }
  }
}

}  // namespace
}  // namespace limn
