// Packets of coherent rays against the reference: one ray at a time, in double precision, through the whole grid.

#include <cstring>

#include "raymarch/gbuffer/picture_rays.h"
#include "raymarch/gbuffer/trace_scene.h"
#include "raymarch/level_set/bricks.h"
#include "sdf/level_set_data.h"
#include "tests/raymarch/level_set_rays.h"
#include "tests/raymarch/scenes.h"
#include "tests/simd_targets.h"

namespace limn {
namespace {

using namespace testing_tools;

// Places along rays and values of 16 bits are off by no more than this, in voxels.
constexpr double kTolerance_voxels = 2e-3;

struct Case {
  std::string name;
  Field field;
  int voxels = 40;
};

std::vector<Case> cases() {
  const Field sphere = make_shape("sphere"), box = make_shape("box", {{"half", {0.7, 0.5, 0.6}}});
  const Field plate = make_shape("box", {{"half", {0.9, 0.035, 0.8}}});
  const Field grid = combine(Csg::intersection, make_shape("gyroid", {{"period", {0.9}}, {"thickness", {0.25}}}), sphere);
  return {{"sphere", sphere, 90},
          {"turned box", rotate(box, {1.0, 2.0, 0.5}, 0.7)},
          {"box along the grid", box},
          {"thin plate", rotate(plate, {0.3, 1.0, 0.2}, 0.4)},
          {"torus cut by a box", combine(Csg::difference, make_shape("torus"), translate(box, {0.8, 0.2, 0.1}))},
          {"lattice", grid, 60},
          {"two that touch", combine(Csg::union_, translate(sphere, {-0.98, 0, 0}), translate(sphere, {0.98, 0.1, 0}), 0.05)}};
}

struct Marched {
  Surface surface, grown, shrunk;  ///< The zero level, and those a little outside and inside it, by the reference.
  double tolerance = 0.0;          ///< World units.
};

Marched march(const LevelSet& level_set, const Affine& world_from_object) {
  // The cell's own gradient leaves hits at the trilinear interpolant's roots.
  const GradientDescriptor& gradient = find_gradient("cell");
  const double scale = std::cbrt(std::abs(glm::determinant(world_from_object.linear)));
  const double tolerance = kTolerance_voxels * level_set.info().voxel_size * scale;
  const auto at = [&](double width) {
    return level_set_marcher(level_set, world_from_object, gradient, glm::dvec3(0.0), 100'000,
                             {{.world = width}, std::abs(width) / tolerance});
  };
  return {level_set_marcher(level_set, world_from_object, gradient, glm::dvec3(0.0), 100'000), at(tolerance), at(-tolerance), tolerance};
}

SceneModel model_with(const Surface& surface) {
  SceneModel model;
  model.surfaces = {surface};
  model.colors = {glm::vec3(1.0f)};
  model.materials = {0};
  return model;
}

/// All rays of the picture, tile by tile: by packets, and by each of the references.
struct Compared {
  int hits = 0, outside_bracket = 0;
};

void compare_tile(const Marched& marched, const SceneModel& model, const ModelView& view, const PixelTile& tile, const PictureRays& picture,
                  bool inside, Compared& result) {
  RayBatch rays;
  fill_rays(picture, tile, {0.5, 0.5}, rays);
  RayBatch copy = rays;
  SceneHits found, grown, shrunk;
  trace_scene(model, view, tile, std::span(&copy, 1), std::span(&found, 1));
  for (int i = 0; i < rays.count; ++i) grown.hits.status[i] = shrunk.hits.status[i] = HitStatus::miss;
  marched.grown.trace(marched.grown.state.get(), rays, grown.hits);
  marched.shrunk.trace(marched.shrunk.state.get(), rays, shrunk.hits);
  const HitBatch& first = inside ? shrunk.hits : grown.hits;
  const HitBatch& last = inside ? grown.hits : shrunk.hits;
  constexpr double kNever = 1e30;
  for (int i = 0; i < rays.count; ++i) {
    if (!(rays.t_max[i] > rays.t_min[i])) continue;
    const auto time = [&](const HitBatch& hits) { return hits.status[i] == HitStatus::hit ? static_cast<double>(hits.t[i]) : kNever; };
    const double t = time(found.hits), slack = marched.tolerance;
    result.hits += t < kNever;
    if (t < time(first) - slack || t > time(last) + slack) ++result.outside_bracket;
  }
}

Compared compare(const Marched& marched, const Camera& camera, bool inside) {
  const SceneModel model = model_with(marched.surface);
  const SceneExtent extent = scene_extent(model);
  const PictureRays rays = picture_rays(camera, extent.radius, extent.bounded);
  const ModelView view = view_model(model, {camera, {0.5, 0.5}});
  EXPECT_NE(view.surfaces[0].trace, nullptr) << "nothing was prepared";
  Compared result;
  for (int y = 0; y < camera.height_px; y += 16) {
    for (int x = 0; x < camera.width_px; x += 16)
      compare_tile(marched, model, view, {x, y, std::min(16, camera.width_px - x), std::min(16, camera.height_px - y)}, rays, inside,
                   result);
  }
  return result;
}

/// A surface a little outside the zero level is met no later than it, and one a little inside no earlier: every hit of the packets has to
/// lie between those of the reference, and be missing only where the inner one is missed.
TEST(LevelSetBricks, FindTheFirstRootBetweenThoseOfTheLevelsBeside) {
  const std::uint64_t seed = fresh_seed();
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const Case& c : cases()) {
    const double voxel = c.field.traits().bounds.longest_side() / c.voxels;
    const LevelSet level_set = level_set_from_field(c.field, {.voxel_size = voxel, .half_width_voxels = 3.0});
    Affine placed;
    placed.linear = glm::dmat3(0.9, 0.2, 0.1, -0.15, 1.2, 0.1, 0.05, -0.2, 0.8) * (1.5 + unit(random));
    placed.translation = {unit(random), unit(random), unit(random)};
    const Marched marched = march(level_set, placed);
    const Box bounds = transform(placed, level_set.info().bounds);
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
      for (int k = 0; k < 3; ++k) {
        CameraSettings settings = test::view(150 + 37 * k, 90, projection);
        settings.direction = random_direction(random);
        // From afar, from near, and from so near that much lies behind the eye.
        Camera camera = resolve_camera(settings, bounds);
        if (projection == Projection::perspective && k > 0)
          camera.eye = bounds.center() + (k == 1 ? 0.8 : 0.55) * (camera.eye - bounds.center());
        std::vector<double> value(1);
        const std::vector<glm::dvec3> eye{inverse(placed).point(camera.eye)};
        level_set_values(level_set, eye, value);
        const bool inside = projection == Projection::perspective && value[0] < 0.0;
        const Compared result = compare(marched, camera, inside);
        EXPECT_EQ(result.outside_bracket, 0) << c.name << " view " << k << " of " << result.hits << " hits, seed " << seed;
      }
    }
  }
}

/// Packets' hits beside those of single rays.
struct Beside {
  std::string what;           ///< Shape and gradient.
  double worst_voxels = 0.0;  ///< Apart, across the surface.
  int compared = 0, hits = 0, other_ids = 0;
};

/// What the step from the trilinear root divides by: how steeply the reconstruction falls along the ray there, which at sharp edges is
/// neither hit's N.V. A sixteenth of the steepest at least.
double fall_at(const GradientDescriptor& gradient, const LevelSet& level_set, const Camera& camera, const glm::dvec3& root) {
  const std::vector<glm::dvec3> place{root};
  std::vector<glm::dvec3> slope(1);
  gradient.gradients(level_set.data(), place, slope);
  return std::max(1.0 / 16.0, glm::dot(glm::normalize(slope[0]), view_vector(camera, root)));
}

/// On every case with both smoother reconstructions, from a random direction; away from cells' faces, and where rays do not graze.
std::vector<Beside> beside_single_rays(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Beside> all;
  for (const Case& c : cases()) {
    const double voxel = c.field.traits().bounds.longest_side() / c.voxels;
    const LevelSet level_set = level_set_from_field(c.field, {.voxel_size = voxel, .half_width_voxels = 4.2});
    CameraSettings settings = test::view(160, 120);
    settings.direction = random_direction(random);
    const Camera camera = resolve_camera(settings, level_set.info().bounds);
    const auto surface = [&](const char* gradient) {
      return level_set_marcher(level_set, {}, find_gradient(gradient), glm::dvec3(0.0), 100'000);
    };
    const GBuffer roots = render_gbuffer(model_with(surface("cell")), camera, {});
    for (const char* gradient : {"central", "cubic"}) {
      Surface alone = surface(gradient);
      alone.view = nullptr;
      const GBuffer packets = render_gbuffer(model_with(surface(gradient)), camera, {}),
                    single = render_gbuffer(model_with(alone), camera, {});
      Beside& found = all.emplace_back(Beside{c.name + " " + gradient});
      for (size_t i = 0; i < roots.depth.size(); ++i) {
        found.other_ids += packets.id.pixels[i] != roots.id.pixels[i];
        if (roots.id.pixels[i] == 0 || single.id.pixels[i] == 0) continue;
        ++found.hits;
        const glm::dvec3 local = glm::fract(level_set.data().index_from_world.point(glm::dvec3(roots.position.pixels[i])));
        const double facing = static_cast<double>(std::min(packets.n_dot_v.pixels[i], roots.n_dot_v.pixels[i]));
        if (glm::any(glm::lessThan(local, glm::dvec3(0.02))) || glm::any(glm::greaterThan(local, glm::dvec3(0.98))) || facing < 0.2)
          continue;
        ++found.compared;
        const double apart = static_cast<double>(glm::length(packets.position.pixels[i] - single.position.pixels[i])) / voxel;
        const double falls = fall_at(find_gradient(gradient), level_set, camera, glm::dvec3(roots.position.pixels[i]));
        found.worst_voxels = std::max(found.worst_voxels, std::min(facing, falls) * apart);
      }
    }
  }
  return all;
}

/// Where a smoother reconstruction than the trilinear one has its root, packets and single rays agree: they have their nodes from the
/// same cell unless the trilinear root lies on its face, and are off by what a root is, the farther the more a ray grazes.
TEST(LevelSetBricks, GoToTheSameRootOfTheReconstructionAsSingleRays) {
  // By the second seed a ray runs along a thin plate's reconstruction, to either side of which a step once went; by the others rays rise at
  // a torus' sharp edge, where a step once faded out within a thousandth of a voxel.
  for (const std::uint64_t seed : {fresh_seed(), std::uint64_t{3391320586}, std::uint64_t{123}, std::uint64_t{235}}) {
    int compared = 0;
    for (const Beside& found : beside_single_rays(seed)) {
      compared += found.compared;
      std::printf("%-28s %d of %d hits, worst %.1e voxel\n", found.what.c_str(), found.compared, found.hits, found.worst_voxels);
      EXPECT_EQ(found.other_ids, 0) << found.what << " seed " << seed;
      EXPECT_LT(found.worst_voxels, kTolerance_voxels) << found.what << " seed " << seed;
    }
    // Faces along the grid may lie on its cells' own, others may be seen edge on.
    EXPECT_GT(compared, 20'000) << "seed " << seed;
  }
}

TEST(LevelSetBricks, SeeASurfaceFromInside) {
  const Field hollow = make_shape("sphere", {{"radius", {1.0}}});
  const LevelSet level_set = level_set_from_field(hollow, {.voxel_size = 0.03, .half_width_voxels = 3.0});
  const Marched marched = march(level_set, {});
  CameraSettings settings = test::view(96, 64);
  settings.eye = glm::dvec3(0.2, 0.1, -0.3);
  settings.target = glm::dvec3(1.0, 0.4, 0.3);
  const Compared result = compare(marched, resolve_camera(settings, level_set.info().bounds), true);
  EXPECT_EQ(result.hits, 96 * 64);
  EXPECT_EQ(result.outside_bracket, 0);
}

/// What a gradient is in one cell, continued to a place beyond it (index coordinates): a polynomial of third degree at most along each
/// axis, known from its values at 4^3 places within.
glm::dvec3 continued(const GradientDescriptor& gradient, const LevelSet& level_set, const glm::ivec3& cell, const glm::dvec3& place) {
  constexpr std::array<double, 4> kWithin = {0.05, 0.35, 0.65, 0.95};
  std::vector<glm::dvec3> points, gradients(64);
  for (int k = 0; k < 64; ++k) {
    const glm::dvec3 local(kWithin[static_cast<size_t>(k / 16)], kWithin[static_cast<size_t>(k / 4 % 4)],
                           kWithin[static_cast<size_t>(k % 4)]);
    points.push_back(level_set.info().world_from_index.point(glm::dvec3(cell) + local));
  }
  gradient.gradients(level_set.data(), points, gradients);
  const auto weight = [&](size_t k, double u) {
    double product = 1.0;
    for (size_t other = 0; other < 4; ++other) {
      if (other != k) product *= (u - kWithin[other]) / (kWithin[k] - kWithin[other]);
    }
    return product;
  };
  const glm::dvec3 local = place - glm::dvec3(cell);
  glm::dvec3 sum(0.0);
  for (size_t k = 0; k < 64; ++k) sum += weight(k / 16, local.x) * weight(k / 4 % 4, local.y) * weight(k % 4, local.z) * gradients[k];
  return sum;
}

/// How far a normal is from that of the nearest of the cells within a quarter of a voxel along the ray: hits go that far from the trilinear
/// root, whose cell's gradient goes with them.
double off_from_cells_beside(const glm::dvec3& normal, const GradientDescriptor& gradient, const LevelSet& level_set,
                             const glm::dvec3& point, const glm::dvec3& world_direction) {
  const glm::dvec3 place = level_set.data().index_from_world.point(point), way = level_set.data().index_from_world.vector(world_direction);
  const glm::dvec3 step = way / std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)});
  double least = 2.0;
  glm::ivec3 before(1 << 30);
  for (int k = -260; k <= 260; ++k) {  // in steps so small that few of the cells whose corners are cut are left out
    const glm::ivec3 cell(glm::floor(place + 0.001 * k * step));
    if (cell == before) continue;
    before = cell;
    const glm::dvec3 there = continued(gradient, level_set, cell, place);
    // Where sides cancel out any direction is as good.
    least = std::min(least, glm::length(there) < 0.2 ? 0.0 : glm::length(normal - glm::normalize(there)));
  }
  return least;
}

TEST(LevelSetBricks, TakeTheNormalsOfTheGradientThatWasAskedFor) {
  const std::uint64_t seed = fresh_seed();
  std::mt19937_64 random(seed);
  for (const Case& c : cases()) {
    const LevelSet level_set =
        level_set_from_field(c.field, {.voxel_size = c.field.traits().bounds.longest_side() / c.voxels, .half_width_voxels = 4.2});
    for (const std::string name : {"cell", "central", "cubic"}) {
      const GradientDescriptor& gradient = find_gradient(name);
      const SceneModel model = model_with(level_set_marcher(level_set, {}, gradient, glm::dvec3(0.0), 100'000));
      CameraSettings settings = test::view(160, 120);
      settings.direction = random_direction(random);
      const Camera camera = resolve_camera(settings, level_set.info().bounds);
      const GBuffer seen = render_gbuffer(model, camera, {});
      std::vector<glm::dvec3> points, directions, gradients;
      std::vector<glm::vec3> normals;
      for (size_t i = 0; i < seen.depth.size(); ++i) {
        if (seen.id.pixels[i] == 0) continue;
        points.emplace_back(seen.position.pixels[i]);
        const auto width = static_cast<size_t>(seen.width);
        directions.push_back(camera_ray(camera, static_cast<double>(i % width) + 0.5, static_cast<double>(i / width) + 0.5).direction);
        normals.push_back(seen.normal.pixels[i]);
      }
      gradients.resize(points.size());
      gradient.gradients(level_set.data(), points, gradients);
      // Beside an edge a gradient turns fast, and the hit's place is rounded.
      const bool smooth = c.name == "sphere" && name != "cell";
      const double bound = smooth ? 2e-4 : 2e-3;
      double worst = 0.0;
      for (size_t i = 0; i < points.size(); ++i) {
        // On a face of a cell the cell's own gradient jumps, and where sides cancel out any direction is as good.
        const glm::dvec3 local = glm::fract(level_set.data().index_from_world.point(points[i]));
        const bool on_face =
            name == "cell" && (glm::any(glm::lessThan(local, glm::dvec3(5e-3))) || glm::any(glm::greaterThan(local, glm::dvec3(0.995))));
        if (on_face || glm::length(gradients[i]) < 0.2) continue;
        const glm::dvec3 normal(normals[i]);
        double off = glm::length(normal - glm::normalize(gradients[i]));
        // Continued, a polynomial doubles what 16 bits leave off in the cell.
        if (off >= bound && name != "cell") off = 0.5 * off_from_cells_beside(normal, gradient, level_set, points[i], directions[i]);
        worst = std::max(worst, off);
      }
      EXPECT_GT(points.size(), 100u) << c.name;  // a plate may be seen edge on
      EXPECT_LT(worst, bound) << c.name << " " << name << " seed " << seed;
    }
  }
}

/// At random places of the crossed cells of every group the interpolant stays in the slab about the plane.
TEST(LevelSetBricks, AreBoundedByTheirSlabs) {
  const std::uint64_t seed = fresh_seed();
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const Case& c : cases()) {
    const LevelSet level_set =
        level_set_from_field(c.field, {.voxel_size = c.field.traits().bounds.longest_side() / c.voxels, .half_width_voxels = 3.0});
    const auto bricks = make_bricks(level_set);
    ASSERT_NE(bricks, nullptr) << c.name;
    ASSERT_EQ(bricks->groups.size(), 3u) << c.name;
    const auto accessor = level_set.data().accessor();
    for (const BrickGroups& groups : bricks->groups) {
      double crossed = 0.0;
      for (const SurfaceBound& bound : groups.bounds) {
        const glm::ivec3 origin(bound.origin[0], bound.origin[1], bound.origin[2]);
        for (int sample = 0; sample < (groups.shift == 5 ? 2000 : 200); ++sample) {
          const glm::dvec3 local = static_cast<double>(1 << groups.shift) * glm::dvec3(unit(random), unit(random), unit(random));
          const glm::ivec3 cell(glm::floor(local));
          const auto v = cell_values(accessor, nanovdb::Coord(origin.x + cell.x, origin.y + cell.y, origin.z + cell.z));
          const auto [least, greatest] = std::minmax_element(v.begin(), v.end());
          if ((*least < 0.0) == (*greatest < 0.0)) continue;
          crossed += 1.0;
          const glm::dvec3 u = local - glm::dvec3(cell);
          double f = 0.0, plane = -static_cast<double>(bound.offset);
          for (size_t k = 0; k < 8; ++k) f += v[k] * (k & 1 ? u.x : 1.0 - u.x) * (k & 2 ? u.y : 1.0 - u.y) * (k & 4 ? u.z : 1.0 - u.z);
          for (int axis = 0; axis < 3; ++axis) {
            plane += static_cast<double>(bound.normal[axis]) * local[axis];
            EXPECT_LE(static_cast<double>(bound.lower[axis]), local[axis]);
            EXPECT_GE(static_cast<double>(bound.upper[axis]), local[axis]);
          }
          // One step of rounding; half more where a value near zero was kept on its side.
          EXPECT_LE(std::abs(f / bricks->world_per_step - plane), static_cast<double>(bound.slab) + 1.5) << c.name << " seed " << seed;
        }
      }
      EXPECT_GT(crossed, 50.0) << c.name << " " << groups.shift;
    }
  }
}

/// The nodes that a crossed cell has, and those that its stencils read one node farther, of the brick that has the cell or of one beside
/// it.
TEST(LevelSetBricks, KeepTheSideOfEveryNodeThatIsRead) {
  const LevelSet level_set = level_set_from_field(cases()[5].field, {.voxel_size = 0.05, .half_width_voxels = 3.0});
  const auto bricks = make_bricks(level_set);
  ASSERT_NE(bricks, nullptr);
  const auto accessor = level_set.data().accessor();
  const auto& bounds = bricks->groups[0].bounds;
  size_t crossed = 0, uncrossed = 0, kept = 0;
  for (size_t b = 0; b < bounds.size(); ++b) {
    const auto origin = nanovdb::Coord(bounds[b].origin[0], bounds[b].origin[1], bounds[b].origin[2]);
    for (int cell = 0; cell < 512; ++cell) {
      const glm::ivec3 first(cell >> 6, cell >> 3 & 7, cell & 7);
      int inside = 0;
      for (int corner = 0; corner < 8; ++corner)
        inside += accessor.getValue(origin.offsetBy(first.x + (corner >> 2), first.y + (corner >> 1 & 1), first.z + (corner & 1))) < 0.0f;
      const bool crosses = inside > 0 && inside < 8;
      ASSERT_TRUE(bricks->keeps(b, cell) || !crosses);
      kept += bricks->keeps(b, cell) ? 1 : 0;
      (crosses ? crossed : uncrossed) += 1;
      if (!crosses) continue;
      for (int k = 0; k < 64; ++k) {
        const glm::ivec3 step(k / 16 - 1, k / 4 % 4 - 1, k % 4 - 1), node = first + step;
        const int beside = (step.x < 0 || step.x > 1) + (step.y < 0 || step.y > 1) + (step.z < 0 || step.z > 1);
        if (beside > 1 || glm::any(glm::lessThan(node, glm::ivec3(0))) || glm::any(glm::greaterThan(node, glm::ivec3(8)))) continue;
        const std::int16_t value = bricks->value(b, brick_element(node.x, node.y, node.z));
        ASSERT_EQ(accessor.getValue(origin.offsetBy(node.x, node.y, node.z)) < 0.0f, value < 0);
        ASSERT_NE(value, 0);
      }
    }
  }
  EXPECT_GT(crossed, 1000u);
  EXPECT_GT(uncrossed, 1000u);
  EXPECT_LT(kept, crossed + uncrossed / 2);
}

/// Values far from distances: ten times as steep on one side of the world as on the other, and a band cut to pieces.
TEST(LevelSetBricks, HoldGridsThatAreNoDistances) {
  const std::uint64_t seed = fresh_seed();
  const LevelSet distances = level_set_from_field(make_shape("torus"), {.voxel_size = 0.05, .half_width_voxels = 4.0});
  const auto altered = [&](const auto& change) {
    std::vector<LevelSetBlock> blocks;
    const auto& tree = distances.data().grid->tree();
    const auto* leaves = tree.getFirstNode<0>();
    for (std::uint32_t i = 0; i < tree.nodeCount(0); ++i) {
      LevelSetBlock block;
      block.origin = {leaves[i].origin()[0], leaves[i].origin()[1], leaves[i].origin()[2]};
      for (int w = 0; w < 8; ++w) block.active[w] = 0;
      for (std::uint32_t k = 0; k < 512; ++k) {
        const glm::ivec3 local(static_cast<int>(k >> 6), static_cast<int>(k >> 3 & 7), static_cast<int>(k & 7));
        block.values[k] = leaves[i].getValue(k);
        if (leaves[i].isActive(k) && change(glm::dvec3(block.origin + local), block.values[k]))
          block.active[k >> 6] |= std::uint64_t{1} << (k & 63);
      }
      blocks.push_back(block);
    }
    return level_set_from_blocks(blocks, 0.05, 4.0, "altered", distances.info().world_from_index.translation);
  };
  const LevelSet steep = altered([](const glm::dvec3& p, float& value) {
    value *= static_cast<float>(p.x > 0.0 ? 3.0 : 0.5 + 0.1 * std::sin(p.y));
    return true;
  });
  std::mt19937_64 random(seed);
  for (const LevelSet& level_set : {steep}) {
    const Marched marched = march(level_set, {});
    for (int k = 0; k < 4; ++k) {
      CameraSettings settings = test::view(160, 100);
      settings.direction = random_direction(random);
      const Compared result = compare(marched, resolve_camera(settings, level_set.info().bounds), false);
      EXPECT_GT(result.hits, 1000);
      EXPECT_EQ(result.outside_bracket, 0) << "view " << k << " seed " << seed;
    }
  }
}

template <class T>
bool same(const Image<T>& a, const Image<T>& b) {
  return a.pixels.size() == b.pixels.size() && std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(T)) == 0;
}

/// The bound between SIMD targets is 0 units in the last place: they do the same operations on every lane.
TEST(LevelSetBricks, GiveTheSameBytesOnEveryTarget) {
  for (const std::string gradient : {"cell", "central", "cubic"}) {
    const LevelSet level_set = level_set_from_field(cases()[4].field, {.voxel_size = 0.04, .half_width_voxels = 4.0});
    const SceneModel model = model_with(level_set_marcher(level_set, {}, find_gradient(gradient), glm::dvec3(0.0), 100'000));
    const Camera camera = resolve_camera(test::view(200, 130), level_set.info().bounds);
    const GBuffer widest = render_gbuffer(model, camera, {});
    EXPECT_GT(count_hits(widest).hits, 3000);
    test::for_each_simd_target([&](const char* target) {
      const GBuffer seen = render_gbuffer(model, camera, {});
      EXPECT_TRUE(same(seen.depth, widest.depth) && same(seen.normal, widest.normal) && same(seen.position, widest.position) &&
                  same(seen.n_dot_v, widest.n_dot_v) && same(seen.status, widest.status))
          << target;
    });
  }
}

TEST(LevelSetBricks, LeaveLayersEmptyThatNobodyAskedFor) {
  const LevelSet level_set = level_set_from_field(make_shape("sphere"), {.voxel_size = 0.1, .half_width_voxels = 3.0});
  const SceneModel model = model_with(level_set_marcher(level_set, {}, find_gradient("central"), glm::dvec3(0.0), 100));
  const Camera camera = resolve_camera(test::view(50, 40), level_set.info().bounds);
  const GBuffer whole = render_gbuffer(model, camera, {});
  GBuffer some = render_gbuffer(model, resolve_camera(test::view(31, 20), level_set.info().bounds), {});
  const GBufferLayers wanted{.position = false, .n_dot_v = false, .id = false, .material = false, .face = false, .status = false};
  render_gbuffer(model, camera, {}, {0.5, 0.5}, wanted, some);
  EXPECT_TRUE(same(some.depth, whole.depth));
  EXPECT_TRUE(same(some.normal, whole.normal));
  EXPECT_TRUE(some.position.pixels.empty() && some.n_dot_v.pixels.empty() && some.id.pixels.empty() && some.status.pixels.empty());
}

}  // namespace
}  // namespace limn
