#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/MeshToVolume.h>

#include <cstdlib>
#include <fstream>

#include "sdf/error.h"
#include "sdf/guard.h"
#include "sdf/guard_helper.h"
#include "sdf/level_set_data.h"
#include "sdf/level_set_grids.h"
#include "tests/random_seed.h"
#include "tests/sdf/level_set_maker.h"
#include "tests/temporary_folder.h"

namespace limn {
namespace {

namespace fs = std::filesystem;
using testing_tools::Ellipsoid;

/// Files of one test, gone after it.
class LevelSetFiles : public testing::Test {
 protected:
  void SetUp() override { openvdb::initialize(); }

  fs::path write(const openvdb::GridPtrVec& grids, const std::string& name = "volume.vdb") {
    openvdb::io::File file((folder_.path() / name).string());
    file.write(grids);
    file.close();
    return folder_.path() / name;
  }
  static std::string refusal(const fs::path& file, const std::string& grid = {}) {
    try {
      read_level_set(file, grid);
    } catch (const InputError& error) {
      EXPECT_EQ(error.fault().file, file.string());
      return std::string(error.what()).substr(file.string().size());
    }
    ADD_FAILURE() << "accepted";
    return {};
  }
  static openvdb::FloatGrid::Ptr ball(const std::string& name = "ball", float width = 3.0f) {
    auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(1.0f, openvdb::Vec3f(0.3f, 0.2f, 0.1f), 0.1f, width);
    grid->setName(name);
    return grid;
  }
  TemporaryFolder folder_;
};

#define EXPECT_SAYS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

void expect_equal(const LevelSet& a, const LevelSet& b, double value_tolerance) {
  EXPECT_EQ(a.info().name, b.info().name);
  EXPECT_EQ(a.info().active_voxels, b.info().active_voxels);
  EXPECT_NEAR(a.info().voxel_size, b.info().voxel_size, 1e-15);
  EXPECT_NEAR(a.info().half_width_voxels, b.info().half_width_voxels, 0.02);
  EXPECT_LT(glm::distance(a.info().bounds.lower, b.info().bounds.lower), 1e-4);
  EXPECT_LT(glm::distance(a.info().bounds.upper, b.info().bounds.upper), 1e-4);
  const auto va = a.data().accessor(), vb = b.data().accessor();
  std::mt19937_64 random(6);
  const Box box = dilate(transform(a.data().index_from_world, a.info().bounds), 6.0);
  for (int i = 0; i < 50'000; ++i) {
    glm::dvec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = std::uniform_real_distribution(box.lower[axis], box.upper[axis])(random);
    const nanovdb::Coord at = cell_point(p).node;
    ASSERT_EQ(va.isActive(at), vb.isActive(at));
    ASSERT_NEAR(static_cast<double>(va.getValue(at)), static_cast<double>(vb.getValue(at)), value_tolerance);
  }
}

TEST_F(LevelSetFiles, WhatIsSavedIsReadBackAndTwoRunsWriteTheSameBytes) {
  const LevelSet level_set = level_set_from_field(Ellipsoid::jittered(3).field(), {.voxel_size = 0.05, .half_width_voxels = 4.2});
  write_level_set(level_set, folder_.path() / "a.vdb");
  write_level_set(level_set, folder_.path() / "b.vdb");
  const LevelSet again = read_level_set(folder_.path() / "a.vdb", "");
  expect_equal(level_set, again, 0.0);
  const auto bytes = [](const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  EXPECT_EQ(bytes(folder_.path() / "a.vdb"), bytes(folder_.path() / "b.vdb"));
  const std::vector<GridSummary> grids = list_grids(folder_.path() / "a.vdb");
  ASSERT_EQ(grids.size(), 1u);
  EXPECT_EQ(grids[0].grid_class, "level set");
  EXPECT_EQ(grids[0].value_type, "float");
  EXPECT_EQ(grids[0].active_voxels, level_set.info().active_voxels);
}

TEST_F(LevelSetFiles, FloatDoubleAndHalfAreTheSameSurface) {
  const auto single = ball("single");
  const auto twice = std::make_shared<openvdb::DoubleGrid>(*single);
  twice->setGridClass(openvdb::GRID_LEVEL_SET);
  twice->setName("twice");
  const auto half = single->deepCopy();
  half->setName("half");
  half->setSaveFloatAsHalf(true);
  const fs::path file = write({single, twice, half});
  const std::vector<GridSummary> grids = list_grids(file);
  ASSERT_EQ(grids.size(), 3u);
  EXPECT_EQ(grids[0].value_type + grids[1].value_type + grids[2].value_type, "floatdoublehalf");
  const LevelSet a = read_level_set(file, "single"), b = read_level_set(file, "twice"), c = read_level_set(file, "half");
  EXPECT_EQ(a.info().active_voxels, b.info().active_voxels);
  EXPECT_EQ(a.info().active_voxels, c.info().active_voxels);
  EXPECT_NEAR(a.info().half_width_voxels, 3.0, 1e-6);
  for (int i = 0; i < 1000; ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    const glm::dvec3 p = glm::dvec3(0.3, 0.2, 0.1) + testing_tools::random_direction(random);
    std::array<double, 3> value;
    level_set_values(a, std::span(&p, 1), std::span(&value[0], 1));
    level_set_values(b, std::span(&p, 1), std::span(&value[1], 1));
    level_set_values(c, std::span(&p, 1), std::span(&value[2], 1));
    EXPECT_LT(std::abs(value[0]), 2.6e-3);  // a chord of the voxel's length, both curvatures: h^2 / 4
    EXPECT_EQ(value[0], value[1]);
    EXPECT_NEAR(value[0], value[2], 2e-4);
  }
}

TEST_F(LevelSetFiles, TurnedShearedAndMirroredTransformsAreKept) {
  const auto grid = ball();
  auto map = openvdb::math::Mat4d::identity();
  map.preRotate(openvdb::math::Y_AXIS, 0.5);
  map.postScale(openvdb::Vec3d(0.1, 0.2, -0.3));
  map.postTranslate(openvdb::Vec3d(5.0, 6.0, 7.0));
  grid->setTransform(openvdb::math::Transform::createLinearTransform(map));
  const LevelSet level_set = read_level_set(write({grid}), "ball");
  const openvdb::Vec3d truth = grid->transform().indexToWorld(openvdb::Vec3d(3.0, -4.0, 5.0));
  const glm::dvec3 found = level_set.info().world_from_index.point({3.0, -4.0, 5.0});
  EXPECT_LT(glm::distance(found, glm::dvec3(truth.x(), truth.y(), truth.z())), 1e-12);
  write_level_set(level_set, folder_.path() / "again.vdb");
  expect_equal(level_set, read_level_set(folder_.path() / "again.vdb", ""), 0.0);
}

TEST_F(LevelSetFiles, AGridScaledAfterwardsKeepsTheBandItHas) {
  for (const double factor : {0.01, 100.0}) {
    const auto grid = ball();
    grid->setTransform(openvdb::math::Transform::createLinearTransform(0.1 * factor));
    const LevelSet level_set = read_level_set(write({grid}), "");
    EXPECT_NEAR(level_set.info().half_width_voxels, 3.0, 0.1);
    EXPECT_EQ(cells_lacking(level_set, find_gradient("central")), 0);
    EXPECT_GT(cells_lacking(level_set, find_gradient("cubic")), 0);
  }
}

TEST_F(LevelSetFiles, GridsAreChosenByNameAndWrongNamesAnsweredWithWhatIsThere) {
  const auto fog = openvdb::FloatGrid::create(0.0f);
  fog->setName("density");
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  fog->tree().setValue(openvdb::Coord(1, 2, 3), 0.5f);
  const fs::path one = write({fog, ball("ls_ball")}, "one.vdb");
  EXPECT_EQ(read_level_set(one, "").info().name, "ls_ball");
  const std::string wrong = refusal(one, "ls_bal");
  EXPECT_SAYS(wrong, "no such grid (got ls_bal, expected one of ");
  EXPECT_SAYS(wrong, "did you mean 'ls_ball'?");
  EXPECT_SAYS(wrong, "'density' (fog volume, float)");
  EXPECT_SAYS(refusal(one, "density"), "fog volume");
  EXPECT_SAYS(refusal(one, "density"), "class 'level set'");
  const std::string two = refusal(write({ball("a"), ball("b")}, "two.vdb"));
  EXPECT_SAYS(two, "more than one level set");
  EXPECT_SAYS(two, "'a' (level set, float), 'b' (level set, float)");
  EXPECT_SAYS(refusal(write({fog}, "fog.vdb")), "fog volume");
}

TEST_F(LevelSetFiles, EveryKindOfGridThatIsNoNarrowBandIsRefusedWithWhatWouldBeRight) {
  const auto vectors = openvdb::Vec3SGrid::create();
  vectors->setName("velocity");
  vectors->tree().setValue(openvdb::Coord(0, 0, 0), openvdb::Vec3s(1.0f));
  EXPECT_SAYS(refusal(write({vectors}), "velocity"), "a level set of float, double or half");

  const auto staggered = ball();
  staggered->setGridClass(openvdb::GRID_STAGGERED);
  EXPECT_SAYS(refusal(write({staggered}), "ball"), "not a level set by its class (got staggered");

  const auto empty = openvdb::FloatGrid::create(0.3f);
  empty->setName("empty");
  empty->setGridClass(openvdb::GRID_LEVEL_SET);
  EXPECT_SAYS(refusal(write({empty})), "is empty");

  const auto raw = openvdb::FloatGrid::create(0.0f);
  raw->setName("raw");
  raw->setGridClass(openvdb::GRID_LEVEL_SET);
  raw->tree().setValue(openvdb::Coord(0, 0, 0), 1.0f);
  EXPECT_SAYS(refusal(write({raw})), "is not initialised");

  const auto frustum = ball();
  frustum->setTransform(
      openvdb::math::Transform::createFrustumTransform(openvdb::BBoxd(openvdb::Vec3d(0.0), openvdb::Vec3d(100.0)), 0.5, 10.0, 0.1));
  EXPECT_SAYS(refusal(write({frustum})), "frustum");

  const auto outside = ball();
  for (auto leaf = outside->tree().beginLeaf(); leaf; ++leaf)
    for (auto value = leaf->beginValueAll(); value; ++value) value.setValue(std::abs(*value) + 0.01f);
  outside->tree().root().setBackground(0.3f, true);
  for (auto tile = outside->tree().beginValueOff(); tile; ++tile) tile.setValue(0.3f);
  EXPECT_SAYS(refusal(write({outside})), "never change sign");

  const auto broken = ball();
  broken->tree().setValueOn(broken->tree().beginLeaf()->beginValueOn().getCoord(), std::numeric_limits<float>::quiet_NaN());
  EXPECT_SAYS(refusal(write({broken})), "is no number");
}

TEST_F(LevelSetFiles, ABandTooThinIsMeasuredAndFilledIn) {
  const LevelSet whole = read_level_set(write({ball("ball", 3.0f)}), "");
  EXPECT_EQ(cells_lacking(whole, find_gradient("central")), 0);
  // Cut to 1.2 voxels while the background still says 3: the nodes tell.
  const auto cut = ball();
  for (auto leaf = cut->tree().beginLeaf(); leaf; ++leaf)
    for (auto value = leaf->beginValueOn(); value; ++value)
      if (std::abs(*value) > 0.12f) {
        const float side = *value < 0.0f ? -0.3f : 0.3f;
        value.setValue(side);
        value.setValueOff();
      }
  const LevelSet thin = read_level_set(write({cut}), "");
  EXPECT_NEAR(thin.info().half_width_voxels, 1.2, 0.35);
  EXPECT_GT(cells_lacking(thin, find_gradient("cell")), 0);
  const LevelSet filled = complete_band(thin, find_gradient("central"));
  EXPECT_EQ(cells_lacking(filled, find_gradient("central")), 0);
  EXPECT_SAYS(filled.info().warnings.back(), "filled in from the surface in the file");
}

/// A box of quads, one of them left out or not, turned by `angle` so that no node lies on a face, as OpenVDB makes a level set of it.
openvdb::FloatGrid::Ptr box_of_quads(double angle, const openvdb::Vec3d& half, bool open) {
  constexpr int kFaces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
  std::vector<openvdb::Vec3s> points;
  for (int k = 0; k < 8; ++k) {
    const openvdb::Vec3d p((k & 1 ? 1 : -1) * half.x(), (k & 2 ? 1 : -1) * half.y(), (k & 4 ? 1 : -1) * half.z());
    points.emplace_back(std::cos(angle) * p.x() - std::sin(angle) * p.y(), std::sin(angle) * p.x() + std::cos(angle) * p.y(), p.z());
  }
  std::vector<openvdb::Vec4I> quads;
  for (int k = 0; k < (open ? 5 : 6); ++k) quads.emplace_back(kFaces[k][0], kFaces[k][1], kFaces[k][2], kFaces[k][3]);
  const auto transform = openvdb::math::Transform::createLinearTransform(0.05);
  const auto grid = openvdb::tools::meshToSignedDistanceField<openvdb::FloatGrid>(*transform, points, {}, quads, 3.0f, 3.0f);
  grid->setName("box");
  return grid;
}

TEST_F(LevelSetFiles, AnInsideThatLeakedOutOfAnOpenMeshIsSaidAndNoneOfClosedOnes) {
  for (int k = 0; k < 10; ++k) {
    const double angle = 0.11 + 0.13 * k;
    const openvdb::Vec3d half(0.63 + 0.031 * k, 0.57, 0.71 - 0.023 * k);
    const LevelSet closed = read_level_set(write({box_of_quads(angle, half, false)}), "");
    EXPECT_GT(closed.info().band.near_nodes, 1000);
    EXPECT_EQ(moved(closed, {glm::dmat3(2.0), glm::dvec3(0.3)}).info().band.near_nodes, closed.info().band.near_nodes);
    for (const std::string& warning : closed.info().warnings) ADD_FAILURE() << warning;
    // Where nothing at all changes sign it is refused; where crumbs do it is read and said.
    std::string said;
    try {
      const LevelSet open = read_level_set(write({box_of_quads(angle, half, true)}), "");
      EXPECT_GT(open.info().band.unsigned_nodes, open.info().band.near_nodes / 2);
      EXPECT_EQ(moved(open, {glm::dmat3(2.0), glm::dvec3(0.3)}).info().band.unsigned_nodes, open.info().band.unsigned_nodes);
      ASSERT_FALSE(open.info().warnings.empty());
      said = open.info().warnings.back();
      EXPECT_SAYS(said, "of the surface in this volume has no inside");
    } catch (const InputError& error) {
      said = error.what();
      EXPECT_SAYS(said, "never change sign");
    }
    EXPECT_SAYS(said, "limn export with surface = mesh_level_set");
  }
}

TEST_F(LevelSetFiles, AFileCutShortIsRefusedAtEveryLength) {
  const fs::path whole = write({ball("first"), ball("second")});
  std::ifstream stream(whole, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(stream), {});
  std::vector<size_t> lengths{bytes.size() - 1};
  for (size_t percent = 5; percent < 100; percent += 2) lengths.push_back(bytes.size() * percent / 100);
  for (const size_t length : lengths) {
    const fs::path file = folder_.path() / "cut.vdb";
    std::ofstream(file, std::ios::binary) << bytes.substr(0, length);
    try {
      list_grids(file);
      ADD_FAILURE() << "listed though cut to " << length << " of " << bytes.size() << " bytes";
    } catch (const InputError& error) {
      EXPECT_SAYS(std::string(error.what()), "breaks off");
    }
  }
  EXPECT_EQ(list_grids(whole).size(), 2u);
}

TEST_F(LevelSetFiles, BandsThatToolsLeaveBehindAreTheSameSurface) {
  const LevelSet plain = read_level_set(write({ball()}), "");
  const auto expect_same = [&](const openvdb::FloatGrid::Ptr& grid, const char* what) {
    const LevelSet other = read_level_set(write({grid}), "");
    EXPECT_EQ(other.info().band.crossed_cells, plain.info().band.crossed_cells) << what;
    EXPECT_EQ(other.info().bounds.lower, plain.info().bounds.lower) << what;
    EXPECT_EQ(other.info().bounds.upper, plain.info().bounds.upper) << what;
    EXPECT_EQ(cells_lacking(other, find_gradient("central")), 0) << what;
  };
  const auto unflooded = ball();
  for (auto value = unflooded->tree().beginValueOff(); value; ++value) value.setValue(0.3f);
  expect_same(unflooded, "never flood-filled");
  const auto zero = ball();
  for (auto value = zero->tree().beginValueOff(); value; ++value) value.setValue(0.0f);
  expect_same(zero, "0 outside the band");
  const auto switched_off = ball();
  for (auto value = switched_off->beginValueOn(); value; ++value)
    if (*value < -0.02f) value.setValueOff();
  expect_same(switched_off, "inner half switched off, its values left");
  const auto core = ball();
  core->tree().fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(6)), -0.3f, true);
  core->tree().prune();
  expect_same(core, "active inside");
  const auto far_tiles = ball();
  far_tiles->tree().fill(openvdb::CoordBBox(openvdb::Coord(40), openvdb::Coord(80)), 0.3f, true);
  far_tiles->tree().prune();
  expect_same(far_tiles, "active tiles outside");
}

TEST_F(LevelSetFiles, ABallCutByABoxIsClosedWhereItWasCut) {
  const auto cut = ball();
  for (auto value = cut->tree().beginValueAll(); value; ++value)
    if (value.getCoord().x() > 4 && value.getLevel() == 0) {
      value.setValue(0.3f);
      value.setActiveState(false);
    }
  const LevelSet read = read_level_set(write({cut}), "");
  EXPECT_LT(read.info().bounds.upper.x, 0.51);
  const GradientDescriptor& central = find_gradient("central");
  EXPECT_GT(cells_lacking(read, central), 0);
  const LevelSet drawn = complete_band(read, central);
  EXPECT_SAYS(drawn.info().warnings.back(), "the next lower gradient is taken");
  EXPECT_LT(cells_lacking(drawn, central), cells_lacking(read, central) + 1);
}

TEST_F(LevelSetFiles, FilesOfAnotherToolAreRead) {
  if (std::system("command -v vdb_tool > /dev/null 2>&1") != 0) GTEST_SKIP() << "vdb_tool is not installed";
  const fs::path file = folder_.path() / "sphere.vdb";
  const std::string command = "vdb_tool -sphere voxel=0.05 radius=1.0 width=3 -o '" + file.string() + "' > /dev/null 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const LevelSet level_set = read_level_set(file, "");
  EXPECT_NEAR(level_set.info().voxel_size, 0.05, 1e-7);
  EXPECT_NEAR(level_set.info().half_width_voxels, 3.0, 1e-3);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(level_set.info().bounds.lower[axis], -1.0, 1e-3);
    EXPECT_NEAR(level_set.info().bounds.upper[axis], 1.0, 1e-3);
  }
}

