// Distances of what points choose of a field, against the jets of all of it.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "sdf/level_set_distance.h"
#include "sdf/tape_jets.h"
#include "sdf/tape_text.h"
#include "tests/random_seed.h"
#include "tests/sdf/random_field.h"

namespace limn {
namespace {

/// Sixteen points so near to each other that most choose the same parts of the field; some on a coarse lattice, where parts are equal.
std::vector<glm::dvec3> points_together(Random& random) {
  std::vector<glm::dvec3> points;
  const glm::dvec3 middle = random.point(1.2);
  const double reach = std::pow(10.0, -3.0 * std::abs(random.point(1.0).x));
  const bool on_lattice = random.index(3) == 0;
  for (int i = 0; i < kLanes; ++i) {
    const glm::dvec3 p = middle + reach * random.point(1.0);
    points.push_back(on_lattice ? glm::round(8.0 * p) / 8.0 : p);
  }
  return points;
}

/// Returns by how many steps fewer the distances were found.
size_t expect_distances_of_the_jets(const Field& field, const FieldTape& tape, const std::vector<glm::dvec3>& points,
                                    TapeScratch& scratch) {
  FieldEvaluator evaluator(field);
  LanePoints together;
  for (const glm::dvec3& point : points) together.add(point);
  together.fill_up();
  std::vector<FieldJet> own(points.size());
  evaluator.jets(points, own);
  LaneNumbers distances;
  LaneFlags reasonable;
  scratch.pruned.clear();
  tape_distances(tape, together, scratch, distances, reasonable);
  SCOPED_TRACE(text_of(tape));
  for (size_t i = 0; i < points.size(); ++i) {
    const JetDistance distance = distance_from_jet(own[i]);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(distances[i]), std::bit_cast<std::uint64_t>(distance.distance)) << "point " << i;
    EXPECT_EQ(flag_of(reasonable, i), distance.reasonable) << "point " << i;
  }
  return scratch.pruned.empty() ? 0 : tape.steps.size() - scratch.pruned.size();
}

TEST(TapeDistances, OfWhatIsChosenHaveTheBitsOfTheWholeField) {
  TapeScratch scratch;
  Random random(random_seed());
  int shorter = 0;
  for (int trial = 0; trial < 400 && !testing::Test::HasFailure(); ++trial) {
    const Field field = random_field(random, random.index(4));
    const FieldTape tape(field);
    for (int round = 0; round < 4; ++round)
      shorter += expect_distances_of_the_jets(field, tape, points_together(random), scratch) > tape.steps.size() / 2 ? 1 : 0;
  }
  EXPECT_GT(shorter, 50);
}

/// A plane has no second derivatives, whatever the registers held before.
TEST(TapeDistances, OfAPlaneAreTheFieldsOwn) {
  TapeScratch scratch;
  Random random(random_seed());
  const Field wavy = make_shape("gyroid");
  const Field plane = make_shape("plane", {{"normal", {0.6, 0.0, 0.8}}, {"offset", {0.25}}});
  const std::vector<Field> planes{plane, translate(plane, {1.0, 0.0, 0.0})};
  for (const Field& field : {planes[0], planes[1], combine(Csg::intersection, planes)})
    for (int trial = 0; trial < 20; ++trial) {
      const std::vector<glm::dvec3> points = points_together(random);
      expect_distances_of_the_jets(wavy, FieldTape(wavy), points, scratch);
      expect_distances_of_the_jets(field, FieldTape(field), points, scratch);
    }
  EXPECT_FALSE(testing::Test::HasFailure());
}

/// Equal values with different slopes: which one is taken must not depend on what the other lanes take.
TEST(TapeDistances, WherePartsAreEqualHaveTheBitsOfTheWholeField) {
  TapeScratch scratch;
  const auto ball = [](const glm::dvec3& middle) { return translate(make_shape("sphere", {{"radius", {0.4}}}), middle); };
  const auto box = [](double half) { return make_shape("box", {{"half", {half, half, half}}}); };
  const std::vector<Field> four{ball({0.5, 0.0, 0.0}), ball({-0.5, 0.0, 0.0}), ball({0.0, 0.5, 0.0}), ball({0.0, -0.5, 0.0})};
  std::vector<Field> fields;
  for (const Csg csg : {Csg::union_, Csg::intersection, Csg::difference})
    for (const bool with_box : {false, true}) {
      std::vector<Field> parts = four;
      if (with_box) parts.insert(parts.begin(), {box(0.25), box(0.5)});
      fields.push_back(combine(csg, parts));
    }
  for (const Field& field : fields) {
    const FieldTape tape(field);
    ASSERT_GE(tape.joints, 3u);
    for (const double size : {0.125, 0.25, 0.5, 0.75}) {
      // On one diagonal, in one plane, and at one place.
      for (const glm::dvec3& step : {glm::dvec3(0.0), glm::dvec3(0.0, 0.0, 0.0625), glm::dvec3(0.0625, 0.0625, 0.0), glm::dvec3(0.0625)}) {
        for (const glm::dvec3& from : {glm::dvec3(0.0), glm::dvec3(size, size, 0.0), glm::dvec3(size), glm::dvec3(0.0, 0.0, size)}) {
          std::vector<glm::dvec3> points;
          for (int i = 0; i < kLanes; ++i) points.push_back(from + static_cast<double>(i) * step);
          expect_distances_of_the_jets(field, tape, points, scratch);
        }
      }
    }
  }
}

/// An ellipsoid's value grows half as fast as a ball's: of equal values the one that is taken tells how far the surface is.
TEST(TapeDistances, OfEqualPartsAreOfTheOneThatTheFieldTakes) {
  TapeScratch scratch;
  const Field egg = make_shape("ellipsoid", {{"radii", {1.0, 0.5, 0.5}}}), ball = make_shape("sphere", {{"radius", {1.5}}});
  const Field far = translate(make_shape("sphere", {{"radius", {0.1}}}), {0.0, 9.0, 0.0});
  const Field around = make_shape("sphere", {{"radius", {20.0}}});
  const std::vector<glm::dvec3> points(kLanes, {2.0, 0.0, 0.0});  // both are 0.5 there
  std::vector<double> distances;
  for (const bool egg_first : {true, false})
    for (const Csg csg : {Csg::union_, Csg::intersection}) {
      std::vector<Field> parts{egg_first ? egg : ball, egg_first ? ball : egg};
      for (int i = 0; i < 3; ++i) parts.push_back(csg == Csg::union_ ? far : around);
      const Field field = combine(csg, parts);
      const FieldTape tape(field);
      EXPECT_GT(expect_distances_of_the_jets(field, tape, points, scratch), 0u);
      distances.push_back(distance_from_jet(FieldEvaluator(field).jet(points[0])).distance);
    }
  std::sort(distances.begin(), distances.end());
  EXPECT_NE(distances.front(), distances.back());
}

}  // namespace
}  // namespace limn
