// Models of cells say of any view what bounds say of it: what they leave out is not there.

#include "raymarch/truth/cell_models.h"

#include <gtest/gtest.h>

#include <bit>

#include "sdf/tape_curvature.h"
#include "tests/random_seed.h"
#include "tests/raymarch/line_views.h"
#include "tests/sdf/random_field.h"

namespace limn {
namespace {

constexpr int kFields = 500, kBoxes = 40, kStarts = 4;
constexpr double kRounding = 1e-9;

std::array<glm::dvec3, 8> eighths(const glm::dvec3& corner, double side) {
  std::array<glm::dvec3, 8> lower;
  for (size_t i = 0; i < 8; ++i) lower[i] = corner + side * glm::dvec3(i & 1, i >> 1 & 1, i >> 2 & 1);
  return lower;
}

bool is_within(const glm::dvec3& p, const glm::dvec3& lower, double side) {
  const glm::dvec3 t = (p - lower) / side;
  return std::min({t.x, t.y, t.z}) > 1e-6 && std::max({t.x, t.y, t.z}) < 1.0 - 1e-6;
}

unsigned part_at(const glm::dvec3& p, const glm::dvec3& lower, double side) {
  const glm::ivec3 part(4.0 * (p - lower) / side);
  return static_cast<unsigned>(16 * part.x + 4 * part.y + part.z);
}

TEST(TapeCurvature, BoundsHoldWhatJetsSayOnTheSurface) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  TapeScratch scratch;
  int smooth = 0, creased = 0;
  // In one draw of thirty so many fields have fewer places than are wanted: then more are drawn.
  const auto few = [&] { return smooth <= 500 || creased <= 20; };
  for (int k = 0; k < kFields || (few() && k < 4 * kFields); ++k) {
    const Field field = random_field(random, random.index(3));
    const FieldTape tape(field);
    FieldEvaluator evaluator(field);
    const double half = random.uniform(0.005, 0.1);
    LaneBeams beams{};
    for (int axis = 0; axis < 3; ++axis) beams.origin_spread[axis][axis] = half;
    std::array<glm::dvec3, kLanes> middles;
    for (int i = 0; i < kLanes; ++i) {
      // Beside the surface, so that some boxes hold a part of it.
      const glm::dvec3 a = random.point(1.2), b = random.point(1.2);
      const double fa = evaluator.value(a), fb = evaluator.value(b);
      const glm::dvec3 middle = (fa < 0.0) != (fb < 0.0) ? root_between(evaluator, a, b, fa, fb) + random.point(0.5 * half) : a;
      middles[static_cast<size_t>(i)] = middle;
      for (int axis = 0; axis < 3; ++axis) beams.rays.origin[axis][i] = middle[axis];
      beams.radius[i] = 2.0 * half;
    }
    LaneCurvature found;
    tape_curvature(tape, tape.steps, beams, scratch, found);
    for (int i = 0; i < kLanes; ++i) {
      const CurvatureKnown known = found.known[static_cast<size_t>(i)];
      if (known == CurvatureKnown::nothing) continue;
      for (int start = 0; start < kStarts; ++start) {
        const glm::dvec3 a = middles[static_cast<size_t>(i)] + random.point(half), b = middles[static_cast<size_t>(i)] + random.point(half);
        const double fa = evaluator.value(a), fb = evaluator.value(b);
        if ((fa < 0.0) == (fb < 0.0)) continue;
        const FieldJet jet = evaluator.jet(root_between(evaluator, a, b, fa, fb));
        for (int axis = 0; axis < 3; ++axis) {
          const double slack = kRounding * (1.0 + std::fabs(jet.gradient[axis]));
          EXPECT_GE(jet.gradient[axis], found.gradient_lower[axis][i] - slack) << "seed " << seed << " field " << k;
          EXPECT_LE(jet.gradient[axis], found.gradient_upper[axis][i] + slack) << "seed " << seed << " field " << k;
        }
        (known == CurvatureKnown::all ? smooth : creased) += 1;
        if (known != CurvatureKnown::all) continue;
        const glm::dmat3& h = jet.hessian;
        const double entries[6] = {h[0][0], h[0][1], h[0][2], h[1][1], h[1][2], h[2][2]};
        for (int entry = 0; entry < 6; ++entry) {
          const double slack = 1e-7 * (1.0 + std::fabs(entries[entry]));
          EXPECT_GE(entries[entry], found.hessian_lower[entry][i] - slack) << "seed " << seed << " field " << k << " entry " << entry;
          EXPECT_LE(entries[entry], found.hessian_upper[entry][i] + slack) << "seed " << seed << " field " << k << " entry " << entry;
        }
      }
    }
  }
  EXPECT_GT(smooth, 500);
  EXPECT_GT(creased, 20);
}

TEST(CellModels, PartsThatAContourGeneratorGoesThroughStayOpen) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  int smooth = 0, closed = 0;
  for (int k = 0; k < kFields; ++k) {
    const SharpField sharp = split_branches(random_field(random, 2), 2.0, true);
    const Camera camera = line_view({glm::dvec3(-1.0), glm::dvec3(1.0)}, random.direction(), 3.0, k % 2 == 0);
    const Viewer viewer = make_viewer(camera, glm::dvec3(0.0));
    const CellSearch search{sharp, camera, viewer, {glm::dvec3(-1.5), 3.0 / 64.0}, 6, {0.0, 0.0}, 1u, true};
    const CellTapes tapes(sharp);
    CellBounds bounds(search, tapes);
    for (int b = 0; b < kBoxes; ++b) {
      const auto branch = static_cast<size_t>(random.index(static_cast<int>(sharp.branches.size())));
      FieldEvaluator evaluator(sharp.branches[branch]);
      const auto point = polish(evaluator, viewer, 0.0, random.point(1.0), 1.0);
      if (!point) continue;
      const double side = random.uniform(0.01, 0.1), half = 0.5 * side * kModelReach;
      const std::array<glm::dvec3, 8> lower = eighths(point->p - side * (random.point(1.0) + 1.0), side);
      std::array<Survivors, 8> survivors;
      bounds.find(tapes.whole, lower, side, survivors);
      ModelledCells found;
      if (!bounds.model(tapes.whole, lower, side, true, found)) continue;
      for (size_t i = 0; i < 8; ++i) {
        const std::vector<size_t>& relevant = survivors[i].relevant;
        if (!is_within(point->p, lower[i], side) || std::find(relevant.begin(), relevant.end(), branch) == relevant.end()) continue;
        std::uint64_t open = 0;
        bool is_smooth = false;
        for (const CellModel& model : found.of(i)) {
          const SeenModel seen = seen_model(search, model, lower[i] + 0.5 * side, half);
          if (model.at != branch || !seen.live) continue;
          open = open_parts(seen.field, seen.facing, half);
          is_smooth = model.smooth;
        }
        EXPECT_TRUE(open >> part_at(point->p, lower[i], side) & 1u) << "seed " << seed << " field " << k << " box " << b;
        smooth += is_smooth;
        closed += 64 - std::popcount(open);
      }
    }
  }
  EXPECT_GT(smooth, 100);
  EXPECT_GT(closed, 2500);
}

