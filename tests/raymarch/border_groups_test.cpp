// Outlines of several objects: against brute force, closed forms, and each other.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <set>

#include "tests/raymarch/image_buffers.h"

namespace limn::test {
namespace {

using Given = std::map<std::string, ParameterInput>;

SceneObject ball(double radius, const glm::dvec3& at, int material = 0) {
  SceneObject object = object_of(translate(make_shape("sphere", {{"radius", {radius}}}), at));
  object.material = material;
  return object;
}

SceneObject block(const glm::dvec3& half, const glm::dvec3& at, int material = 0) {
  SceneObject object = object_of(translate(make_shape("box", {{"half", {half.x, half.y, half.z}}}), at));
  object.material = material;
  return object;
}

/// Straight along -z, `height` world units high.
Camera from_ahead(int width, int height_px, double height) {
  CameraSettings settings = view(width, height_px, Projection::orthographic);
  settings.eye = glm::dvec3(0.0, 0.0, 10.0);
  settings.target = glm::dvec3(0.0);
  settings.ortho_height = height;
  return resolve_camera(settings, {});
}

struct Drawing {
  GBuffer seen;
  Border border;
};

Drawing draw(const Scene& scene, const Camera& camera, const std::string& method, const Given& given,
             const std::string& kind = "analytic") {
  const SceneModel model = model_of(scene, kind);
  Drawing drawing{render_gbuffer(model, camera, {}), {}};
  drawing.border = find_border_method(method).draw({drawing.seen, camera, model, scene}, parameters_of(method, given));
  return drawing;
}

TEST(SampleOffsets, StartAtTheCentreAndHaveItsMean) {
  for (int samples = 1; samples <= 64; ++samples) {
    EXPECT_EQ(sample_offset(0, samples), glm::dvec2(0.5));
    glm::dvec2 sum(0.0);
    for (int i = 0; i < samples; ++i) {
      const glm::dvec2 at = sample_offset(i, samples);
      EXPECT_TRUE(at.x > -0.1 && at.x < 1.1 && at.y > -0.1 && at.y < 1.1) << i << " of " << samples;
      sum += at;
    }
    if (samples != 2) {
      EXPECT_NEAR(glm::length(sum / static_cast<double>(samples) - 0.5), 0.0, 1e-12) << samples;
    }
  }
}

/// A mean alpha below 1 between ink and object is background that shows.
TEST(Outlines, NothingShowsBetweenInkAndObject) {
  for (const bool round : {true, false}) {
    const Scene scene = scene_of({round ? ball(1.0, {0.0, 0.0, 0.0}) : block({0.8, 0.6, 0.7}, {0.0, 0.0, 0.0})});
    CameraSettings settings = view(120, 90);
    settings.direction = glm::dvec3(0.4, 0.5, 1.0);
    const Camera camera = framing(scene, settings);
    const SceneModel model = model_of(scene);
    for (const std::string method : {"distance", "jump_flood"}) {
      for (const double width : {2.0, 9.0}) {
        for (const double softness : {0.0, 1.0, 3.0}) {
          if (softness > width) continue;
          for (const std::string group : {"all", "object"}) {
            const MethodCall call = call_of(method, {{"width", value(width)}, {"softness", value(softness)}, {"group", word(group)}});
            for (const int samples : {1, 4}) {
              const Picture picture = draw_picture(scene, model, camera, {{call}, samples, {}}, {});
              const Picture object = draw_picture(scene, model, camera, {{}, samples, {}}, {});
              int both = 0;
              float least = 1.0f;
              for (int y = 1; y < 89; ++y) {
                for (int x = 1; x < 119; ++x) {
                  const auto share = [&](int u, int v) { return object.composite.at(u, v).a; };
                  const bool beside = share(x, y) == 0.0f && (share(x - 1, y) == 1.0f || share(x + 1, y) == 1.0f ||
                                                              share(x, y - 1) == 1.0f || share(x, y + 1) == 1.0f);
                  if (!(picture.border.at(x, y) > 0.0f) || (!beside && (share(x, y) == 0.0f || share(x, y) == 1.0f))) continue;
                  ++both;
                  least = std::min(least, picture.composite.at(x, y).a);
                }
              }
              EXPECT_GT(both, 50);
              EXPECT_GT(least, 0.999f) << method << (round ? " ball" : " box") << ", width " << width << ", softness " << softness
                                       << ", group " << group << ", " << samples << " samples";
            }
          }
        }
      }
    }
  }
}

/// With one object there is nothing to tell apart.
TEST(Outlines, OfOneObjectAreTheSameForEveryGroup) {
  const Scene scene = scene_of({object_of(make_shape("torus", {{"major", {1.0}}, {"minor", {0.4}}}))});
  CameraSettings settings = view(110, 80);
  settings.direction = glm::dvec3(0.2, 0.5, 1.0);
  const Camera camera = framing(scene, settings);
  for (const auto& [method, given] :
       std::vector<std::pair<std::string, Given>>{{"distance", {}},
                                                  {"distance", {{"side", word("centered")}, {"width", value(6)}}},
                                                  {"distance", {{"side", word("inside")}, {"softness", value(3)}}},
                                                  {"jump_flood", {{"width", value(7)}}},
                                                  {"blur", {}},
                                                  {"blur", {{"place", word("over")}, {"scale", value(3)}}},
                                                  {"extrude", {}},
                                                  {"extrude", {{"mask", word("stencil")}}}}) {
    Given all = given;
    all["group"] = word("all");
    const Border one = draw(scene, camera, method, all).border;
    EXPECT_GT(area(one.coverage), 100.0);
    for (const std::string group : {"object", "material"}) {
      Given grouped = given;
      grouped["group"] = word(group);
      grouped["hidden"] = word("drawn");
      const Image<float> ink = draw(scene, camera, method, grouped).border.coverage;
      float largest = 0.0f;
      for (size_t i = 0; i < ink.size(); ++i) largest = std::max(largest, std::abs(ink.pixels[i] - one.coverage.pixels[i]));
      // A filter over a part of the picture adds up in another order.
      EXPECT_LE(largest, method == "blur" ? 1e-5f : 0.0f) << method << " " << group;
    }
  }
}

/// Discs at depths far from each other, as pixels: an outline by `group = object` is, for each pixel, the distance to the nearest place
/// where a disc in front of what the pixel shows ends at something farther back.
RC_GTEST_PROP(Outlines, OfDiscsAtSeveralDepthsEqualBruteForce, ()) {
  const auto seed = *rc::gen::arbitrary<unsigned>();
  RC_LOG() << "seed " << seed << "\n";
  std::mt19937 random(seed);
  const Camera camera = straight_camera(48, 36, Projection::orthographic, 10.0);
  GBuffer seen = nothing_hit(48, 36);
  std::uniform_real_distribution<double> place(0.0, 48.0), size(3.0, 12.0);
  std::vector<double> depth{5.0, 10.0, 15.0};
  std::shuffle(depth.begin(), depth.end(), random);
  std::vector<std::array<double, 3>> discs;
  for (int k = 0; k < 3; ++k) discs.push_back({place(random), 0.75 * place(random), size(random)});
  for (int y = 0; y < 36; ++y) {
    for (int x = 0; x < 48; ++x) {
      for (size_t k = 0; k < 3; ++k) {
        if (std::hypot(x + 0.5 - discs[k][0], y + 0.5 - discs[k][1]) >= discs[k][2] || depth[k] >= seen.depth.at(x, y)) continue;
        hit(seen, camera, x, y, depth[k], {0.0, 0.0, 1.0}, static_cast<int>(k) + 1);
      }
    }
  }
  const double width = 4.0;
  const Border border = drawn("distance", seen, camera, {{"group", word("object")}, {"width", value(width)}, {"softness", value(0)}});
  const auto at = [&](int x, int y) { return seen.id.inside(x, y) ? seen.id.at(x, y) : -1; };
  const auto depth_of = [&](int id) { return id == 0 ? 100.0 : depth[static_cast<size_t>(id - 1)]; };
  for (int y = 0; y < 36; ++y) {
    for (int x = 0; x < 48; ++x) {
      // Per disc: the nearest of all its crossings in front decides, even where another is visible from here.
      bool inked = false;
      for (int id = 1; id <= 3; ++id) {
        if (id == at(x, y) || depth_of(id) > depth_of(at(x, y))) continue;
        double nearest = 1e9;
        for (int v = 0; v < 36; ++v) {
          for (int u = 0; u < 48; ++u) {
            for (const auto& [du, dv] : {std::pair{1, 0}, {0, 1}}) {
              const int a = at(u, v), b = at(u + du, v + dv);
              if (b < 0 || a == b || (a != id && b != id) || depth_of(id) > depth_of(a == id ? b : a)) continue;
              nearest = std::min(nearest, std::hypot(u + 0.5 * du - x, v + 0.5 * dv - y));
            }
          }
        }
        inked = inked || nearest <= width;
      }
      RC_ASSERT((border.coverage.at(x, y) > 0.5f) == inked);
    }
  }
}

TEST(Outlines, GoAroundEachObjectEachMaterialOrEverything) {
  // Three balls in a row that overlap in the picture, the first two of one material.
  const Scene scene = scene_of({ball(1.0, {-1.2, 0.0, 0.0}, 7), ball(1.0, {0.0, 0.0, -3.0}, 7), ball(1.0, {1.2, 0.0, 0.0}, 8)});
  const Camera camera = from_ahead(200, 100, 4.0);
  for (const std::string method : {"distance", "jump_flood", "blur", "extrude"}) {
    const auto between = [&](const std::string& group, int first, int second) {
      Given given{{"group", word(group)}};
      if (method == "blur") given["edge"] = word("hard");
      const Drawing drawing = draw(scene, camera, method, given);
      // Boundaries between the two objects with ink beside them.
      int all = 0, inked = 0;
      for (int y = 0; y < 100; ++y) {
        for (int x = 2; x + 3 < 200; ++x) {
          const std::set<int> pair{drawing.seen.id.at(x, y), drawing.seen.id.at(x + 1, y)};
          if (pair != std::set<int>{first, second}) continue;
          ++all;
          inked += drawing.border.coverage.at(x - 1, y) > 0.5f || drawing.border.coverage.at(x, y) > 0.5f ||
                   drawing.border.coverage.at(x + 1, y) > 0.5f || drawing.border.coverage.at(x + 2, y) > 0.5f;
        }
      }
      EXPECT_GT(all, 10);
      return static_cast<double>(inked) / all;
    };
    EXPECT_EQ(between("object", 1, 2), 1.0) << method;
    EXPECT_EQ(between("object", 2, 3), 1.0) << method;
    EXPECT_LT(between("material", 1, 2), 0.2) << method;  // The ends, where the outline of both goes by.
    EXPECT_EQ(between("material", 2, 3), 1.0) << method;
    EXPECT_LT(between("all", 1, 2), 0.2) << method;
    EXPECT_LT(between("all", 2, 3), 0.2) << method;
  }
}

TEST(Outlines, WhatIsNotDrawnBetweenObjectsIsSaid) {
  const Scene near = scene_of({ball(1.0, {-0.7, 0.0, 0.0}), ball(1.0, {0.7, 0.0, 0.0})});
  const Scene apart = scene_of({ball(0.5, {-1.0, 0.0, 0.0}), ball(0.5, {1.0, 0.0, 0.0})});
  const Camera camera = from_ahead(120, 60, 3.0);
  for (const std::string method : {"distance", "jump_flood", "blur", "extrude"}) {
    const auto says = [&](const Scene& scene, const std::string& group) {
      const Border border = draw(scene, camera, method, {{"group", word(group)}}).border;
      return std::any_of(border.notes.begin(), border.notes.end(),
                         [](const std::string& note) { return note.find("group = object") != std::string::npos; });
    };
    EXPECT_TRUE(says(near, "all")) << method;
    EXPECT_FALSE(says(near, "object")) << method;
    EXPECT_FALSE(says(apart, "all")) << method;
  }
}

/// A ball behind a plate, half of it beyond the plate's edge: its circle goes on through the plate, in another colour.
TEST(Outlines, OfWhatIsHiddenGoOnThroughWhatHidesIt) {
  const Scene scene = scene_of({block({1.0, 1.5, 0.1}, {-1.0, 0.0, 0.0}), ball(1.0, {0.0, 0.0, -2.0})});
  const Camera camera = from_ahead(160, 120, 3.6);
  const double unit = camera.pixels_per_unit;
  const glm::vec3 ghost(1.0f, 0.0f, 0.0f);
  for (const std::string kind : {"analytic", "mesh"}) {
    for (const std::string method : {"distance", "jump_flood", "blur", "extrude"}) {
      for (const std::string group : {"object", "all"}) {
        Given given{{"group", word(group)}, {"hidden", word("drawn")}};
        given["hidden_color"].numbers = {1.0, 0.0, 0.0};
        if (method == "blur") given["edge"] = word("hard");
        const Drawing with = draw(scene, camera, method, given, kind);
        given["hidden"] = word("none");
        const Drawing without = draw(scene, camera, method, given, kind);
        int on_circle = 0, drawn_there = 0, elsewhere = 0;
        for (int y = 0; y < 120; ++y) {
          for (int x = 0; x < 160; ++x) {
            const size_t i = with.seen.id.index(x, y);
            const double away = std::hypot(x + 0.5 - 80.0, y + 0.5 - 60.0) - unit;  // From the ball's circle.
            const bool hidden = with.border.coverage.pixels[i] != without.border.coverage.pixels[i];
            if (with.seen.id.pixels[i] == 1 && x + 0.5 < 74.0 && away > 0.8 && away < 2.0) {
              ++on_circle;
              drawn_there += hidden && glm::length(with.border.colors.pixels[i] - ghost) < 1e-6f;
            }
            elsewhere += hidden && (with.seen.id.pixels[i] != 1 || away < -1.0 || (method != "blur" && away > 4.2));
          }
        }
        EXPECT_GT(on_circle, 60);
        EXPECT_EQ(drawn_there, on_circle) << method << " " << group << " " << kind;
        EXPECT_EQ(elsewhere, 0) << method << " " << group << " " << kind;
      }
    }
  }
}

/// Two blocks that share four planes: where both are, the first is seen, whatever rounding says.
TEST(SeveralObjects, OnOnePlaneShowOneOfThem) {
  for (const std::string kind : {"analytic", "mesh"}) {
    std::vector<SceneObject> objects;
    for (const double x : {-0.3, 0.4}) {
      const Field field = translate(make_shape("box", {{"half", {0.6, 0.4, 0.5}}}), {x, 0.0, 0.0});
      objects.push_back(object_of(rotate(field, {0.3, 1.0, 0.2}, 0.6)));
    }
    const Scene scene = scene_of(objects);
    const SceneModel model = model_of(scene, kind);
    for (int k = 0; k < 6; ++k) {
      CameraSettings settings = view(160, 120);
      settings.direction = glm::dvec3(std::cos(1.0 * k), 0.8, std::sin(1.0 * k));
      const GBuffer seen = render_gbuffer(model, framing(scene, settings), {});
      // A pixel whose four neighbours all show the other object.
      int alone = 0;
      for (int y = 1; y < 119; ++y) {
        for (int x = 1; x < 159; ++x) {
          const int id = seen.id.at(x, y);
          const auto other = [&](int u, int v) { return seen.id.at(u, v) != 0 && seen.id.at(u, v) != id; };
          alone += id != 0 && other(x - 1, y) && other(x + 1, y) && other(x, y - 1) && other(x, y + 1);
        }
      }
      EXPECT_EQ(alone, 0) << kind << ", view " << k;
    }
  }
}

RC_GTEST_PROP(MirroredFields, HaveTheValuesOfTheirMirrorImage, ()) {
  const auto seed = *rc::gen::arbitrary<unsigned>();
  RC_LOG() << "seed " << seed << "\n";
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-2.0, 2.0), factor(0.3, 2.0);
  const Field field = translate(make_shape("cone"), {0.3, 0.2, -0.1});
  const glm::dvec3 size(factor(random), factor(random), factor(random)), sign(random() % 2 ? 1 : -1, random() % 2 ? 1 : -1, -1.0);
  const Field plain = scale(field, size), mirrored = scale(field, size * sign);
  FieldEvaluator a(plain), b(mirrored);
  for (int i = 0; i < 20; ++i) {
    const glm::dvec3 p(coordinate(random), coordinate(random), coordinate(random));
    RC_ASSERT(std::abs(a.value(p) - b.value(p * sign)) <= 1e-12);
  }
}

/// Volumes under a mirrored transform: the picture of the mirrored volume is the mirrored picture.
TEST(MirroredVolumes, ShowTheirMirrorImage) {
  LevelSetSettings settings;
  settings.voxel_size = 0.04;
  const Field field = combine(Csg::difference, make_shape("box", {{"half", {0.8, 0.5, 0.6}}}),
                              translate(make_shape("sphere", {{"radius", {0.5}}}), {0.6, 0.4, 0.5}));
  SceneObject volume = object_of(field);
  volume.source = LevelSetSource{level_set_from_field(field, settings), "test.vdb"};
  SceneObject mirrored = volume;
  mirrored.world_from_object.linear = glm::dmat3(-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
  const auto shot = [](const SceneObject& object, double x) {
    CameraSettings camera = view(90, 70);
    camera.eye = glm::dvec3(x, 1.2, 3.5);
    camera.target = glm::dvec3(0.0);
    const Scene scene = scene_of({object});
    return render_gbuffer(model_of(scene, "level_set"), framing(scene, camera), {});
  };
  const GBuffer a = shot(volume, 1.5), b = shot(mirrored, -1.5);
  int hits = 0, different = 0;
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 90; ++x) {
      const size_t i = a.id.index(x, y), j = a.id.index(89 - x, y);
      hits += a.id.pixels[i] != 0;
      const glm::vec3 n = b.normal.pixels[j];
      different += a.id.pixels[i] != b.id.pixels[j] || glm::length(a.normal.pixels[i] - glm::vec3(-n.x, n.y, n.z)) > 0.02f;
    }
  }
  EXPECT_GT(hits, 800);
  EXPECT_LT(different, hits / 100);
}

}  // namespace
}  // namespace limn::test
