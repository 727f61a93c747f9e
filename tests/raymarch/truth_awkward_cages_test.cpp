// Truth of awkward cages against the silhouettes of their meshes of level 7: within 0.02 px, or not called exact.

#include <fmt/core.h>

#include <map>

#include "raymarch/truth.h"
#include "tests/raymarch/awkward_cages.h"
#include "tests/raymarch/silhouette_agreement.h"

namespace limn::test {
namespace {

constexpr int kViews = 2, kSide_px = 160;
constexpr double kTolerance_px = 0.02;
constexpr std::int64_t kMostFaces = 150'000, kMostFacesOfFins = 600'000;

/// Of level 7, or as fine as edges of about a pixel want. What its chords may be off by is in BruteSegment::floor_px, mostly 0.003 px.
/// Where three faces meet in an edge that ends, a mesh's edges there pass for creases: of level 8 they are short enough.
Mesh fine_mesh(const AwkwardCage& cage) {
  const bool fins = cage.kind == "edges with three faces";
  int level = fins ? 8 : 7;
  while (level > 4 && predict_refined_size(cage.mesh, cage.scheme, level).faces > (fins ? kMostFacesOfFins : kMostFaces)) --level;
  return refine(cage.mesh, {cage.scheme, level, true});
}

Camera view_of(const Scene& scene, size_t cage, int index) {
  std::mt19937 random(static_cast<unsigned>(100 * cage) + static_cast<unsigned>(index));
  const auto draw = [&] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
  CameraSettings settings = view(kSide_px, kSide_px, index % 2 ? Projection::orthographic : Projection::perspective);
  const double x = draw(), y = draw(), z = draw();
  settings.direction = glm::normalize(glm::dvec3(x, y, z) + glm::dvec3(0.01));
  return framing(scene, settings);
}

struct Sum {
  int views = 0, exact = 0;
  Agreement all{};  ///< Of the exact views.
};

void add(const BorderTruth& truth, const Agreement& seen, Sum& sum) {
  ++sum.views;
  if (!truth.exact) return;
  ++sum.exact;
  sum.all.length_px += seen.length_px, sum.all.missing_px += seen.missing_px;
  sum.all.extra_px += seen.extra_px, sum.all.wrong_px += seen.wrong_px;
  sum.all.worst_px = std::max(sum.all.worst_px, seen.worst_px);
}

/// Beside the tip of a cone on an edge with three faces a contour may be 0.03 px off for a pixel or two: of each view 0.5 % may be, of all
/// views together 1 in 10,000, and no place by more than 0.1 px.
void expect_agreement(const BorderTruth& truth, const Agreement& seen, const std::string& what) {
  if (!truth.exact) {
    ASSERT_FALSE(truth.notes.empty()) << what;
    EXPECT_EQ(truth.notes[0].find("not exact: "), 0u) << what << ": " << truth.notes[0];
    EXPECT_GT(truth.bound_px, 0.01) << what;
    return;
  }
  EXPECT_LT(truth.bound_px, 0.01) << what;
  EXPECT_GT(seen.length_px, 50.0) << what;
  EXPECT_LT(seen.missing_px, 0.005 * seen.length_px) << what;
  EXPECT_LT(seen.extra_px, 0.005 * seen.length_px) << what;
  EXPECT_LT(seen.wrong_px, 0.3) << what;
}

TEST(TruthAwkwardCages, AreWithinAFiftiethOfAPixelOrNotCalledExact) {
  const std::vector<AwkwardCage> cages = awkward_cages();
  EXPECT_GE(cages.size(), 60u);
  std::map<std::string, Sum> sums;
  Sum all;
  for (size_t c = 0; c < cages.size(); ++c) {
    const AwkwardCage& cage = cages[c];
    const Scene scene = scene_of({object_of(cage.mesh, cage.scheme)});
    const Mesh fine = fine_mesh(cage);
    const BruteSilhouette brute(fine);
    for (int i = 0; i < kViews; ++i) {
      const Camera camera = view_of(scene, c, i);
      TruthSettings settings;
      settings.threshold = 0.0;
      const BorderTruth truth = solve_truth(scene, camera, settings, {});
      const Agreement seen = agreement_of(truth.curves, brute.segments(camera), brute.tips(camera), kTolerance_px);
      expect_agreement(truth, seen, fmt::format("{}: {}, view {}", cage.kind, cage.name, i));
      add(truth, seen, sums[cage.kind]);
      add(truth, seen, all);
    }
  }
  sums["all"] = all;
  for (const auto& [kind, sum] : sums)
    fmt::print("{:24} {:3} of {:3} views exact, {:8.1f} px: missing {:.2f}, extra {:.2f}, wrong side {:.2f}, worst {:.3f}\n", kind,
               sum.exact, sum.views, sum.all.length_px, sum.all.missing_px, sum.all.extra_px, sum.all.wrong_px, sum.all.worst_px);
  EXPECT_LT(all.all.missing_px + all.all.extra_px, 0.0001 * all.all.length_px);
  EXPECT_LT(all.all.worst_px, 0.1);
  EXPECT_LT(all.all.wrong_px, 0.00005 * all.all.length_px);
  EXPECT_GT(all.exact, all.views * 9 / 10);
}

/// The tolerance for samples at one place came from the patches' first samples, which are all the same here.
TEST(TruthAwkwardCages, OfOneFaceOrFacesThatStartAtOneVertexEnd) {
  for (const Mesh& mesh : {single_face(4), fan_cage(5, true, true, 0.8)}) {
    for (const double size : {1e-6, 1.0, 1e6}) {
      Mesh scaled = mesh;
      for (glm::dvec3& p : scaled.positions) p = size * (p + glm::dvec3(100.0, 0.0, -30.0));
      const Scene scene = scene_of({object_of(scaled, Scheme::catmark)});
      EXPECT_TRUE(solve_truth(scene, view_of(scene, 1, 0), {}, {}).exact);
    }
  }
}

}  // namespace
}  // namespace limn::test
