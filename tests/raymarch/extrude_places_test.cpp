// Outlines by offset ask the rays of few pixels: those that are left out would not become ink.

#include <fmt/core.h>

#include "raymarch/border/extrude.h"
#include "raymarch/border/extrude_pixels.h"
#include "sdf/error.h"
#include "tests/random_seed.h"
#include "tests/raymarch/scenes.h"
#include "tests/sdf/random_field.h"

namespace limn::test {
namespace {

double ink_of(const WindowImage<float>& ink) {
  double sum = 0.0;
  for (const float p : ink.values.pixels) sum += double{p};
  return sum;
}

/// Of all the model's objects, what is inked with and without places; the places are those of `first`, what is seen is `input`'s.
void expect_same_ink(const BorderInput& first, const BorderInput& input, const ExtrudeSettings& settings, double& ink,
                     const std::string& what) {
  for (size_t object = 0; object < input.model.surfaces.size(); ++object) {
    const std::shared_ptr<const OffsetShell> shell = offset_shell(first, object, settings);
    ASSERT_NE(shell, nullptr) << what;
    ASSERT_TRUE(shell->places.has_value()) << what;
    OffsetShell anywhere = *shell;
    anywhere.places.reset();
    const WindowImage<float> asked = ink_offset(input, object, settings, *shell), all = ink_offset(input, object, settings, anywhere);
    std::int64_t different = 0;
    for (size_t i = 0; i < all.values.size(); ++i) different += asked.values.pixels[i] != all.values.pixels[i];
    EXPECT_EQ(different, 0) << what << ", object " << object << ": of " << ink_of(all) << " pixels of ink";
    ink += ink_of(all);
  }
}

Field bounded(const Field& field) {
  if (field.traits().bounds.finite() && !field.traits().bounds.empty()) return field;
  return combine(Csg::intersection, field, make_shape("box", {{"half", {1.2, 1.0, 0.8}}}), 0.0);
}

/// Nothing where a random field has no surface, or none that voxels hold.
std::optional<SceneModel> model_where_there_is_one(const Scene& scene, const SurfaceSettings& how) {
  try {
    return build_model(scene, how);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

ExtrudeSettings random_settings(Random& random) {
  ExtrudeSettings settings;
  settings.space = random.index(3) == 0 ? ExtrudeSpace::object : ExtrudeSpace::clip;
  settings.mask = random.index(3) == 0 ? ExtrudeMask::stencil : ExtrudeMask::back_faces;
  settings.width_px = random.uniform(0.3, 6.0);
  settings.object_width = random.uniform(0.005, 0.08);
  return settings;
}

CameraSettings random_view(Random& random) {
  CameraSettings settings = view(56, 40, random.index(3) == 0 ? Projection::orthographic : Projection::perspective);
  settings.direction = random.direction();
  return settings;
}

TEST(ExtrudePlaces, NoRayThatIsLeftOutWouldBecomeInk) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  double ink = 0.0;
  int compared = 0;
  for (int trial = 0; trial < 14; ++trial) {
    const Field one = bounded(random_field(random, 1 + trial % 2));
    const Field other = translate(bounded(random_field(random, 1)), random.point(1.5));
    const ExtrudeSettings settings = random_settings(random);
    const CameraSettings seen_from = random_view(random);
    SurfaceSettings how = surface_kind(trial % 3 == 0 ? "level_set" : "analytic");
    how.voxels = 20 + random.index(60);
    how.half_width_voxels = 4.0;
    const Scene scene = scene_of({object_of(one), object_of(other)});
    const std::optional<SceneModel> built = model_where_there_is_one(scene, how);
    if (!built) continue;
    const SceneModel& model = *built;
    const Camera camera = framing(scene, seen_from);
    ++compared;
    const GBuffer seen = render_gbuffer(model, camera, {}), later = render_gbuffer(model, camera, {}, {0.9, 0.2});
    const BorderInput first{seen, camera, model, scene}, second{later, camera, model, scene};
    const std::string what = fmt::format("seed {}, trial {}, {}", seed, trial, how.kind);
    expect_same_ink(first, first, settings, ink, what);
    expect_same_ink(first, second, settings, ink, what + ", another sample");
  }
  EXPECT_GE(compared, 6) << "seed " << seed;
  EXPECT_GT(ink, 100.0) << "seed " << seed;
}

/// A ray (render space) that is traced from `from` to `to`.
bool is_hit(const Surface& surface, const CameraRay& ray, double from, double to, RayBatch& rays, HitBatch& hits) {
  rays.count = 1;
  rays.set(0, ray.origin, ray.direction, from, to);
  hits.status[0] = HitStatus::miss;
  hits.t[0] = rays.t_max[0];
  surface.trace(surface.state.get(), rays, hits);
  return hits.status[0] == HitStatus::hit;
}

/// All places at which a ray meets the offset before it comes to the surface, one behind the other.
std::vector<std::pair<glm::dvec3, bool>> meetings(const Surface& surface, const Surface& offset, const CameraRay& ray, double width) {
  std::vector<std::pair<glm::dvec3, bool>> found;
  RayBatch rays;
  HitBatch hits;
  const double to = is_hit(surface, ray, 0.0, 100.0, rays, hits) ? double{hits.t[0]} : 100.0;
  double from = 0.0;
  for (int k = 0; k < 8 && from < to && is_hit(offset, ray, from, to, rays, hits); ++k) {
    const glm::vec3 normal(hits.normal_x[0], hits.normal_y[0], hits.normal_z[0]);
    found.emplace_back(glm::dvec3(rays.origin(0)) + double{hits.t[0]} * glm::dvec3(rays.direction(0)),
                       glm::dot(normal, rays.direction(0)) >= 0.0f);
    from = double{hits.t[0]} + width / 32.0;
  }
  return found;
}

bool is_in_one(const std::vector<Box>& boxes, const glm::dvec3& place, double margin) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) {
    const Box around = dilate(box, margin);
    return glm::all(glm::greaterThanEqual(place, around.lower)) && glm::all(glm::lessThanEqual(place, around.upper));
  });
}

