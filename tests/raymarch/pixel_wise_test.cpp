// Pictures that are inked and shaded tile by tile, against whole images worked out here by the plain formulas.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "raymarch/border/angle_ink.h"
#include "raymarch/border/surface_notes.h"
#include "raymarch/border/surface_tally.h"
#include "raymarch/gbuffer/gbuffer_window.h"
#include "raymarch/picture/pixel_wise.h"
#include "raymarch/picture/srgb_bytes.h"
#include "tests/random_seed.h"
#include "tests/raymarch/scenes.h"
#include "tests/simd_targets.h"

namespace limn::test {
namespace {

Field moved_shape(const std::string& name, const glm::dvec3& by) { return translate(make_shape(name), by); }

/// Three objects in three colours.
Scene three_objects() {
  Scene scene =
      scene_of({object_of(moved_shape("sphere", {-1.2, 0.0, 0.3}), "one"), object_of(moved_shape("torus", {0.9, 0.2, 0.0}), "two"),
                object_of(moved_shape("box", {0.0, -1.0, -1.0}), "three")});
  scene.objects[1].color = {0.1f, 0.6f, 0.9f};
  scene.objects[2].color = {0.9f, 0.9f, 0.2f};
  return scene;
}

double rim_coverage(const Parameters& parameters, float n_dot_v) {
  const double edge = parameters.number("threshold"), half = 0.5 * parameters.number("softness");
  return 1.0 - smoothstep(edge - half, edge + half, double{n_dot_v});
}

struct WholeImages {
  Image<glm::vec4> composite;
  Image<float> border;
};

/// By rim alone.
WholeImages whole_images(const SceneModel& model, const Camera& camera, const PictureSettings& settings) {
  const int width = camera.width_px, height = camera.height_px, samples = settings.samples;
  WholeImages images{Image<glm::vec4>(width, height, glm::vec4(0.0f)), Image<float>(width, height, 0.0f)};
  auto& [composite, border] = images;
  for (int sample = 0; sample < samples; ++sample) {
    const GBuffer seen = render_gbuffer(model, camera, {}, sample_offset(sample, samples));
    Image<glm::vec4> drawn = shade_headlight(seen, model);
    for (size_t i = 0; i < drawn.size(); ++i) {
      float all = 0.0f;
      for (const MethodCall& call : settings.methods) {
        const bool hit = seen.id.pixels[i] != 0;
        const float ink = hit ? static_cast<float>(rim_coverage(call.parameters, seen.n_dot_v.pixels[i])) : 0.0f;
        const glm::vec3 color(call.parameters.vector3("color"));
        drawn.pixels[i] = (1.0f - ink) * drawn.pixels[i] + ink * glm::vec4(color, 1.0f);
        all = 1.0f - (1.0f - all) * (1.0f - ink);
      }
      composite.pixels[i] = sample == 0 ? drawn.pixels[i] : composite.pixels[i] + drawn.pixels[i];
      border.pixels[i] = sample == 0 ? all : border.pixels[i] + all;
    }
  }
  const float share = 1.0f / static_cast<float>(samples);
  for (size_t i = 0; i < composite.size(); ++i) {
    glm::vec4& color = composite.pixels[i];
    color *= share;
    border.pixels[i] *= share;
    if (settings.background) color += (1.0f - color.a) * glm::vec4(*settings.background, 1.0f);
  }
  return images;
}

TEST(PixelWise, InksShadesAndAddsUpAsWholeImagesDo) {
  std::mt19937 random(random_seed());
  const auto number = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  const Scene scene = three_objects();
  const SceneModel model = model_of(scene);
  for (const int samples : {1, 2, 3, 10}) {
    const int width = 150 + static_cast<int>(random() % 100), height = 70 + static_cast<int>(random() % 40);
    const Camera camera = framing(scene, view(width, height));
    PictureSettings settings;
    settings.samples = samples;
    for (const double softness : {0.0, number(0.05, 0.6)})
      settings.methods.push_back(call_of("rim", {{"threshold", {{number(0.1, 0.9)}, {}, {}}},
                                                 {"softness", {{softness}, {}, {}}},
                                                 {"color", {{number(0, 1), number(0, 1), number(0, 1)}, {}, {}}}}));
    if (samples > 1) settings.background = glm::vec3(number(0, 1), number(0, 1), number(0, 1));
    ASSERT_TRUE(is_pixel_wise(model, settings));

    const auto [composite, border] = whole_images(model, camera, settings);
    EXPECT_GT(*std::max_element(border.pixels.begin(), border.pixels.end()), 0.3f);  // of one sample in some

    for (const int threads : {1, 3}) {
      for (const int tile_px : {16, 5}) {
        const ExecutionSettings how{.threads = threads, .tile_px = tile_px};
        const Picture picture = draw_picture(scene, model, camera, settings, how);
        EXPECT_TRUE(picture.composite.pixels == composite.pixels) << width << "x" << height << ", " << samples << " samples";
        EXPECT_TRUE(picture.border.pixels == border.pixels) << width << "x" << height << ", " << samples << " samples";
        const HitCounts counted = count_hits(render_gbuffer(model, camera, {}));
        EXPECT_EQ(picture.counts.hits, counted.hits);
        EXPECT_EQ(picture.counts.misses, counted.misses);

        PictureSettings in_bytes = settings;
        in_bytes.colors = PictureColors::bytes;
        const Picture coded = draw_picture(scene, model, camera, in_bytes, how);
        EXPECT_TRUE(coded.composite.pixels.empty() && coded.border.pixels.empty());
        int wrong = 0;
        for (size_t i = 0; i < composite.size(); ++i) {
          const glm::vec4& color = composite.pixels[i];
          const glm::vec3 apart = color.a > 0.0f ? glm::vec3(color) / color.a : glm::vec3(color);
          const SrgbBytes& srgb = srgb_bytes();
          wrong += coded.bytes.pixels[i] != glm::u8vec4(srgb(apart.x), srgb(apart.y), srgb(apart.z), to_byte(color.a));
        }
        EXPECT_EQ(wrong, 0);
      }
    }
  }
}

TEST(PixelWise, RimInkIsOneLessTheSmoothStepForEveryFloat) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int round = 0; round < 300; ++round) {
    const double edge = unit(random), half = round % 3 == 0 ? 0.0 : 0.5 * unit(random);
    std::vector<float> n_dot_v(random() % 90);
    std::vector<std::int32_t> id;
    for (float& value : n_dot_v) {
      value = static_cast<float>(unit(random));
      // At the edge itself, and at the floats beside it.
      if (random() % 3 == 0) value = std::nextafter(static_cast<float>(edge), static_cast<float>(random() % 3));
      if (random() % 5 == 0) value = static_cast<float>(edge);
      id.push_back(static_cast<std::int32_t>(random() % 3));
    }
    std::vector<float> coverage(n_dot_v.size());
    rim_ink(edge, half, n_dot_v, id, coverage);
    for (size_t i = 0; i < coverage.size(); ++i) {
      const auto expected = static_cast<float>(1.0 - smoothstep(edge - half, edge + half, double{n_dot_v[i]}));
      ASSERT_EQ(coverage[i], id[i] == 0 ? 0.0f : expected) << edge << " +- " << half << " at " << n_dot_v[i];
    }
  }
}

