#include "sdf/level_set.h"

#include <gtest/gtest.h>

#include "sdf/error.h"
#include "sdf/level_set_crossings.h"
#include "sdf/level_set_data.h"
#include "sdf/level_set_distance.h"
#include "tests/random_seed.h"
#include "tests/sdf/level_set_maker.h"
#include "tests/sdf/quartic.h"

namespace limn {
namespace {

using testing_tools::brute_force_level_set;
using testing_tools::Ellipsoid;

std::string refusal(const Field& field, const LevelSetSettings& settings) {
  try {
    level_set_from_field(field, settings);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "accepted";
  return {};
}

/// Looks at every node of the bounds: is it active exactly where the true distance says so, and is its value that distance?
struct BandCheck {
  std::int64_t missing = 0, superfluous = 0, active = 0, wrong_sign = 0;
  double worst_value_voxels = 0.0;
};
BandCheck check_band(const LevelSet& level_set, const std::function<double(const glm::dvec3&)>& distance, double width, double slack) {
  const LevelSetInfo& info = level_set.info();
  const Box reach = dilate(info.bounds, (width + 4.0) * info.voxel_size);
  const glm::ivec3 lower(glm::floor(level_set.data().index_from_world.point(reach.lower)));
  const glm::ivec3 upper(glm::ceil(level_set.data().index_from_world.point(reach.upper)));
  const auto accessor = level_set.data().accessor();
  BandCheck found;
  for (int x = lower.x; x <= upper.x; ++x)
    for (int y = lower.y; y <= upper.y; ++y)
      for (int z = lower.z; z <= upper.z; ++z) {
        const double d = distance(info.world_from_index.point({x, y, z})) / info.voxel_size;
        const nanovdb::Coord at(x, y, z);
        const bool active = accessor.isActive(at);
        const double value = static_cast<double>(accessor.getValue(at)) / info.voxel_size;
        found.active += active;
        found.missing += !active && std::abs(d) <= width - slack;
        found.superfluous += active && std::abs(d) > width + slack;
        found.wrong_sign += (value < 0.0) != (d < 0.0) && std::abs(d) > 1e-5;
        if (active) found.worst_value_voxels = std::max(found.worst_value_voxels, std::abs(value - d));
      }
  return found;
}

TEST(LevelSetFromField, TheBandHoldsEveryNodeWithinTheHalfWidthAndNoOther) {
  const double radius = 0.83, h = 0.07;
  const glm::dvec3 center(0.31, -0.17, 0.05);
  const Field sphere = translate(make_shape("sphere", {{"radius", {radius}}}), center);
  const auto distance = [&](const glm::dvec3& p) { return glm::distance(p, center) - radius; };
  for (const double width : {1.8, 2.4495, 4.1232, 6.5}) {
    const LevelSet level_set = level_set_from_field(sphere, {.voxel_size = h, .half_width_voxels = width});
    const BandCheck found = check_band(level_set, distance, width, 1e-6);
    EXPECT_EQ(found.missing, 0) << width;
    EXPECT_EQ(found.superfluous, 0) << width;
    EXPECT_EQ(found.wrong_sign, 0) << width;
    EXPECT_EQ(found.active, level_set.info().active_voxels) << width;
    EXPECT_LT(found.worst_value_voxels, 1e-6) << width;
  }
}

TEST(LevelSetFromField, AFieldThatIsNoDistanceIsTurnedIntoOneToThirdOrder) {
  const std::uint64_t seed = 4;
  const Ellipsoid shape = Ellipsoid::jittered(seed);
  ASSERT_FALSE(shape.field().traits().exact_distance);
  std::array<double, 2> worst;
  for (size_t k = 0; k < 2; ++k) {
    const double h = k == 0 ? 0.05 : 0.025, width = 3.0;
    const LevelSet level_set = level_set_from_field(shape.field(), {.voxel_size = h, .half_width_voxels = width});
    const BandCheck found = check_band(
        level_set, [&](const glm::dvec3& p) { return shape.distance(p); }, width, 0.1);
    EXPECT_EQ(found.missing, 0);
    EXPECT_EQ(found.superfluous, 0);
    EXPECT_EQ(found.wrong_sign, 0);
    worst[k] = found.worst_value_voxels * h;
  }
  EXPECT_LT(worst[0], 0.1 * 0.05);
  // Half the voxel, half the distance of the farthest node: an error of third order falls to an eighth.
  EXPECT_GT(std::log2(worst[0] / worst[1]), 2.6) << worst[0] << " " << worst[1];
}

TEST(LevelSetFromField, DistanceFromAJetIsThatOfThePowersOfADistance) {
  // f = (1 + d)^2 - 1 has slope 2 (1 + d) and second derivative 2: the root of the quadratic model is exact for planes of it.
  for (const double d : {-0.2, -0.01, 0.0, 0.03, 0.3}) {
    FieldJet jet;
    jet.value = (1.0 + d) * (1.0 + d) - 1.0;
    jet.gradient = {0.0, 2.0 * (1.0 + d), 0.0};
    jet.hessian[1][1] = 2.0;
    EXPECT_NEAR(distance_from_jet(jet).distance, d, 1.1 * std::abs(d * d * d));
  }
  FieldJet flat;
  flat.value = -1.0;
  EXPECT_FALSE(distance_from_jet(flat).reasonable);
  EXPECT_LT(distance_from_jet(flat).distance, -1e300);
}

TEST(LevelSetFromField, TheSameBytesWhateverRunsFirst) {
  const Field field = Ellipsoid::jittered(9).field();
  const LevelSet a = level_set_from_field(field, {.voxel_size = 0.04});
  const LevelSet b = level_set_from_field(field, {.voxel_size = 0.04});
  ASSERT_EQ(a.data().handle.size(), b.data().handle.size());
  EXPECT_EQ(std::memcmp(a.data().handle.data(), b.data().handle.data(), a.data().handle.size()), 0);
}

TEST(LevelSetFromField, FarFromTheOriginItIsTheSameGrid) {
  const Field sphere = make_shape("sphere", {{"radius", {0.75}}});
  const double h = 1.0 / 16.0;
  const LevelSet near = level_set_from_field(sphere, {.voxel_size = h});
  const glm::dvec3 far(1048576.0, -524288.0, 0.0);
  const LevelSet away = level_set_from_field(translate(sphere, far), {.voxel_size = h});
  EXPECT_EQ(near.info().active_voxels, away.info().active_voxels);
  EXPECT_LT(glm::distance(away.info().bounds.center() - far, near.info().bounds.center()), 1e-6);
  std::vector<glm::dvec3> points, moved;
  std::mt19937_64 random(3);
  for (int i = 0; i < 1000; ++i) {
    points.push_back(0.75 * testing_tools::random_direction(random));
    moved.push_back(points.back() + far);
  }
  std::vector<double> a(points.size()), b(points.size());
  level_set_values(near, points, a);
  level_set_values(away, moved, b);
  for (size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-8);
}

TEST(LevelSetFromField, CreasesAndBlendsKeepTheirSignAndTheirSurfaceCells) {
  const Field part = combine(Csg::difference, make_shape("box", {{"half", {0.8, 0.5, 0.6}}}), make_shape("sphere", {{"radius", {0.62}}}));
  const Field blend = combine(Csg::union_, make_shape("torus", {{"major", {0.7}}, {"minor", {0.2}}}),
                              translate(make_shape("sphere", {{"radius", {0.3}}}), {0.6, 0.2, 0.0}), 0.15);
  const Field flat = scale(make_shape("sphere", {{"radius", {1.0}}}), glm::dvec3(1.0, 0.2, 0.6));
  for (const Field& field : {part, blend, flat}) {
    const LevelSet level_set = level_set_from_field(field, {.voxel_size = 0.03, .half_width_voxels = 2.5});
    EXPECT_EQ(cells_lacking(level_set, find_gradient("cell")), 0);
    FieldEvaluator evaluator(field);
    const auto accessor = level_set.data().accessor();
    const Box reach = dilate(field.traits().bounds, 0.2);
    std::mt19937_64 random(5);
    for (int i = 0; i < 50'000; ++i) {
      glm::dvec3 p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = std::uniform_real_distribution(reach.lower[axis], reach.upper[axis])(random);
      const CellPoint at = cell_point(level_set.data().index_from_world.point(p));
      const double truth = evaluator.value(level_set.info().world_from_index.point({at.node[0], at.node[1], at.node[2]}));
      const double value = static_cast<double>(accessor.getValue(at.node));
      if (std::abs(truth) > 1e-7) {
        ASSERT_EQ(value < 0.0, truth < 0.0);
      }
    }
  }
}

/// A level set beside the distances of the whole field at every node of its bounds.
struct BesideDistances {
  std::int64_t active = 0, wrongly = 0;  ///< Nodes; of these and the others those that should be otherwise.
  double worst_voxels = 0.0;             ///< At active nodes.
};
BesideDistances beside_distances(const Field& field, const LevelSetSettings& settings) {
  const LevelSet level_set = level_set_from_field(field, settings);
  const LevelSetInfo& info = level_set.info();
  const Box reach = dilate(info.bounds, 5.0 * settings.voxel_size);
  const glm::ivec3 lower(glm::floor(level_set.data().index_from_world.point(reach.lower)));
  const glm::ivec3 upper(glm::ceil(level_set.data().index_from_world.point(reach.upper)));
  const double half_width = settings.half_width_voxels * settings.voxel_size;
  DistanceEvaluator whole(field);
  const auto accessor = level_set.data().accessor();
  BesideDistances found;
  for (int x = lower.x; x <= upper.x; ++x)
    for (int y = lower.y; y <= upper.y; ++y) {
      std::vector<glm::dvec3> points;
      for (int z = lower.z; z <= upper.z; ++z) points.push_back(info.world_from_index.point({x, y, z}));
      std::vector<double> distances(points.size());
      signed_distances(whole, points, half_width, distances);
      for (size_t k = 0; k < points.size(); ++k) {
        const nanovdb::Coord at(x, y, lower.z + static_cast<int>(k));
        const double value = static_cast<double>(accessor.getValue(at));
        // At the band's end the lattice's own coordinates round differently.
        if (std::abs(std::abs(distances[k]) - half_width) > 1e-9)
          found.wrongly += accessor.isActive(at) != (std::abs(distances[k]) < half_width);
        if (!accessor.isActive(at)) continue;
        ++found.active;
        found.worst_voxels = std::max(found.worst_voxels, std::abs(value - distances[k]) / settings.voxel_size);
      }
    }
  return found;
}

TEST(LevelSetFromField, PartsWithoutInfluenceAreLeftOutWithoutATrace) {
  // A plate with many holes, blended ribs and a shell: most parts are far from most blocks.
  Field part = make_shape("rounded_box", {{"half", {1.0, 0.15, 1.0}}, {"rounding", {0.04}}});
  const Field rib = translate(make_shape("box", {{"half", {0.9, 0.12, 0.05}}}), {0.0, 0.2, 0.1});
  part = combine(Csg::union_, part, rib, 0.08);
  part = combine(Csg::union_, part, shell(translate(make_shape("sphere", {{"radius", {0.4}}}), {0.3, 0.3, 0.2}), 0.06));
  std::vector<Field> cut = {part};
  for (int i = 0; i < 9; ++i) {
    const Field hole = make_shape("cylinder", {{"radius", {0.11}}, {"half_height", {0.5}}});
    cut.push_back(translate(hole, {0.6 * (i / 3 - 1) + 0.013, 0.0, 0.6 * (i % 3 - 1) - 0.007}));
  }
  const Field field = combine(Csg::difference, cut);
  const LevelSetSettings settings{.voxel_size = 0.02, .half_width_voxels = 4.1232};
  const BesideDistances found = beside_distances(field, settings);
  EXPECT_EQ(found.wrongly, 0);
  EXPECT_GT(found.active, 100'000);
  EXPECT_LT(found.worst_voxels, 1e-5);
}

TEST(LevelSetFromField, OfAFormulaThatIsFarSteeperElsewhereItIsThatOfItsDistances) {
  const unsigned seed = random_seed();
  std::mt19937_64 random(seed);
  const auto number = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  const Field field = quartic(number(3.5, 5.5), number(3.5, 5.5), number(3.5, 5.5), number(8.0, 11.0));
  const BesideDistances found = beside_distances(field, {.voxel_size = 0.04, .half_width_voxels = number(2.0, 5.0)});
  EXPECT_EQ(found.wrongly, 0) << "seed " << seed;
  EXPECT_GT(found.active, 30'000) << "seed " << seed;
  EXPECT_LT(found.worst_voxels, 1e-5) << "seed " << seed;
}

TEST(LevelSetFromField, WhatCannotBeBuiltIsRefusedWithTheFigure) {
  const Field sphere = make_shape("sphere", {{"radius", {1.0}}});
  EXPECT_NE(refusal(make_shape("plane"), {.voxel_size = 0.1}).find("no bounds"), std::string::npos);
  EXPECT_NE(refusal(sphere, {.voxel_size = 0.0}).find("above 0"), std::string::npos);
  EXPECT_NE(refusal(sphere, {.voxel_size = NAN}).find("above 0"), std::string::npos);
  EXPECT_NE(refusal(sphere, {.voxel_size = 0.1, .half_width_voxels = 1.0}).find("1.8"), std::string::npos);
  const std::string thin = refusal(translate(sphere, glm::dvec3(11.0)), {.voxel_size = 50.0});
  EXPECT_NE(thin.find("thinner than a voxel"), std::string::npos) << thin;
  const std::string huge = refusal(sphere, {.voxel_size = 1e-4, .max_bytes = 50'000'000});
  EXPECT_NE(huge.find("of memory, the limit is 50.0 MB"), std::string::npos) << huge;
  EXPECT_NE(refusal(sphere, {.voxel_size = 1e-12}).find("voxels along the longest side"), std::string::npos);
}

TEST(LevelSetFromField, WallsBelowTwoVoxelsAndGapsBelowOneAreWarnedOfAndNothingElseIs) {
  const double h = 0.05;
  const auto warnings = [&](const Field& field) {
    std::string text;
    const LevelSet level_set = level_set_from_field(field, {.voxel_size = h});
    for (const std::string& warning : level_set.info().warnings) text += warning + "\n";
    return text;
  };
  const auto slab = [](double thickness) { return make_shape("box", {{"half", {0.7, 0.6, 0.5 * thickness}}}); };
  const auto pair = [](double gap) {
    const Field box = make_shape("box", {{"half", {0.5, 0.5, 0.5}}});
    return combine(Csg::union_, translate(box, {0.5 + 0.5 * gap, 0.0, 0.0}), translate(box, {-0.5 - 0.5 * gap, 0.0, 0.0}));
  };
  EXPECT_NE(warnings(slab(1.2 * h)).find("walls thinner than two voxels (0.1)"), std::string::npos);
  EXPECT_EQ(warnings(slab(2.2 * h)), "");
  EXPECT_NE(warnings(pair(0.6 * h)).find("gaps narrower than one voxel (0.05)"), std::string::npos);
  EXPECT_EQ(warnings(pair(1.3 * h)), "");
  EXPECT_EQ(warnings(Ellipsoid::jittered(2).field()), "");
  EXPECT_EQ(warnings(make_shape("torus")), "");
}

TEST(LevelSetFromField, ProgressRisesToOne) {
  double last = 0.0;
  bool rising = true;
  level_set_from_field(make_shape("sphere", {{"radius", {1.0}}}), {.voxel_size = 0.05, .progress = [&](double done) {
                                                                     rising = rising && done >= last;
                                                                     last = done;
                                                                   }});
  EXPECT_TRUE(rising);
  EXPECT_EQ(last, 1.0);
}

TEST(LevelSet, TrilinearValuesAreThoseOfTheNodes) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<float> value(-1.0f, 1.0f);
  LevelSetBlock block{};
  for (std::uint64_t& word : block.active) word = ~std::uint64_t{0};
  for (float& v : block.values) v = value(random);
  const LevelSet level_set = level_set_from_blocks(std::span(&block, 1), 0.5, 3.0, "random", {1.0, 2.0, 3.0});
  std::uniform_real_distribution<double> place(0.0, 7.0);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 index(place(random), place(random), place(random));
    const glm::dvec3 p = glm::dvec3(1.0, 2.0, 3.0) + 0.5 * index;
    double truth = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 step(corner & 1, (corner >> 1) & 1, corner >> 2), node = glm::ivec3(glm::floor(index)) + step;
      const glm::dvec3 u = glm::fract(index);
      const glm::dvec3 w = glm::mix(1.0 - u, u, glm::dvec3(step));
      truth += w.x * w.y * w.z * static_cast<double>(block.values[node.x * 64 + node.y * 8 + node.z]);
    }
    double found = 0.0;
    level_set_values(level_set, std::span(&p, 1), std::span(&found, 1));
    EXPECT_NEAR(found, truth, 1e-12);
  }
}

TEST(LevelSetMesh, PolygonsLieOnTheSurfaceAndTheirVolumeIsThatOfTheShape) {
  const glm::dvec3 center(1000.3, -20.1, 0.7);
  const double h = 0.05;
  const LevelSet level_set = level_set_from_field(translate(make_shape("sphere", {{"radius", {1.0}}}), center), {.voxel_size = h});
  const PolygonSoup soup = mesh_from_level_set(level_set);
  ASSERT_GT(soup.face_sizes.size(), 1000u);
  double worst = 0.0, volume = 0.0;
  for (const glm::dvec3& p : soup.positions) worst = std::max(worst, std::abs(glm::distance(p, center) - 1.0));
  EXPECT_LT(worst, 0.1 * h);
  size_t corner = 0;
  for (const int size : soup.face_sizes) {
    const auto at = [&](int k) {
      return soup.positions[static_cast<size_t>(soup.corner_vertices[corner + static_cast<size_t>(k)])] - center;
    };
    for (int k = 2; k < size; ++k) volume += glm::dot(at(0), glm::cross(at(k - 1), at(k))) / 6.0;
    corner += static_cast<size_t>(size);
  }
  // Positive only when wound outwards.
  EXPECT_NEAR(volume, 4.18879, 0.03);
}

TEST(LevelSetCrossings, LieOnTheSurfaceAndEvenlyOverIt) {
  const Ellipsoid ellipsoid = Ellipsoid::jittered(11);
  const LevelSet level_set = level_set_from_field(ellipsoid.field(), {.voxel_size = 0.03});
  const std::vector<glm::dvec3> all = sample_crossings(level_set, 1'000'000), some = sample_crossings(level_set, 500);
  ASSERT_GT(all.size(), 2'000u);
  EXPECT_EQ(some.size(), 500u);
  EXPECT_TRUE(sample_crossings(level_set, 0).empty());
  glm::dvec3 mean(0.0);
  for (const glm::dvec3& p : all) {
    EXPECT_LT(std::abs(ellipsoid.distance(p)), 0.2 * 0.03);
    mean += p / static_cast<double>(all.size());
  }
  EXPECT_LT(glm::distance(mean, ellipsoid.center), 0.03);
  for (size_t k = 0; k < some.size(); ++k) EXPECT_EQ(some[k], all[k * all.size() / some.size()]) << k;
}

}  // namespace
}  // namespace limn
