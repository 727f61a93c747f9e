// Every file of files.tsv is drawn as another reader sees it, or refused for a reason that holds.

#include <gtest/gtest.h>

#include <map>

#include "cover.h"
#include "listed_files.h"
#include "raymarch/gbuffer.h"
#include "samples/input/input.h"
#include "sdf/error.h"
#include "subdiv/import.h"
#include "tests/temporary_folder.h"

namespace limn::foreign {
namespace {

namespace fs = std::filesystem;

const fs::path kList = LIMN_SOURCE_DIR "/tests/foreign/files.tsv";

/// The files of one group and ending, so that a failure names its kind and kinds run side by side.
std::vector<ListedFile> files_of(const std::string& group, const std::vector<std::string>& endings) {
  std::vector<ListedFile> chosen;
  for (const ListedFile& file : listed_files(kList))
    for (const std::string& ending : endings)
      if (file.group == group && fs::path(file.path).extension() == ending) chosen.push_back(file);
  return chosen;
}

void expect_the_same(const Mesh& mesh, const SecondReading& other) {
  ASSERT_EQ(other.refusal, "") << "limn reads it, " << other.reader << " does not";
  const Measures ours = measure(soup_of(mesh)), theirs = measure(other.soup);
  // assimp moves the parts of a scene in single precision, where places fall together that are apart.
  const bool single_precision = other.reader == "assimp";
  const double lost = single_precision ? 1e-3 * static_cast<double>(theirs.used_vertices) : 0.0;
  EXPECT_EQ(ours.faces, theirs.faces);
  EXPECT_NEAR(static_cast<double>(ours.used_vertices), static_cast<double>(theirs.used_vertices), lost);
  EXPECT_NEAR(ours.area, theirs.area, 1e-5 * theirs.area);
  const double tolerance = (single_precision ? 1e-5 : 1e-6) * glm::length(theirs.box.upper - theirs.box.lower);
  EXPECT_LE(glm::distance(ours.box.lower, theirs.box.lower), tolerance);
  EXPECT_LE(glm::distance(ours.box.upper, theirs.box.upper), tolerance);
}

/// Drawn from where limn looks at it by itself: what polygons cover is hit, nothing else is.
void expect_drawn(const fs::path& file, const SecondReading& other, bool compared) {
  ExperimentSpec spec;
  spec.input = file.string();
  const SceneInput input = load_input(spec);
  CameraSettings settings;
  settings.width_px = 160, settings.height_px = 120;
  const Camera camera = resolve_camera(settings, bounds(input.scene));
  const SceneModel model = build_model(input.scene, {.kind = ""});
  const GBuffer seen = render_gbuffer(model, camera, {});
  const HitCounts counts = count_hits(seen);
  EXPECT_GT(counts.hits, 0) << "an empty picture";
  EXPECT_EQ(counts.out_of_steps, 0);
  if (!compared) return;
  EXPECT_LE(pixels_apart(covered_pixels(other.soup, camera), seen), counts.hits / 1000) << "of " << counts.hits << " hits";
}

void check(const ListedFile& listed, const fs::path& file) {
  SCOPED_TRACE(listed.group + " " + listed.path);
  ASSERT_TRUE(fs::exists(file)) << "the list names a file that its package does not have";
  const SecondReading other = read_by_other(file);
  try {
    const Mesh mesh = load_mesh(file);
    ASSERT_TRUE(listed.drawn) << "read, and listed as refused: " << listed.reason;
    if (listed.compared) expect_the_same(mesh, other);
    expect_drawn(file, other, listed.compared);
  } catch (const InputError& error) {
    const std::string message = error.what();
    ASSERT_FALSE(listed.drawn) << "refused: " << message;
    const size_t bar = listed.reason.find(" | ");
    EXPECT_NE(message.find(listed.reason.substr(0, bar)), std::string::npos) << message;
    if (bar == std::string::npos) {
      const bool nothing_there = other.soup.faces.empty();
      EXPECT_TRUE(!other.refusal.empty() || nothing_there)
          << other.reader << " reads it, and the list does not say why limn does not: " << message;
    }
  }
}

struct Kind {
  const char* name;
  const char* group;
  std::vector<std::string> endings;
  int files;  ///< In the list.
};

class ForeignFiles : public testing::TestWithParam<Kind> {};

TEST_P(ForeignFiles, AreDrawnOrRefusedAsListed) {
  const Kind& kind = GetParam();
  const fs::path folder = folder_of(kind.group);
  if (folder.empty()) GTEST_SKIP() << "the files of '" << kind.group << "' are not installed";
  int checked = 0;
  for (const ListedFile& listed : files_of(kind.group, kind.endings)) {
    check(listed, folder / listed.path);
    ++checked;
  }
  EXPECT_EQ(checked, kind.files);
}

INSTANTIATE_TEST_SUITE_P(Kinds, ForeignFiles,
                         testing::Values(Kind{"CgalOff", "cgal", {".off"}, 139}, Kind{"CgalPlyAndStl", "cgal", {".ply", ".stl"}, 15},
                                         Kind{"AssimpObj", "assimp", {".obj"}, 25},
                                         Kind{"AssimpOffPlyAndStl", "assimp", {".off", ".ply", ".stl", ".STL"}, 22},
                                         Kind{"AssimpGltf", "assimp", {".gltf", ".glb"}, 53}, Kind{"DataObj", "data", {".obj"}, 4},
                                         Kind{"ModelsObj", "models", {".obj"}, 10}),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(ForeignFormats, BinaryOffThatCgalWrites) {
  const TemporaryFolder folder;
  int written = 0;
  for (const std::string group : {"cgal", "data", "models"})
    for (const ListedFile& listed : files_of(group, {".off", ".obj"})) {
      if (folder_of(group).empty() || !listed.drawn || !listed.compared) continue;
      SCOPED_TRACE(listed.path);
      const Soup soup = soup_of(load_mesh(folder_of(group) / listed.path));
      const fs::path file = folder.path() / "binary.off";
      write_binary_off(soup, file);
      const Mesh mesh = load_mesh(file);
      ASSERT_EQ(mesh.face_sizes.size(), soup.faces.size());
      const Measures ours = measure(soup_of(mesh)), theirs = measure(soup);
      EXPECT_NEAR(ours.area, theirs.area, 1e-4 * theirs.area);
      ++written;
    }
  if (written == 0) GTEST_SKIP() << "no files are installed";
  EXPECT_GT(written, 20);
}

/// A file that a package gains or loses is seen here, not skipped over.
TEST(ForeignList, TheListHoldsEveryMeshOfItsPackages) {
  std::map<std::string, int> listed;
  for (const ListedFile& file : listed_files(kList)) ++listed[file.group + " " + file.path];
  for (const auto& [name, count] : listed) EXPECT_EQ(count, 1) << name;
  for (const std::string group : {"assimp", "cgal", "data", "models"}) {
    const fs::path folder = folder_of(group);
    if (folder.empty()) continue;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.is_regular_file() && is_mesh_file(entry.path())) {
        EXPECT_EQ(listed.count(group + " " + fs::relative(entry.path(), folder).string()), 1u) << group << " " << entry.path();
      }
  }
}

}  // namespace
}  // namespace limn::foreign