TEST(PixelWise, PairsOfOneNormalAreCountedOnceEach) {
  std::mt19937 random(random_seed());
  const Scene scene = three_objects();
  const SceneModel model = model_of(scene);
  for (const int tile_px : {1, 5, 16}) {
    const Camera camera = framing(scene, view(180 + static_cast<int>(random() % 90), 90 + static_cast<int>(random() % 30)));
    const GBuffer whole = render_gbuffer(model, camera, {});
    std::int64_t expected = 0;
    Image<std::uint8_t> facts(whole.width, whole.height);
    for (int y = 0; y < whole.height; ++y) {
      for (int x = 0; x < whole.width; ++x) {
        const auto is_same = [&](int u, int v) {
          const glm::vec3 difference = whole.normal.at(x, y) - whole.normal.at(u, v);
          return whole.id.at(x, y) != 0 && whole.id.at(x, y) == whole.id.at(u, v) && glm::dot(difference, difference) <= 3e-5f * 3e-5f;
        };
        const bool left = x > 0 && is_same(x - 1, y), above = y > 0 && is_same(x, y - 1);
        expected += left + above;
        facts.at(x, y) =
            static_cast<std::uint8_t>((whole.id.at(x, y) != 0 ? kIsHit : 0) | (left ? kSameAsLeft : 0) | (above ? kSameAsAbove : 0));
      }
    }
    ASSERT_GT(expected, 50);  // of the box
    GBuffer traced;
    SurfaceTally tally(model.surfaces.size(), {whole.width, whole.height}, {kTilesInARow * tile_px, tile_px});
    const auto add = [&](const TracedPixels& run) {
      if (run.seen)
        add_pixels(run.layers, run.first, run.pixels, tally);
      else
        add_nothing(run.pixels, tally);
    };
    const PixelRays rays{.work = add, .out = &traced};
    render_pixels(model, camera, {.tile_px = tile_px}, std::span(&rays, 1));
    join_cells(tally);
    EXPECT_EQ(tally.same_pairs, expected) << tile_px;
    EXPECT_TRUE(tally.facts.pixels == facts.pixels) << tile_px;
    for (size_t id = 1; id <= 3; ++id)
      EXPECT_EQ(tally.seen[id], std::count(whole.id.pixels.begin(), whole.id.pixels.end(), static_cast<std::int32_t>(id))) << id;
  }
}