TEST(CellModels, PartsThatASeamGoesThroughStayOpen) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  int points = 0, closed = 0;
  for (int k = 0; k < kFields; ++k) {
    const SharpField sharp = split_branches(random_field(random, 2), 2.0, true);
    if (sharp.branches.size() < 2) continue;
    const Camera camera = line_view({glm::dvec3(-1.0), glm::dvec3(1.0)}, random.direction(), 3.0, true);
    const Viewer viewer = make_viewer(camera, glm::dvec3(0.0));
    const CellSearch search{sharp, camera, viewer, {glm::dvec3(-1.5), 3.0 / 64.0}, 6, {0.0, 0.0}, 1u, true};
    const CellTapes tapes(sharp);
    CellBounds bounds(search, tapes);
    FieldEvaluator one(sharp.branches[0]), other(sharp.branches[1]);
    for (int b = 0; b < kBoxes; ++b) {
      // About a place on the seam of the first two, where these two alone are looked at.
      const auto seed_point = polish_seam(one, other, random.point(1.0), 2.0);
      if (!seed_point) continue;
      const double side = random.uniform(0.01, 0.1);
      const glm::dvec3 corner = seed_point->p - side * (random.point(0.5) + 0.5);
      const std::array<glm::dvec3, 1> lower{corner};
      ModelledCells found;
      Survivors survivors;
      bounds.find(tapes.whole, lower, side, std::span(&survivors, 1));
      const auto is_relevant = [&](size_t at) { return std::binary_search(survivors.relevant.begin(), survivors.relevant.end(), at); };
      if (!bounds.model(tapes.whole, lower, side, true, found)) continue;
      if (!is_relevant(0) || !is_relevant(1) || !is_within(seed_point->p, corner, side)) continue;
      const bool live =
          std::any_of(found.seams.begin(), found.seams.end(), [](const ModelledSeam& s) { return s.seam.first + s.seam.second == 1; });
      EXPECT_TRUE(live) << "seed " << seed << " field " << k << " box " << b;
      EXPECT_TRUE(found.open_seam_parts[0] >> part_at(seed_point->p, corner, side) & 1u)
          << "seed " << seed << " field " << k << " box " << b;
      ++points;
      closed += 64 - std::popcount(found.open_seam_parts[0]);
    }
  }
  EXPECT_GT(points, 200);
  EXPECT_GT(closed, 5000);
}

}  // namespace
}  // namespace limn
