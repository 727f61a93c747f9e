// What bounds over boxes leave out is not there.

#include "raymarch/truth/cell_scope.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/random_seed.h"
#include "tests/raymarch/line_views.h"
#include "tests/sdf/quartic.h"
#include "tests/sdf/random_field.h"

namespace limn {
namespace {

constexpr int kFields = 600, kBoxes = 200, kPoints = 40;

/// Points of the surface in a box, on segments between random points of it.
std::vector<SurfaceSample> surface_in(FieldEvaluator& evaluator, const Viewer& viewer, const Box& box, Random& random) {
  std::vector<SurfaceSample> samples;
  const auto point = [&] {
    const glm::dvec3 t = random.point(0.5) + 0.5;
    return box.lower + t * box.size();
  };
  for (int i = 0; i < kPoints; ++i) {
    const glm::dvec3 a = point(), b = point();
    const double fa = evaluator.value(a), fb = evaluator.value(b);
    if ((fa < 0.0) == (fb < 0.0)) continue;
    samples.push_back(sample_surface(evaluator, viewer, root_between(evaluator, a, b, fa, fb)));
  }
  return samples;
}

TEST(CellScope, ABoxInWhichNVChangesItsSignOnTheSurfaceIsNotLeftOut) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  int boxes = 0, left_out = 0;
  for (int k = 0; k < kFields; ++k) {
    const Field field = random_field(random, 2);
    const SharpField sharp = split_branches(field, 2.0);
    if (sharp.branches.size() > 1) continue;
    const Camera camera = line_view({glm::dvec3(-1.0), glm::dvec3(1.0)}, random.direction(), 3.0, k % 2 == 0);
    const Viewer viewer = make_viewer(camera, glm::dvec3(0.0));
    const double threshold = k % 3 == 0 ? 0.4 : 0.0;
    const CellSearch search{sharp, camera, viewer, {glm::dvec3(-1.5), 3.0 / 64.0}, 6, {0.0, threshold}, threshold > 0.0 ? 3u : 1u};
    const CellTapes tapes(sharp);
    CellBounds bounds(search, tapes);
    FieldEvaluator evaluator(sharp.branches[0]);
    for (int b = 0; b < kBoxes; ++b) {
      const double side = random.uniform(0.02, 0.3);
      const std::array<glm::dvec3, 1> lower{random.point(1.0)};
      Survivors found;
      bounds.find(tapes.whole, lower, side, std::span(&found, 1));
      // The same with the steps that matter there.
      Survivors again;
      if (!found.empty()) {
        bounds.find(bounds.inside(tapes.whole, found, 0), lower, side, std::span(&again, 1));
        EXPECT_LE(again.branches.size(), found.branches.size());
      }
      const std::vector<SurfaceSample> samples = surface_in(evaluator, viewer, {lower[0], lower[0] + side}, random);
      if (samples.empty()) continue;
      for (size_t family = 0; family < (threshold > 0.0 ? 2u : 1u); ++family) {
        const double level = search.levels[family];
        const auto above = std::count_if(samples.begin(), samples.end(), [&](const SurfaceSample& s) { return s.facing > level; });
        const bool changes = above > 0 && above < static_cast<std::ptrdiff_t>(samples.size());
        const auto lives = [&](const Survivors& left) { return !left.branches.empty() && (left.branches[0].families >> family & 1u) != 0; };
        if (changes) {
          EXPECT_TRUE(lives(found)) << "seed " << seed << " field " << k << " box " << b;
          EXPECT_TRUE(lives(again)) << "pruned, seed " << seed << " field " << k << " box " << b;
        }
        boxes += changes;
        left_out += !lives(found);
      }
    }
  }
  EXPECT_GT(boxes, 200);
  EXPECT_GT(left_out, 200);
}

TEST(CellScope, SlopesLeaveOutMostBoxesBesideTheSurfaceOfPowersThatNearlyCancelOut) {
  const SharpField sharp = split_branches(quartic(5.0, 5.0, 5.0, 10.0), 5.0);
  const Camera camera = line_view({glm::dvec3(-2.3), glm::dvec3(2.3)}, glm::normalize(glm::dvec3(1.0, 2.0, 3.0)), 3.0, true);
  const Viewer viewer = make_viewer(camera, glm::dvec3(0.0));
  // Silhouettes and a level that every normal may have: what is left out is left out for its values.
  const CellSearch search{sharp, camera, viewer, {glm::dvec3(-2.4), 4.8 / 64.0}, 6, {0.0, 0.4}, 3u};
  const CellTapes tapes(sharp);
  CellBounds bounds(search, tapes);
  FieldEvaluator evaluator(sharp.branches[0]);
  int kept = 0, crossed = 0;
  for (int k = 0; k < 64 * 64 * 64; k += 7) {
    const std::array<glm::dvec3, 1> lower{search.grid.vertex({k >> 12, k >> 6 & 63, k & 63})};
    Survivors found;
    bounds.find(tapes.whole, lower, search.grid.side, std::span(&found, 1));
    kept += !found.branches.empty();
    int inside = 0;
    for (int corner = 0; corner < 8; ++corner)
      inside += evaluator.value(lower[0] + search.grid.side * glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2)) < 0.0;
    crossed += inside > 0 && inside < 8;
  }
  EXPECT_GT(crossed, 1000);
  // N.V leaves out most of these. Bounds of the powers alone leave twice as many as there are.
  EXPECT_LT(kept, 0.5 * crossed) << kept << " kept, the surface crosses " << crossed;
}

}  // namespace
}  // namespace limn