TEST_F(LevelSetFiles, WhatIsNoVolumeIsRefused) {
  std::ofstream(folder_.path() / "text.vdb") << "this is a text and no volume at all, whatever its name says";
  EXPECT_SAYS(refusal(folder_.path() / "text.vdb"), "cannot be read as a volume");
  EXPECT_SAYS(refusal(folder_.path() / "none.vdb"), "no such file");
  EXPECT_SAYS(refusal(folder_.path()), "is a directory");
  std::ofstream(folder_.path() / "empty.vdb");
  EXPECT_SAYS(refusal(folder_.path() / "empty.vdb"), "is empty");
}

TEST_F(LevelSetFiles, TheMemoryLimitEndsTheReaderInItsOwnWords) {
  const fs::path file = folder_.path() / "fine.vdb";
  write_level_set(level_set_from_field(make_shape("sphere", {{"radius", {1.0}}}), {.voxel_size = 0.01}), file);
  const std::vector<std::string> arguments{"grid", file.string(), ""};
  EXPECT_NO_THROW(run_guarded("limn-read-vdb", arguments, file));
  if (!kAddressSpaceCanBeLimited) GTEST_SKIP() << "sanitizers need the address space";
  try {
    run_guarded("limn-read-vdb", arguments, file, {.memory_bytes = 8 << 20});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_SAYS(std::string(error.what()), "needs more than 8 MB of memory");
  }
}

