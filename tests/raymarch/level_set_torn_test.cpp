// A band that breaks off: cells beside the break take the next lower gradient, by packets as by single rays.

#include "raymarch/gbuffer/trace_scene.h"
#include "sdf/level_set_fill.h"
#include "sdf/level_set_lower.h"
#include "tests/raymarch/level_set_rays.h"
#include "tests/raymarch/scenes.h"

namespace limn {
namespace {

using namespace testing_tools;

constexpr int kLastNode = 5;
constexpr double kRadius = 12.0, kHalfWidth = 4.2;

/// A ball of 12 voxels of which all beyond x = 5 was cut off: there is neither a distance nor anything but outside.
LevelSet cut_ball() {
  const glm::dvec3 center(0.3, 0.2, 0.1);
  const LevelSet ball = brute_force_level_set([&](const glm::dvec3& p) { return glm::distance(p, center) - kRadius; }, {-3, -3, -3},
                                              {3, 3, 3}, 1.0, kHalfWidth);
  std::vector<FilledBlock> blocks;
  for (int bx = 0; bx < 3; ++bx)
    for (int by = -3; by < 3; ++by)
      for (int bz = -3; bz < 3; ++bz) {
        FilledBlock& block = blocks.emplace_back();
        block.origin = 8 * glm::ivec3(bx, by, bz);
        for (size_t word = 0; word < 8; ++word)
          if (block.origin.x + static_cast<int>(word) > kLastNode) block.kept_out[word] = ~std::uint64_t{0};
        block.values.fill(static_cast<float>(kHalfWidth));
      }
  const std::shared_ptr<LevelSetData> data = with_filled_nodes(ball, blocks);
  data->completed = true;
  return LevelSet(data);
}

SceneModel model_with(Surface surface) {
  SceneModel model;
  model.surfaces = {std::move(surface)};
  model.colors = {glm::vec3(1.0f)};
  model.materials = {0};
  return model;
}

TEST(TornLevelSet, CellsBesideTheBreakTakeTheNextLowerGradientThatFindsItsNodes) {
  const LevelSet ball = cut_ball();
  const auto accessor = ball.data().accessor();
  for (const char* name : {"central", "cubic"}) {
    const GradientDescriptor& asked = find_gradient(name);
    const std::vector<LoweredBlock> lowered = lowered_cells(ball, asked);
    std::int64_t lower = 0;
    for (int x = -20; x < 20; ++x)
      for (int y = -20; y < 20; ++y)
        for (int z = -20; z < 20; ++z) {
          const std::array<double, 8> v = cell_values(accessor, nanovdb::Coord(x, y, z));
          const auto negative = std::count_if(v.begin(), v.end(), [](double f) { return f < 0.0; });
          if (negative == 0 || negative == 8) continue;
          const auto finds_all = [&](const GradientDescriptor& gradient) {
            for (int dx = -2; dx <= 3; ++dx)
              for (int dy = -2; dy <= 3; ++dy)
                for (int dz = -2; dz <= 3; ++dz)
                  if ((gradient.stencil[static_cast<size_t>(dx + 2)][static_cast<size_t>(dy + 2)] >> (dz + 2) & 1) != 0 &&
                      !accessor.isActive(nanovdb::Coord(x + dx, y + dy, z + dz)))
                    return false;
            return true;
          };
          const GradientDescriptor* expected = &asked;
          if (!finds_all(*expected) && asked.about.name == "cubic") expected = &find_gradient("central");
          if (!finds_all(*expected)) expected = &find_gradient("cell");
          EXPECT_EQ(gradient_in_cell(lowered, {x, y, z}, asked).about.name, expected->about.name);
          lower += expected != &asked;
        }
    EXPECT_EQ(lower, cells_lacking(ball, asked));
    EXPECT_GT(lower, 100);
  }
}

TEST(TornLevelSet, PacketsAndSingleRaysSeeTheSameAndTheCutIsFlat) {
  const LevelSet ball = cut_ball();
  CameraSettings settings = test::view(160, 120);
  settings.direction = glm::dvec3(1.0, 0.3, 0.4);
  const Camera camera = resolve_camera(settings, ball.info().bounds);
  for (const char* gradient : {"cell", "central", "cubic"}) {
    const Surface surface = level_set_marcher(ball, {}, find_gradient(gradient), glm::dvec3(0.0), 100'000);
    Surface alone = surface;
    alone.view = nullptr;
    const GBuffer packets = render_gbuffer(model_with(surface), camera, {}), single = render_gbuffer(model_with(alone), camera, {});
    int compared = 0, on_cut = 0;
    double worst = 0.0, worst_cut = 0.0;
    for (size_t i = 0; i < packets.depth.size(); ++i) {
      EXPECT_EQ(packets.id.pixels[i], single.id.pixels[i]);
      if (packets.id.pixels[i] == 0) continue;
      const glm::dvec3 p(packets.position.pixels[i]), local = glm::fract(p), normal(packets.normal.pixels[i]);
      const double to_axis = glm::length(glm::dvec2(p.y - 0.2, p.z - 0.1));
      // Far within the cut both sides are constant: the surface lies halfway between the last nodes inside and the first outside.
      if (std::abs(p.x - (kLastNode + 0.5)) < 0.01 && to_axis < 5.0) {
        ++on_cut;
        worst_cut = std::max(worst_cut, glm::length(normal - glm::dvec3(1.0, 0.0, 0.0)));
      }
      if (glm::any(glm::lessThan(local, glm::dvec3(0.05))) || glm::any(glm::greaterThan(local, glm::dvec3(0.95)))) continue;
      if (static_cast<double>(packets.n_dot_v.pixels[i]) < 0.3) continue;
      ++compared;
      worst = std::max(worst, static_cast<double>(glm::length(packets.normal.pixels[i] - single.normal.pixels[i])));
    }
    std::printf("%s: %d compared, worst %.2e; %d on the cut, worst %.2e\n", gradient, compared, worst, on_cut, worst_cut);
    EXPECT_GT(compared, 2000) << gradient;
    EXPECT_LT(worst, 0.02) << gradient;
    EXPECT_GT(on_cut, 300) << gradient;
    EXPECT_LT(worst_cut, 1e-3) << gradient;
  }
}

}  // namespace
}  // namespace limn