TEST(ExtrudePlaces, HoldEveryPlaceWhereARayMeetsTheOffset) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  std::int64_t met = 0, away = 0;
  for (int trial = 0; trial < 16; ++trial) {
    SurfaceSettings how = surface_kind(trial % 2 == 0 ? "level_set" : "analytic");
    how.voxels = 16 + random.index(30);
    how.half_width_voxels = 4.0;
    const Scene scene = scene_of({object_of(bounded(random_field(random, trial % 3)))});
    const CameraSettings seen_from = random_view(random);
    const double width = random.uniform(0.02, 0.2);
    const std::optional<SceneModel> model = model_where_there_is_one(scene, how);
    // A body that is empty has no outline, though far from it its field may be as small as the width.
    if (!model || model->surfaces[0].bounds.empty()) continue;
    const Camera camera = moved(framing(scene, seen_from), model->render_origin);
    const SurfaceOffset& offset = model->surfaces[0].offset;
    OffsetWidth constant;
    constant.world = width;
    const Surface surface = offset.make(offset.state.get(), constant);
    const MeetingRequest any{.camera = camera, .facing_away = false, .side_px = 2.0, .is_divided = {}},
        behind{.camera = camera, .facing_away = true, .side_px = 2.0, .is_divided = {}};
    const std::vector<Box> places = surface.where_met(surface.state.get(), any),
                           places_behind = surface.where_met(surface.state.get(), behind);
    for (int k = 0; k < 600; ++k) {
      const double x = random.uniform(0.0, camera.width_px), y = random.uniform(0.0, camera.height_px);
      for (const auto& [place, faces_away] : meetings(model->surfaces[0], surface, camera_ray(camera, x, y), width)) {
        ++met, away += faces_away;
        const std::string what =
            fmt::format("seed {}, trial {}, {}, ray {}, {} of {} boxes", seed, trial, how.kind, k, places_behind.size(), places.size());
        ASSERT_TRUE(is_in_one(places, place, 1e-6)) << what;
        ASSERT_TRUE(!faces_away || is_in_one(places_behind, place, 1e-6)) << what;
      }
    }
  }
  EXPECT_GT(met, 500) << "seed " << seed;
  EXPECT_GT(away, 100) << "seed " << seed;
}