TEST_F(LevelSetFiles, DamagedFilesEndInARefusalOrAValidGrid) {
  const fs::path zipped = folder_.path() / "zipped.vdb";
  write_level_set(level_set_from_field(Ellipsoid::jittered(1).field(), {.voxel_size = 0.06}), zipped);
  const auto blosc = ball();
  const fs::path other = write({blosc}, "blosc.vdb");
  // Without compression nothing notices a changed bit but the checks of what it means.
  openvdb::io::File plain((folder_.path() / "plain.vdb").string());
  plain.setCompression(openvdb::io::COMPRESS_NONE);
  plain.write(openvdb::GridPtrVec{ball()});
  plain.close();
  const std::array<fs::path, 3> originals{zipped, other, folder_.path() / "plain.vdb"};
  const std::uint64_t seed = random_seed();
  std::mt19937_64 random(seed);
  int refused = 0, accepted = 0;
  for (int mutant = 0; mutant < 40; ++mutant) {
    std::ifstream stream(originals[static_cast<size_t>(mutant % 3)], std::ios::binary);
    std::string bytes(std::istreambuf_iterator<char>(stream), {});
    const bool cut = mutant % 4 < 2;
    if (cut) {
      bytes.resize(std::uniform_int_distribution<size_t>(1, bytes.size() - 1)(random));
    } else {
      // Half of them in the first kilobyte, where the header, the metadata and the tree's topology are.
      const size_t reach = mutant % 8 < 4 ? bytes.size() : std::min<size_t>(1024, bytes.size());
      for (int flips = 0; flips < 8; ++flips)
        bytes[std::uniform_int_distribution<size_t>(0, reach - 1)(random)] ^= static_cast<char>(1 << (random() % 8));
    }
    const fs::path file = folder_.path() / "mutant.vdb";
    std::ofstream(file, std::ios::binary) << bytes;
    try {
      const LevelSet level_set = read_level_set(file, "");
      ++accepted;
      EXPECT_FALSE(cut) << "a truncated file was taken for whole, seed " << seed << " mutant " << mutant;
      EXPECT_GT(level_set.info().active_voxels, 0);
      EXPECT_TRUE(level_set.info().bounds.finite());
      const glm::dvec3 p = level_set.info().bounds.center();
      double value = 0.0;
      level_set_values(level_set, std::span(&p, 1), std::span(&value, 1));
      EXPECT_TRUE(std::isfinite(value));
    } catch (const InputError& error) {
      ++refused;
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      EXPECT_EQ(error.fault().file, file.string());
    }
  }
  std::printf("%d refused, %d accepted\n", refused, accepted);
  EXPECT_GE(refused, 20);
}

}  // namespace
}  // namespace limn