TEST(PixelWise, NotesAreThoseOfTheMethods) {
  const Scene flat = three_objects();
  // A sphere about the eye shows its inside alone.
  const Scene inside = scene_of({object_of(scale(make_shape("sphere"), 30.0))});
  for (const Scene* const scene : {&flat, &inside}) {
    const SceneModel model = model_of(*scene);
    CameraSettings looking = view(120, 80);
    looking.eye = glm::dvec3(2.0, 3.0, 5.0);
    looking.target = glm::dvec3(0.0);
    const Camera camera = framing(*scene, looking);
    const PictureSettings settings{{call_of("rim"), call_of("fresnel")}, 2, {}};
    const GBuffer seen = render_gbuffer(model, camera, {});
    std::vector<std::string> expected;
    for (const MethodCall& call : settings.methods)
      for (const std::string& note : call.method->draw({seen, camera, model, *scene}, call.parameters).notes) expected.push_back(note);
    EXPECT_GE(expected.size(), 2u);
    for (const int tile_px : {1, 16}) EXPECT_EQ(draw_picture(*scene, model, camera, settings, {.tile_px = tile_px}).notes, expected);
  }
}

TEST(PixelWise, PixelsOfATaskAreGoneWithItUnlessTheyAreKept) {
  const Scene scene = three_objects();
  const SceneModel model = model_of(scene);
  const Camera camera = framing(scene, view(150, 70));
  const GBuffer whole = render_gbuffer(model, camera, {});
  for (const bool kept : {false, true}) {
    Image<float> n_dot_v(150, 70, -1.0f);
    const auto copy = [&](const TracedPixels& run) {
      for (int y = run.pixels.y; y < run.pixels.y + run.pixels.height; ++y)
        for (int x = run.pixels.x; x < run.pixels.x + run.pixels.width; ++x)
          n_dot_v.at(x, y) = run.seen ? run.layers.n_dot_v.at(x - run.first.x, y - run.first.y) : 0.0f;
    };
    GBuffer out;
    const PixelRays rays{.kept = kept, .work = copy, .out = &out};
    render_pixels(model, camera, {}, std::span(&rays, 1));
    EXPECT_TRUE(n_dot_v.pixels == whole.n_dot_v.pixels);
    EXPECT_EQ(out.width, 150);
    EXPECT_EQ(out.n_dot_v.pixels.empty(), !kept);
    EXPECT_TRUE(!kept || out.n_dot_v.pixels == whole.n_dot_v.pixels);
  }
}

TEST(PixelWise, EverySimdTargetGivesTheSameBytes) {
  const Scene scene = three_objects();
  const SceneModel model = model_of(scene);
  const Camera camera = framing(scene, view(131, 61));
  for (const bool bytes : {false, true}) {
    PictureSettings settings{
        {call_of("rim", {{"softness", {{0.3}, {}, {}}}}), call_of("rim"), call_of("fresnel")}, 2, glm::vec3(0.2f, 0.5f, 1.0f)};
    if (bytes) settings.colors = PictureColors::bytes;
    const Picture widest = draw_picture(scene, model, camera, settings, {});
    for_each_simd_target([&](const char* target) {
      const Picture other = draw_picture(scene, model, camera, settings, {});
      EXPECT_TRUE(other.composite.pixels == widest.composite.pixels) << target;
      EXPECT_TRUE(other.border.pixels == widest.border.pixels) << target;
      EXPECT_TRUE(other.bytes.pixels == widest.bytes.pixels) << target;
      EXPECT_EQ(other.notes, widest.notes) << target;
    });
    EXPECT_NE(widest.composite.pixels.empty(), widest.bytes.pixels.empty());
  }
}

}  // namespace
}  // namespace limn::test