TEST(ExtrudePlaces, PixelsBeforeABoxAreAllThatSeeToIt) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  int seen_to = 0, not_seen = 0;
  for (int trial = 0; trial < 200; ++trial) {
    CameraSettings settings = random_view(random);
    settings.target = random.point(0.5);
    const Camera camera = resolve_camera(settings, {glm::dvec3(-1.0), glm::dvec3(1.0)});
    GBuffer seen;
    seen.width = camera.width_px, seen.height = camera.height_px;
    seen.sample = {random.uniform(0.0, 1.0), random.uniform(0.0, 1.0)};
    const double middle = project(camera, glm::dvec3(0.0)).z;
    seen.depth = Image<float>(seen.width, seen.height, 0.0f);
    for (float& depth : seen.depth.pixels) depth = static_cast<float>(middle + random.uniform(-1.0, 1.0));
    const SeenDepths depths(seen, camera);
    for (int k = 0; k < 50; ++k) {
      const int x = random.index(seen.width), y = random.index(seen.height);
      const CameraRay ray = camera_ray(camera, x + seen.sample.x, y + seen.sample.y);
      const double z = middle + random.uniform(-1.2, 1.2), along = -glm::dot(ray.direction, camera.world_from_camera[2]);
      const double start = project(camera, ray.origin).z;
      const glm::dvec3 place = ray.origin + (z - start) / along * ray.direction;
      const glm::dvec3 low(random.uniform(0.0, 0.05), random.uniform(0.0, 0.05), random.uniform(0.0, 0.05));
      const glm::dvec3 high(random.uniform(0.0, 0.05), random.uniform(0.0, 0.05), random.uniform(0.0, 0.05));
      const PixelWindow window = depths.pixels_before({place - low, place + high});
      const bool holds = x >= window.x0 && x < window.x1 && y >= window.y0 && y < window.y1;
      if (z <= double{seen.depth.at(x, y)}) {
        EXPECT_TRUE(holds) << "seed " << seed << ", trial " << trial;
        ++seen_to;
      } else {
        not_seen += window.empty();
      }
    }
  }
  EXPECT_GT(seen_to, 1000);
  EXPECT_GT(not_seen, 100);
}

TEST(ExtrudePlaces, AreAFewPixelsWideAlongTheOutline) {
  const Scene scene = scene_of({object_of(make_shape("ellipsoid", {{"radii", {1.0, 0.7, 0.5}}}))});
  const Camera camera = framing(scene, view(640, 360));
  for (const std::string kind : {"analytic", "level_set"}) {
    const SceneModel model = model_of(scene, kind);
    const GBuffer seen = render_gbuffer(model, camera, {});
    const BorderInput input{seen, camera, model, scene};
    const std::shared_ptr<const OffsetShell> shell = offset_shell(input, 0, {});
    ASSERT_TRUE(shell && shell->places) << kind;
    const WindowImage<std::uint8_t> asked = pixels_before(*shell->places, SeenDepths(seen, camera), {0, 0, seen.width, seen.height});
    const auto count = std::count(asked.values.pixels.begin(), asked.values.pixels.end(), 1);
    const double ink = ink_of(ink_offset(input, 0, {}, *shell));
    fmt::print("{}: {} pixels asked for {} of ink, {} boxes\n", kind, count, ink, shell->places->size());
    EXPECT_GT(ink, 1000.0) << kind;
    EXPECT_LT(static_cast<double>(count), 8.0 * ink) << kind;
  }
}

TEST(ExtrudePlaces, OfAFieldWithoutBoundsAreTheWholePicture) {
  const Scene scene = scene_of({object_of(make_shape("plane", {{"normal", {0.0, 1.0, 0.0}}, {"offset", {0.0}}})),
                                object_of(make_shape("sphere", {{"radius", {1.0}}}))});
  CameraSettings settings = view(60, 40);
  settings.eye = glm::dvec3(0.0, 2.0, 6.0), settings.target = glm::dvec3(0.0, 0.5, 0.0);
  const Camera camera = resolve_camera(settings, {glm::dvec3(-1.0), glm::dvec3(1.0)});
  const SceneModel model = model_of(scene);
  const GBuffer seen = render_gbuffer(model, camera, {});
  const BorderInput input{seen, camera, model, scene};
  double ink = 0.0;
  expect_same_ink(input, input, {}, ink, "a sphere on a plane");
  EXPECT_GT(ink, 20.0);
}

}  // namespace
}  // namespace limn::test
