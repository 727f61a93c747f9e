// Level sets that OpenVDB's vdb_tool makes of meshes that others made: drawn as the mesh is, or limn says what is wrong with them.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "cover.h"
#include "listed_files.h"
#include "raymarch/audit.h"
#include "raymarch/gbuffer.h"
#include "samples/input/input.h"
#include "sdf/error.h"
#include "tests/temporary_folder.h"

namespace limn::foreign {
namespace {

namespace fs = std::filesystem;

struct Variant {
  int voxels = 64;  ///< Along the longest side.
  bool pruned = false, half = false;
  std::string text() const { return fmt::format("{} voxels{}{}", voxels, pruned ? ", pruned" : "", half ? ", half" : ""); }
};

/// LIMN_FOREIGN=all tries every variant of every mesh, which takes an hour; otherwise the variants take turns.
bool everything() {
  const char* const asked = std::getenv("LIMN_FOREIGN");
  return asked != nullptr && std::string(asked) == "all";
}

std::vector<Variant> variants(size_t turn) {
  std::vector<Variant> all;
  for (const int voxels : {32, 64, 128})
    for (const bool pruned : {false, true})
      for (const bool half : {false, true}) all.push_back({voxels, pruned, half});
  if (everything()) return all;
  // One of each size: coarse, middle and fine take another kind of file each time.
  return {all[turn % 4], all[4 + (turn + 1) % 4], all[8 + (turn + 2) % 4]};
}

/// As an OBJ in double precision, which vdb_tool reads.
void write_obj(const Soup& soup, const fs::path& file) {
  std::ofstream stream(file);
  for (const glm::dvec3& p : soup.positions) stream << fmt::format("v {} {} {}\n", p.x, p.y, p.z);
  for (const std::vector<size_t>& face : soup.faces) {
    stream << 'f';
    for (const size_t vertex : face) stream << ' ' << vertex + 1;
    stream << '\n';
  }
}

bool make_level_set(const fs::path& obj, const Variant& variant, const fs::path& vdb) {
  const std::string call = fmt::format("vdb_tool -quiet -read '{}' -mesh2ls dim={} {} -write bits={} '{}' >/dev/null 2>&1", obj.string(),
                                       variant.voxels, variant.pruned ? "-prune" : "", variant.half ? 16 : 32, vdb.string());
  return std::system(call.c_str()) == 0 && fs::exists(vdb);
}

/// Everything that `limn info` says of the volume.
std::vector<std::string> said_of(const SceneInput& input) {
  const SceneObject& object = input.scene.objects.front();
  std::vector<std::string> said = std::get<LevelSetSource>(object.source).level_set.info().warnings;
  for (const Finding& finding : audit(object, {.surface = {.kind = "level_set"}, .thorough = true}))
    if (finding.severity != Severity::info) said.push_back(finding.message);
  return said;
}

Camera camera_of(const Box& box) {
  CameraSettings settings;
  settings.width_px = 200, settings.height_px = 150;
  return resolve_camera(settings, box);
}

void expect_like_the_mesh(const fs::path& vdb, const Soup& soup, const Variant& variant) {
  const Measures of_mesh = measure(soup);
  const Camera camera = camera_of(of_mesh.box);
  const Image<std::uint8_t> covered = covered_pixels(soup, camera);
  const auto pixels = std::count(covered.pixels.begin(), covered.pixels.end(), std::uint8_t{1});
  ExperimentSpec spec;
  spec.input = vdb.string();
  try {
    const SceneInput input = load_input(spec);
    const GBuffer seen = render_gbuffer(build_model(input.scene, {.kind = ""}), camera, {});
    const double voxel_px =
        of_mesh.box.longest_side() / variant.voxels * pixels_per_unit_at(camera, project(camera, of_mesh.box.center()).z);
    const std::int64_t apart = pixels_apart(covered, seen, 1 + static_cast<int>(std::ceil(voxel_px)));
    if (apart <= pixels / 200) return;
    EXPECT_FALSE(said_of(input).empty()) << apart << " of " << pixels << " pixels differ from the mesh, and limn says nothing";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("surface"), std::string::npos) << "refused for no reason that holds: " << error.what();
  }
}

/// Meshes of one group of the list, of which every `step`th takes its turn.
struct Kind {
  const char* name;
  const char* group;
  size_t step;
  size_t at_least;  ///< Level sets made of them.
};

class ForeignVolumes : public testing::TestWithParam<Kind> {};

TEST_P(ForeignVolumes, AreLikeTheirMeshesOrSayWhy) {
  if (std::system("vdb_tool -version >/dev/null 2>&1") != 0) GTEST_SKIP() << "vdb_tool is not installed";
  const Kind& kind = GetParam();
  const fs::path folder = folder_of(kind.group);
  if (folder.empty()) GTEST_SKIP() << "the files of '" << kind.group << "' are not installed";
  const TemporaryFolder work;
  size_t turn = 0, made = 0;
  for (const ListedFile& listed : listed_files(LIMN_SOURCE_DIR "/tests/foreign/files.tsv")) {
    if (listed.group != kind.group || !listed.drawn || !listed.compared) continue;
    if (++turn % (everything() ? 1 : kind.step) != 0) continue;
    const SecondReading mesh = read_by_other(folder / listed.path);
    write_obj(mesh.soup, work.path() / "mesh.obj");
    for (const Variant& variant : variants(turn)) {
      SCOPED_TRACE(listed.path + ", " + variant.text());
      const fs::path vdb = work.path() / "volume.vdb";
      fs::remove(vdb);
      if (!make_level_set(work.path() / "mesh.obj", variant, vdb)) continue;  // vdb_tool makes none of a flat mesh
      ++made;
      expect_like_the_mesh(vdb, mesh.soup, variant);
    }
  }
  EXPECT_GE(made, kind.at_least);
}

INSTANTIATE_TEST_SUITE_P(Kinds, ForeignVolumes,
                         testing::Values(Kind{"OfCgalsMeshes", "cgal", 9, 11}, Kind{"OfAssimpsMeshes", "assimp", 7, 11},
                                         Kind{"OfTheTestData", "data", 1, 3}, Kind{"OfTheModels", "models", 1, 9}),
                         [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace limn::foreign
