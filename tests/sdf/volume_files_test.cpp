// What files say beside their voxels: names, metadata, value types, several grids; and NanoVDB's own format.

#include <gtest/gtest.h>
#if __has_include(<zlib.h>)
#define NANOVDB_USE_ZIP
#endif
#if __has_include(<blosc.h>)
#define NANOVDB_USE_BLOSC
#endif
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <fstream>

#include "sdf/error.h"
#include "sdf/level_set_data.h"
#include "sdf/level_set_grids.h"
#include "tests/temporary_folder.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

class VolumeFiles : public testing::Test {
 protected:
  void SetUp() override { openvdb::initialize(); }
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  fs::path write(const openvdb::GridPtrVec& grids, const std::string& name = "volume.vdb") const {
    openvdb::io::File file(path(name).string());
    file.write(grids);
    file.close();
    return path(name);
  }
  static openvdb::FloatGrid::Ptr ball(const std::string& name, float radius = 1.0f) {
    auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(radius, openvdb::Vec3f(0.3f, 0.2f, 0.1f), 0.1f, 3.0f);
    grid->setName(name);
    return grid;
  }
  static std::string refusal(const std::function<void()>& read) {
    try {
      read();
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "accepted";
    return {};
  }
  static openvdb::GridBase::Ptr one_in(const fs::path& file, const std::string& name) {
    openvdb::io::File source(file.string());
    source.open(false);
    return source.readGrid(name);
  }
  TemporaryFolder folder_;
};

#define EXPECT_SAYS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

TEST_F(VolumeFiles, GridsOfOneNameAreShownAndChosenByTheirIndex) {
  const fs::path file = write({ball("ball", 1.0f), ball("ball", 0.5f), ball("other", 0.7f)});
  std::vector<std::string> names, by_openvdb;
  std::vector<std::int64_t> voxels;
  for (const GridSummary& grid : list_grids(file)) {
    names.push_back(grid.name);
    voxels.push_back(grid.active_voxels);
  }
  openvdb::io::File source(file.string());
  source.open(false);
  for (auto name = source.beginName(); name != source.endName(); ++name) by_openvdb.push_back(*name);
  std::sort(names.begin(), names.end());
  std::sort(by_openvdb.begin(), by_openvdb.end());
  EXPECT_EQ(names, by_openvdb);
  EXPECT_EQ(names, (std::vector<std::string>{"ball[0]", "ball[1]", "other"}));
  for (const GridSummary& grid : list_grids(file)) {
    const LevelSet level_set = read_level_set(file, grid.name);
    EXPECT_EQ(level_set.info().active_voxels, grid.active_voxels) << grid.name;
    EXPECT_EQ(static_cast<std::int64_t>(source.readGrid(grid.name)->activeVoxelCount()), grid.active_voxels) << grid.name;
    EXPECT_EQ(level_set.info().name, grid.name == "other" ? "other" : "ball");
  }
  const std::string both = refusal([&] { read_level_set(file, "ball"); });
  EXPECT_SAYS(both, "more than one grid has that name");
  EXPECT_SAYS(both, "'ball[1]' (level set, float)");
  EXPECT_SAYS(refusal([&] { read_level_set(file, "ball[2]"); }), "did you mean 'ball[");
}

TEST_F(VolumeFiles, AllLevelSetsAreReadUnlessSomeAreNamed) {
  const auto fog = openvdb::FloatGrid::create(0.0f);
  fog->setName("density");
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  fog->tree().setValue(openvdb::Coord(1, 2, 3), 0.5f);
  const auto empty = openvdb::FloatGrid::create(0.3f);
  empty->setName("empty");
  empty->setGridClass(openvdb::GRID_LEVEL_SET);
  const fs::path file = write({ball("a"), fog, ball("b", 0.5f), empty});
  const auto names = [&](const std::vector<std::string>& asked) {
    std::string text;
    for (const NamedLevelSet& grid : read_level_sets(file, asked).grids) text += grid.name + " ";
    return text;
  };
  EXPECT_EQ(names({}), "a b ");
  EXPECT_EQ(names({"all"}), "a b ");
  EXPECT_EQ(names({"b", "a"}), "b a ");
  const ReadLevelSets all = read_level_sets(file, {});
  ASSERT_EQ(all.left_out.size(), 1u);
  EXPECT_SAYS(all.left_out.front(), "'empty' is left out: ");
  EXPECT_SAYS(refusal([&] { names({"a", "empty"}); }), "is empty");
  EXPECT_SAYS(refusal([&] { read_level_sets(write({fog}, "fog.vdb"), {}); }), "fog volume");
}

TEST_F(VolumeFiles, InstancesCountTheVoxelsTheyShare) {
  const auto first = ball("first");
  const auto second = std::make_shared<openvdb::FloatGrid>(*first, openvdb::ShallowCopy{});
  second->setName("second");
  second->setTransform(openvdb::math::Transform::createLinearTransform(0.2));
  const fs::path file = write({first, second});
  for (const GridSummary& grid : list_grids(file)) {
    EXPECT_EQ(grid.active_voxels, static_cast<std::int64_t>(first->activeVoxelCount())) << grid.name;
    const LevelSet level_set = read_level_set(file, grid.name);
    EXPECT_EQ(level_set.info().active_voxels, grid.active_voxels);
    EXPECT_NEAR(level_set.info().voxel_size, grid.name == "first" ? 0.1 : 0.2, 1e-7);
  }
}

TEST_F(VolumeFiles, WritingKeepsMetadataNamesAndValueTypes) {
  const auto single = ball("single");
  single->setCreator("somebody");
  single->insertMeta("note", openvdb::StringMetadata("made by hand"));
  single->insertMeta("weight", openvdb::FloatMetadata(0.25f));
  single->insertMeta("axis", openvdb::Vec3SMetadata(openvdb::Vec3s(1.0f, 2.0f, 3.0f)));
  single->insertMeta("closed", openvdb::BoolMetadata(true));
  single->insertMeta("matrix", openvdb::Mat4DMetadata(openvdb::Mat4d::identity()));
  const auto twice = std::make_shared<openvdb::DoubleGrid>(*ball("twice"));
  twice->setGridClass(openvdb::GRID_LEVEL_SET);
  twice->setName("twice");
  // Values that no float is.
  for (auto value = twice->beginValueOn(); value; ++value) value.setValue(*value * (1.0 + 1e-12) + 1e-13);
  const auto half = ball("half");
  half->setSaveFloatAsHalf(true);
  const fs::path file = write({single, twice, half});
  std::vector<LevelSet> level_sets;
  for (const NamedLevelSet& grid : read_level_sets(file, {}).grids) level_sets.push_back(grid.level_set);
  ASSERT_EQ(level_sets.size(), 3u);
  const fs::path again = path("again.vdb");
  write_level_sets(level_sets, again);

  std::map<std::string, std::string> types;
  for (const GridSummary& grid : list_grids(again)) types[grid.name] = grid.value_type;
  EXPECT_EQ(types, (std::map<std::string, std::string>{{"single", "float"}, {"twice", "double"}, {"half", "half"}}));
  for (const std::string name : {"single", "twice", "half"}) {
    const auto before = one_in(file, name), after = one_in(again, name);
    EXPECT_EQ(after->valueType(), before->valueType()) << name;
    EXPECT_EQ(after->getGridClass(), openvdb::GRID_LEVEL_SET) << name;
    EXPECT_EQ(after->saveFloatAsHalf(), before->saveFloatAsHalf()) << name;
    EXPECT_TRUE(after->transform() == before->transform()) << name;
    EXPECT_EQ(after->activeVoxelCount(), before->activeVoxelCount()) << name;
    int entries = 0;
    for (auto meta = before->beginMeta(); meta != before->endMeta(); ++meta) {
      if (meta->first.starts_with("file_")) continue;
      ++entries;
      ASSERT_TRUE((*after)[meta->first]) << name << " has lost " << meta->first;
      EXPECT_TRUE(*(*after)[meta->first] == *meta->second) << name << " " << meta->first;
    }
    EXPECT_GE(entries, name == "single" ? 8 : 2) << name;
  }
  const auto exact = openvdb::gridPtrCast<openvdb::DoubleGrid>(one_in(again, "twice"));
  int not_single = 0;
  for (auto value = twice->cbeginValueOn(); value; ++value) {
    ASSERT_EQ(exact->tree().getValue(value.getCoord()), *value);
    not_single += static_cast<double>(static_cast<float>(*value)) != *value ? 1 : 0;
  }
  EXPECT_GT(not_single, 1000);
  const auto halves = openvdb::gridPtrCast<openvdb::FloatGrid>(one_in(again, "half")),
             halves_before = openvdb::gridPtrCast<openvdb::FloatGrid>(one_in(file, "half"));
  for (auto value = halves_before->cbeginValueOn(); value; ++value) ASSERT_EQ(halves->tree().getValue(value.getCoord()), *value);
}

TEST_F(VolumeFiles, WritingKeepsTheMetadataOfTheFile) {
  openvdb::MetaMap of_file;
  of_file.insertMeta("scene", openvdb::StringMetadata("shot 12"));
  of_file.insertMeta("frame", openvdb::Int32Metadata(7));
  const fs::path file = path("with.vdb"), again = path("again.vdb");
  openvdb::io::File(file.string()).write({ball("a"), ball("b")}, of_file);
  const std::vector<LevelSet> both{read_level_set(file, "a"), read_level_set(file, "b")};
  write_level_sets(both, again);
  openvdb::io::File written(again.string());
  written.open();
  const openvdb::MetaMap::Ptr kept = written.getMetadata();
  EXPECT_EQ(kept->metaValue<std::string>("scene"), "shot 12");
  EXPECT_EQ(kept->metaValue<std::int32_t>("frame"), 7);
  EXPECT_EQ(kept->metaCount(), 2u);
}

TEST_F(VolumeFiles, AGridWithoutAClassIsALevelSetWhereItsValuesChangeSign) {
  const auto ball_without = ball("ball"), outside = ball("outside");
  for (const auto& grid : {ball_without, outside}) grid->setGridClass(openvdb::GRID_UNKNOWN);
  for (auto value = outside->beginValueOn(); value; ++value) value.setValue(std::abs(*value));
  const LevelSet drawn = read_level_set(write({ball_without}), "");
  EXPECT_EQ(drawn.info().active_voxels, static_cast<std::int64_t>(ball_without->activeVoxelCount()));
  EXPECT_SAYS(drawn.info().warnings.back(), "'ball' has no class");
  EXPECT_SAYS(refusal([&] { read_level_set(write({outside}), ""); }), "has no class, and its values do not change sign");
  // A level set goes before them, and all of them are taken where there is none.
  EXPECT_EQ(read_level_set(write({ball_without, ball("marked")}), "").info().name, "marked");
  EXPECT_EQ(read_level_sets(write({ball_without, ball("marked")}), {}).grids.size(), 1u);
  const ReadLevelSets both = read_level_sets(write({ball_without, outside}), {});
  EXPECT_EQ(both.grids.size(), 1u);
  EXPECT_EQ(both.left_out.size(), 1u);
}

TEST_F(VolumeFiles, ARotatedGridStandsWhereItStandsInEitherFormat) {
  const auto grid = ball("ball");
  openvdb::math::Transform::Ptr placed = openvdb::math::Transform::createLinearTransform(0.1);
  placed->postRotate(0.4, openvdb::math::X_AXIS);
  placed->postRotate(0.7, openvdb::math::Z_AXIS);
  placed->postTranslate(openvdb::Vec3d(1.0, 2.0, 3.0));
  grid->setTransform(placed);
  const fs::path file = path("rotated.nvdb");
  nanovdb::io::writeGrid(file.string(), nanovdb::openToNanoVDB<nanovdb::HostBuffer, openvdb::FloatTree>(*grid));
  const LevelSet nano = read_level_set(file, ""), vdb = read_level_set(write({grid}), "");
  for (const glm::dvec3& index : {glm::dvec3(0.0), glm::dvec3(10.0, 0.0, 0.0), glm::dvec3(0.0, 10.0, 0.0), glm::dvec3(3.0, -4.0, 5.0)}) {
    const openvdb::Vec3d truth = grid->indexToWorld(openvdb::Vec3d(index.x, index.y, index.z));
    for (const LevelSet* level_set : {&nano, &vdb})
      EXPECT_LT(glm::distance(level_set->info().world_from_index.point(index), glm::dvec3(truth.x(), truth.y(), truth.z())), 1e-6);
  }
}

TEST_F(VolumeFiles, AGridThatCannotBeReadTakesNoOtherAlong) {
  const auto broken = ball("a");
  // Nothing says how many voxels it has, and what it holds is no distance.
  for (auto value = broken->beginValueOn(); value; ++value) value.setValue(std::numeric_limits<float>::quiet_NaN());
  const ReadLevelSets read = read_level_sets(write({broken, ball("b"), ball("c")}), {});
  EXPECT_EQ(read.grids.size(), 2u);
  ASSERT_EQ(read.left_out.size(), 1u);
  EXPECT_SAYS(read.left_out[0], "'a' is left out");
}

TEST_F(VolumeFiles, GridsNeedNoStatistics) {
  const auto grid = ball("ball");
  grid->setGridClass(openvdb::GRID_UNKNOWN);
  const fs::path file = path("plain.vdb");
  openvdb::io::File target(file.string());
  target.setGridStatsMetadataEnabled(false);
  target.write({grid});
  target.close();
  EXPECT_EQ(list_grids(file).at(0).active_voxels, -1);
  EXPECT_EQ(read_level_set(file, "").info().active_voxels, static_cast<std::int64_t>(grid->activeVoxelCount()));
  EXPECT_EQ(read_level_sets(file, {}).grids.size(), 1u);
}

TEST_F(VolumeFiles, InstancesInStreamsShareTheirVoxels) {
  const auto first = ball("first");
  const auto second = std::make_shared<openvdb::FloatGrid>(*first, openvdb::ShallowCopy{});
  second->setName("second");
  second->setTransform(openvdb::math::Transform::createLinearTransform(0.2));
  const fs::path file = path("stream.vdb");
  {
    std::ofstream stream(file, std::ios::binary);
    openvdb::io::Stream(stream).write(openvdb::GridCPtrVec{first, second});
  }
  for (const std::string name : {"first", "second"})
    EXPECT_EQ(read_level_set(file, name).info().active_voxels, static_cast<std::int64_t>(first->activeVoxelCount())) << name;
  EXPECT_NEAR(read_level_set(file, "second").info().voxel_size, 0.2, 1e-12);
}

TEST_F(VolumeFiles, DistancesInVoxelsOfUnequalSidesAreTakenForDistances) {
  const auto grid = openvdb::FloatGrid::create(3.0f);
  grid->setName("long");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  openvdb::math::Mat4d matrix = openvdb::math::Mat4d::identity();
  matrix(2, 2) = 2.0;
  grid->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  for (int x = -16; x <= 16; ++x)
    for (int y = -16; y <= 16; ++y)
      for (int z = -8; z <= 8; ++z) {
        const double distance = glm::length(glm::dvec3(x, y, 2.0 * z)) - 12.0;
        const openvdb::Coord at(x, y, z);
        if (std::abs(distance) < 3.0)
          grid->tree().setValue(at, static_cast<float>(distance));
        else if (distance < 0.0)
          grid->tree().setValueOff(at, -3.0f);
      }
  const LevelSet level_set = read_level_set(write({grid}), "");
  EXPECT_DOUBLE_EQ(level_set.data().per_voxel, 1.0);
  EXPECT_GT(level_set.info().half_width_voxels, 2.4);
}

TEST_F(VolumeFiles, VoxelsThatNoFileHoldsAreRefusedInWords) {
  const LevelSet small = moved(read_level_set(write({ball("ball")}), ""), {glm::dmat3(1e-5), glm::dvec3(0.0)});
  EXPECT_SAYS(refusal([&] { write_level_set(small, path("small.vdb")); }), "voxels as small as this");
  EXPECT_FALSE(fs::exists(path("small.vdb")));
}

TEST_F(VolumeFiles, AMovedGridHoldsTheDistancesOfItsNewPlace) {
  const fs::path file = write({ball("ball")});
  Affine placed;
  placed.linear = glm::dmat3({0.0, 2.0, 0.0}, {-2.0, 0.0, 0.0}, {0.0, 0.0, -2.0});
  placed.translation = {5.0, 6.0, 7.0};
  const LevelSet there = moved(read_level_set(file, ""), placed);
  EXPECT_NEAR(there.info().voxel_size, 0.2, 1e-7);
  EXPECT_NEAR(there.info().half_width_voxels, 3.0, 1e-3);
  const glm::dvec3 middle = placed.point({0.3, 0.2, 0.1});
  for (const double off : {-0.4, -0.1, 0.0, 0.2, 0.45}) {
    const glm::dvec3 point = middle + glm::dvec3(0.0, 0.0, 2.0 + off);
    double value = 0.0;
    level_set_values(there, std::span(&point, 1), std::span(&value, 1));
    EXPECT_NEAR(value, off, 6e-3);
  }
}

/// NanoVDB's file of the ball, with values of one of its types.
template <class Build>
nanovdb::GridHandle<nanovdb::HostBuffer> nano(const openvdb::FloatGrid& grid) {
  return nanovdb::openToNanoVDB<nanovdb::HostBuffer, openvdb::FloatTree, Build>(grid, nanovdb::StatsMode::All, nanovdb::ChecksumMode::Full,
                                                                                0);
}

TEST_F(VolumeFiles, NanoVdbIsReadInEveryTypeThatHoldsDistancesAndEveryCodec) {
  const openvdb::FloatGrid::Ptr truth = ball("ball");
  const LevelSet original = read_level_set(write({truth}), "");
  struct Kind {
    std::string type;
    nanovdb::GridHandle<nanovdb::HostBuffer> handle;
    double tolerance;  // of a distance; the band's range is 0.6
  };
  std::vector<Kind> kinds;
  kinds.push_back({"float", nano<float>(*truth), 0.0});
  kinds.push_back({"Fp4", nano<nanovdb::Fp4>(*truth), 0.6 / 15.0});
  kinds.push_back({"Fp8", nano<nanovdb::Fp8>(*truth), 0.6 / 255.0});
  kinds.push_back({"Fp16", nano<nanovdb::Fp16>(*truth), 0.6 / 65535.0});
  kinds.push_back({"FpN", nano<nanovdb::FpN>(*truth), 0.02});
  for (Kind& kind : kinds)
    for (const nanovdb::io::Codec codec : {nanovdb::io::Codec::NONE, nanovdb::io::Codec::ZIP, nanovdb::io::Codec::BLOSC}) {
      const fs::path file = path(kind.type + ".nvdb");
      nanovdb::io::writeGrid(file.string(), kind.handle, codec);
      const std::vector<GridSummary> grids = list_grids(file);
      ASSERT_EQ(grids.size(), 1u);
      EXPECT_EQ(grids[0].name + " " + grids[0].value_type + " " + grids[0].grid_class, "ball " + kind.type + " level set");
      EXPECT_NEAR(grids[0].voxel_size, 0.1, 1e-7);
      EXPECT_EQ(grids[0].active_voxels, static_cast<std::int64_t>(truth->activeVoxelCount()));
      const LevelSet level_set = read_level_set(file, "");
      EXPECT_EQ(level_set.info().name, "ball");
      EXPECT_EQ(level_set.info().active_voxels, original.info().active_voxels);
      const auto a = original.data().accessor(), b = level_set.data().accessor();
      double worst = 0.0;
      for (auto value = truth->cbeginValueOn(); value; ++value) {
        const nanovdb::Coord at(value.getCoord().x(), value.getCoord().y(), value.getCoord().z());
        worst = std::max(worst, std::abs(static_cast<double>(a.getValue(at) - b.getValue(at))));
      }
      EXPECT_LE(worst, 1.05 * kind.tolerance) << kind.type;
      EXPECT_EQ(worst > 0.0, kind.tolerance > 0.0) << kind.type;
    }
  const auto twice = std::make_shared<openvdb::DoubleGrid>(*truth);
  twice->setGridClass(openvdb::GRID_LEVEL_SET);
  twice->setName("twice");
  nanovdb::io::writeGrid(path("double.nvdb").string(), nanovdb::openToNanoVDB<nanovdb::HostBuffer, openvdb::DoubleTree>(*twice));
  EXPECT_EQ(list_grids(path("double.nvdb")).front().value_type, "double");
  EXPECT_EQ(read_level_set(path("double.nvdb"), "twice").info().active_voxels, original.info().active_voxels);
}

TEST_F(VolumeFiles, NanoVdbOfOtherKindsOrDamagedIsRefusedByName) {
  const auto vectors = openvdb::Vec3SGrid::create();
  vectors->setName("velocity");
  vectors->tree().setValue(openvdb::Coord(0, 0, 0), openvdb::Vec3s(1.0f));
  std::vector<nanovdb::GridHandle<nanovdb::HostBuffer>> handles;
  handles.push_back(nanovdb::openToNanoVDB<nanovdb::HostBuffer, openvdb::Vec3STree>(*vectors));
  handles.push_back(nano<float>(*ball("ball")));
  handles.push_back(nano<float>(*ball("ball", 0.5f)));
  nanovdb::io::writeGrids(path("three.nvdb").string(), handles);
  EXPECT_SAYS(refusal([&] { read_level_set(path("three.nvdb"), "velocity"); }), "does not hold distances (got Vec3f");
  EXPECT_EQ(read_level_sets(path("three.nvdb"), {}).grids.size(), 2u);
  EXPECT_EQ(read_level_set(path("three.nvdb"), "ball[1]").info().active_voxels,
            static_cast<std::int64_t>(ball("ball", 0.5f)->activeVoxelCount()));

  std::ifstream stream(path("three.nvdb"), std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(stream), {});
  const auto damaged = [&](const std::string& content) {
    std::ofstream(path("damaged.nvdb"), std::ios::binary) << content;
    return refusal([&] { read_level_set(path("damaged.nvdb"), "ball[1]"); });
  };
  for (const double share : {0.001, 0.1, 0.5, 0.999})
    EXPECT_SAYS(damaged(bytes.substr(0, static_cast<size_t>(share * static_cast<double>(bytes.size())))), "breaks off");
  std::string later = bytes;
  later[7] = '2';
  EXPECT_SAYS(damaged(later), "later format of NanoVDB");
  // A changed value is found by the checksum.
  std::string changed = bytes;
  changed[bytes.size() - 5000] = static_cast<char>(changed[bytes.size() - 5000] ^ 0x40);
  EXPECT_SAYS(damaged(changed), "cannot be read as a volume");
}

}  // namespace
}  // namespace limn
