// Truth of awkward cages against the silhouettes of their meshes of level 7: within 0.02 px, or not called exact.

#include <fmt/core.h>

#include <map>

#include "raymarch/truth.h"
#include "tests/raymarch/awkward_cages.h"
#include "tests/raymarch/brute_silhouette.h"

namespace limn::test {
namespace {

constexpr int kViews = 2, kSide_px = 160;
constexpr double kTolerance_px = 0.02;
constexpr std::int64_t kMostFaces = 150'000;

/// Of level 7, or as fine as edges of a pixel want: the mesh's own chords are then within 0.005 px.
Mesh fine_mesh(const AwkwardCage& cage) {
  int level = 7;
  while (level > 4 && predict_refined_size(cage.mesh, cage.scheme, level).faces > kMostFaces) --level;
  if (const char* l = std::getenv("LEVEL")) level = std::atoi(l);
  return refine(cage.mesh, {cage.scheme, level, true});
}

Camera view_of(const Scene& scene, size_t cage, int index) {
  std::mt19937 random(static_cast<unsigned>(100 * cage) + static_cast<unsigned>(index));
  const auto draw = [&] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
  CameraSettings settings = view(kSide_px, kSide_px, index % 2 ? Projection::orthographic : Projection::perspective);
  settings.direction = glm::normalize(glm::dvec3(draw(), draw(), draw()) + glm::dvec3(0.01));
  return framing(scene, settings);
}

struct Sum {
  int views = 0, exact = 0;
  Agreement all;
};

void add(const BorderTruth& truth, const Agreement& seen, Sum& sum) {
  ++sum.views;
  sum.exact += truth.exact;
  sum.all.length_px += seen.length_px, sum.all.missing_px += seen.missing_px;
  sum.all.extra_px += seen.extra_px, sum.all.wrong_px += seen.wrong_px;
  if (truth.exact) sum.all.worst_px = std::max(sum.all.worst_px, seen.worst_px);
}

TEST(TruthAwkwardCages, AreWithinAFiftiethOfAPixelOrNotCalledExact) {
  const std::vector<AwkwardCage> cages = awkward_cages();
  EXPECT_GE(cages.size(), 60u);
  std::map<std::string, Sum> sums;
  const char* only = std::getenv("CAGE");
  for (size_t c = 0; c < cages.size(); ++c) {
    const AwkwardCage& cage = cages[c];
    if (only && cage.kind.find(only) == std::string::npos && cage.name.find(only) == std::string::npos) continue;
    const Scene scene = scene_of({object_of(cage.mesh, cage.scheme)});
    const Mesh fine = fine_mesh(cage);
    const BruteSilhouette brute(fine);
    for (int i = 0; i < kViews; ++i) {
      const Camera camera = view_of(scene, c, i);
      TruthSettings settings;
      settings.threshold = 0.0;
      const BorderTruth truth = solve_truth(scene, camera, settings, {});
      const Agreement seen = agreement_of(truth.curves, brute.segments(camera), kTolerance_px);
      add(truth, seen, sums[cage.kind]);
      fmt::print("{:28} {:34} {} {:6} {:7.1f} px: missing {:6.2f} extra {:6.2f} wrong {:6.2f} worst {:.4f}\n", cage.kind, cage.name, i,
                 truth.exact ? "exact" : "NOT", seen.length_px, seen.missing_px, seen.extra_px, seen.wrong_px, seen.worst_px);
    }
  }
  for (const auto& [kind, sum] : sums)
    fmt::print("{:28} {:3} views {:3} exact {:8.1f} px: missing {:.2f}, extra {:.2f}, wrong side {:.2f}, worst {:.4f}\n", kind, sum.views,
               sum.exact, sum.all.length_px, sum.all.missing_px, sum.all.extra_px, sum.all.wrong_px, sum.all.worst_px);
}

}  // namespace
}  // namespace limn::test
