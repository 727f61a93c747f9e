// Extruded outlines: their width against closed-form silhouettes, their gaps, and the rasteriser behind them.

#include <fmt/core.h>

#include <numbers>

#include "raymarch/border/extrude.h"
#include "subdiv/polygon.h"
#include "subdiv/tessellate.h"
#include "tests/raymarch/image_buffers.h"

namespace limn::test {
namespace {

using Given = std::map<std::string, ParameterInput>;

/// Object ids and ink at kFine x kFine samples of every pixel.
constexpr int kFine = 4;
struct FinePicture {
  Image<std::int32_t> id;
  Image<float> ink;
};

FinePicture fine_picture(const Scene& scene, const SceneModel& model, const Camera& camera, const std::string& method, const Given& given) {
  FinePicture fine{{camera.width_px * kFine, camera.height_px * kFine, 0}, {camera.width_px * kFine, camera.height_px * kFine, 0.0f}};
  const Parameters parameters = parameters_of(method, given);
  for (int j = 0; j < kFine; ++j) {
    for (int i = 0; i < kFine; ++i) {
      const GBuffer seen = render_gbuffer(model, camera, {}, {(i + 0.5) / kFine, (j + 0.5) / kFine});
      const Border border = find_border_method(method).draw({seen, camera, model, scene}, parameters);
      for (int y = 0; y < seen.height; ++y) {
        for (int x = 0; x < seen.width; ++x) {
          fine.id.at(x * kFine + i, y * kFine + j) = seen.id.at(x, y);
          fine.ink.at(x * kFine + i, y * kFine + j) = border.coverage.at(x, y);
        }
      }
    }
  }
  return fine;
}

using Support = std::function<double(const glm::dvec3&)>;  // of a convex body about the origin, by unit direction

/// The image of a convex body as the half planes that hold it: directions, and how far it reaches along each (pixels from the image's
/// middle, y up). A plane through the eye with normal (a, b, c) in camera axes meets the image in a x + b y = c f.
struct ConvexImage {
  std::vector<glm::dvec2> direction;
  std::vector<double> reach;
  /// Distance of points outside; negative inside.
  double distance(const glm::dvec2& p) const {
    // Coarsely, then finely about the best: a tangent half a degree off passes far from the end of a long side.
    constexpr int step = 40;
    const int count = static_cast<int>(reach.size());
    const auto at = [&](int i) { return glm::dot(p, direction[static_cast<size_t>(i)]) - reach[static_cast<size_t>(i)]; };
    int best = 0;
    for (int i = 0; i < count; i += step) best = at(i) > at(best) ? i : best;
    double largest = at(best);
    if (largest > 8.0 || largest < -8.0) return largest;
    for (int i = best - step; i <= best + step; ++i) largest = std::max(largest, at((i + count) % count));
    return largest;
  }
};

ConvexImage convex_image(const Camera& camera, const Support& support) {
  ConvexImage image;
  constexpr int count = 14400;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    const glm::dvec2 d(std::cos(angle), std::sin(angle));
    const auto normal = [&](double c) { return camera.world_from_camera * glm::normalize(glm::dvec3(d, c)); };
    image.direction.push_back(d);
    if (camera.projection == Projection::orthographic) {
      image.reach.push_back(camera.pixels_per_unit * (support(normal(0.0)) - glm::dot(normal(0.0), camera.eye)));
      continue;
    }
    // The plane through the eye turns about the image's tangent line until it touches: support(n) = n . eye.
    double low = -10.0, high = 10.0;
    for (int step = 0; step < 60; ++step) {
      const double c = 0.5 * (low + high);
      (support(normal(c)) - glm::dot(normal(c), camera.eye) > 0.0 ? low : high) = c;
    }
    image.reach.push_back(camera.focal_px * 0.5 * (low + high));
  }
  return image;
}

struct Reach {
  double least = 1e30, greatest = -1e30;
};

/// How far the ink reaches from the silhouette: no sample with ink lies farther than `greatest`, none without nearer than `least`. The
/// hundreds of samples about the line's border lie at all distances from it, so that this is as good as measuring below the pixel.
Reach ink_reach(const Image<float>& ink, const ConvexImage& silhouette) {
  Reach reach;
  for (int y = 0; y < ink.height; ++y) {
    for (int x = 0; x < ink.width; ++x) {
      const glm::dvec2 p(x + 0.5 - 0.5 * ink.width, 0.5 * ink.height - y - 0.5);
      const double distance = silhouette.distance(p);
      // The band of 1/4 px about the silhouette belongs to the object's own sampling.
      if (distance < 0.25 || distance > 20.0) continue;
      if (ink.at(x, y) > 0.5f) reach.greatest = std::max(reach.greatest, distance);
      if (ink.at(x, y) <= 0.5f) reach.least = std::min(reach.least, distance);
    }
  }
  return reach;
}

double sphere_support(const glm::dvec3&) { return 1.0; }
double rounded_box_support(const glm::dvec3& n) { return glm::dot(glm::dvec3(0.7, 0.5, 0.3), glm::abs(n)) + 0.2; }

TEST(Extrude, InClipSpaceIsAsManyPixelsWideAllAround) {
  struct Body {
    std::string name;
    Field field;
    Support support;
  };
  const std::vector<Body> bodies{
      {"sphere", make_shape("sphere", {{"radius", {1.0}}}), sphere_support},
      {"rounded box", make_shape("rounded_box", {{"half", {0.9, 0.7, 0.5}}, {"rounding", {0.2}}}), rounded_box_support}};
  for (const Body& body : bodies) {
    const Scene scene = scene_of({object_of(body.field)});
    for (const std::string kind : {"mesh", "analytic", "level_set", "mesh_level_set"}) {
      SurfaceSettings how = surface_kind(kind);
      how.level = 4;
      how.voxels = 64;
      const SceneModel model = build_model(scene, how);
      for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        CameraSettings settings = view(210, 140, projection);
        settings.direction = glm::dvec3(0.5, 0.7, 1.1);
        const Camera camera = framing(scene, settings);
        const ConvexImage silhouette = convex_image(camera, body.support);
        for (const std::string mask : {"back_faces", "stencil"}) {
          const GBuffer seen = render_gbuffer(model, camera, {});
          const Parameters parameters = parameters_of("extrude", {{"width", value(3.0)}, {"mask", word(mask)}});
          const Reach reach = ink_reach(find_border_method("extrude").draw({seen, camera, model, scene}, parameters).coverage, silhouette);
          fmt::print("{}, {}, {}, {}: 3 px drawn from {:.3f} to {:.3f} px wide\n", body.name, kind, mask,
                     projection == Projection::perspective ? "perspective" : "orthographic", reach.least, reach.greatest);
          EXPECT_GT(reach.least, 2.75);
          EXPECT_LT(reach.greatest, 3.25);
        }
      }
    }
  }
}

/// Marks what 4-neighbours reach from the picture's corner without crossing ink.
Image<std::uint8_t> reached_from_corner(const Image<float>& ink) {
  Image<std::uint8_t> reached(ink.width, ink.height, 0);
  std::vector<glm::ivec2> stack{{0, 0}};
  while (!stack.empty()) {
    const glm::ivec2 p = stack.back();
    stack.pop_back();
    if (!ink.inside(p.x, p.y) || reached.at(p.x, p.y) || ink.at(p.x, p.y) > 0.5f) continue;
    reached.at(p.x, p.y) = 1;
    for (const glm::ivec2 step : {glm::ivec2(1, 0), glm::ivec2(-1, 0), glm::ivec2(0, 1), glm::ivec2(0, -1)}) stack.push_back(p + step);
  }
  return reached;
}

int components(Image<float> ink) {
  int count = 0;
  for (int y = 0; y < ink.height; ++y) {
    for (int x = 0; x < ink.width; ++x) {
      if (ink.at(x, y) <= 0.5f) continue;
      ++count;
      std::vector<glm::ivec2> stack{{x, y}};
      while (!stack.empty()) {
        const glm::ivec2 p = stack.back();
        stack.pop_back();
        if (!ink.inside(p.x, p.y) || ink.at(p.x, p.y) <= 0.5f) continue;
        ink.at(p.x, p.y) = 0.0f;
        for (int v = -1; v <= 1; ++v) {
          for (int u = -1; u <= 1; ++u) stack.push_back(p + glm::ivec2(u, v));
        }
      }
    }
  }
  return count;
}

struct Drawn {
  GBuffer seen;
  Border border;
};

Drawn draw_extruded(const Scene& scene, const SceneModel& model, const Camera& camera, const Given& given) {
  GBuffer seen = render_gbuffer(model, camera, {});
  Border border = find_border_method("extrude").draw({seen, camera, model, scene}, parameters_of("extrude", given));
  return {std::move(seen), std::move(border)};
}

bool any_note(const Border& border, const std::string& part) {
  return std::any_of(border.notes.begin(), border.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

TEST(Extrude, TheOffsetOfABoxIsOneClosedLine) {
  const Scene scene = scene_of({object_of(make_shape("box", {{"half", {1.0, 0.8, 0.6}}}))});
  for (const std::string kind : {"analytic", "level_set"}) {
    const SceneModel model = model_of(scene, kind);
    for (int i = 0; i < 5; ++i) {
      CameraSettings settings = view(200, 150);
      settings.direction = view_direction(i, 5);
      const Drawn drawn = draw_extruded(scene, model, framing(scene, settings), {});
      EXPECT_EQ(components(drawn.border.coverage), 1) << kind << ", view " << i;
      EXPECT_TRUE(drawn.border.notes.empty()) << drawn.border.notes[0];
      const Image<std::uint8_t> outside = reached_from_corner(drawn.border.coverage);
      for (size_t k = 0; k < outside.size(); ++k) ASSERT_FALSE(outside.pixels[k] && drawn.seen.id.pixels[k]) << kind << ", view " << i;
    }
  }
}

SurfaceSettings flat_mesh() {
  SurfaceSettings settings = surface_kind("mesh");
  settings.normals = NormalKind::flat;
  return settings;
}

TEST(Extrude, AlongSplitNormalsABoxGapsWhereItsBackFacesMeetOnTheOutlineAndSmoothNormalsCloseIt) {
  const Scene scene = scene_of({object_of(box_mesh({1.0, 0.8, 0.6}))});
  const SceneModel model = build_model(scene, flat_mesh());
  for (int i = 0; i < 6; ++i) {
    CameraSettings settings = view(300, 240);
    settings.direction = view_direction(i, 6) + glm::dvec3(0.2, 0.1, 0.15);  // no face edge on
    const Camera camera = framing(scene, settings);
    int back_faces = 0;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        glm::dvec3 normal(0.0);
        normal[axis] = side;
        back_faces += glm::dot(normal, camera.eye) <= glm::dvec3(1.0, 0.8, 0.6)[axis];
      }
    }
    const Drawn split = draw_extruded(scene, model, camera, {{"direction", word("vertex_normal")}, {"width", value(8.0)}});
    const OutlineGaps gaps = outline_gaps(split.seen, split.border.coverage);
    fmt::print("view {}: {} back faces; {}\n", i, back_faces, split.border.notes.empty() ? "no note" : split.border.notes[0]);
    // Three faces turned away meet in three corners of the outline; of five (one face seen) the four beside it do in four; of four (two
    // faces seen), each of the two ends of the seen pair meets both neighbours.
    EXPECT_EQ(gaps.gaps, back_faces == 3 ? 3 : 4) << "view " << i;
    EXPECT_TRUE(any_note(split.border, "extrude by vertex_normal: " + std::to_string(gaps.gaps) + " gap"));
    const Drawn smooth = draw_extruded(scene, model, camera, {{"direction", word("smooth_normal")}, {"width", value(8.0)}});
    EXPECT_EQ(outline_gaps(smooth.seen, smooth.border.coverage).gaps, 0) << "view " << i;
    EXPECT_EQ(components(smooth.border.coverage), 1) << "view " << i;
  }
}

/// Mean width from areas, of a ball seen straight on.
double ring_width(const Scene& scene, double distance, const Given& given) {
  CameraSettings settings = view(72, 60);
  settings.eye = glm::dvec3(0.0, 0.0, distance);
  settings.target = glm::dvec3(0.0);
  SurfaceSettings how = surface_kind("mesh");
  how.level = 4;
  const FinePicture fine = fine_picture(scene, build_model(scene, how), framing(scene, settings), "extrude", given);
  double object = 0.0, ink = 0.0;
  for (size_t i = 0; i < fine.id.size(); ++i) {
    object += fine.id.pixels[i] != 0;
    ink += fine.id.pixels[i] == 0 && fine.ink.pixels[i] > 0.5f;
  }
  const double scale = 1.0 / (std::numbers::pi * kFine * kFine);
  return std::sqrt((object + ink) * scale) - std::sqrt(object * scale);
}

TEST(Extrude, InObjectSpaceShrinksWithDistanceAndGrowsWithTheObject) {
  const Given given{{"space", word("object")}, {"object_width", value(0.1)}};
  const Scene ball = scene_of({object_of(make_shape("sphere"))});
  const double near = ring_width(ball, 5.0, given), far = ring_width(ball, 10.0, given);
  // Radius and grown radius, seen under asin(r / d), at this focal length.
  const double focal = 30.0 / std::tan(0.5 * CameraSettings{}.vertical_fov);
  const auto seen = [focal](double r, double d) { return focal * std::tan(std::asin(r / d)); };
  EXPECT_NEAR(near, seen(1.1, 5.0) - seen(1.0, 5.0), 0.05);
  EXPECT_NEAR(far, seen(1.1, 10.0) - seen(1.0, 10.0), 0.05);
  EXPECT_LT(far, 0.53 * near);
  Scene doubled = scene_of({object_of(tessellate(make_shape("sphere", {{"radius", {0.5}}}), {4, NormalKind::limit, 1 << 30}))});
  const double small = ring_width(doubled, 5.0, given);
  doubled.objects[0].world_from_object.linear = glm::dmat3(2.0);
  const double large = ring_width(doubled, 5.0, given);
  EXPECT_NEAR(small, seen(0.6, 5.0) - seen(0.5, 5.0), 0.05);
  EXPECT_NEAR(large, seen(1.2, 5.0) - seen(1.0, 5.0), 0.05) << "twice the object's own 0.1";
}

TEST(Extrude, SaysWhereNormalsPointTheWrongWay) {
  Mesh mesh = box_mesh({1.0, 0.8, 0.6});
  mesh.corner_normals = face_normals_at_corners(mesh);
  for (glm::vec3& normal : mesh.corner_normals) normal = -normal;
  const Scene scene = scene_of({object_of(mesh)});
  SurfaceSettings how = surface_kind("mesh");
  how.normals = NormalKind::limit;
  const Drawn drawn = draw_extruded(scene, build_model(scene, how), framing(scene, view(160, 120)), {{"direction", word("vertex_normal")}});
  for (const std::string& note : drawn.border.notes) fmt::print("{}\n", note);
  EXPECT_TRUE(any_note(drawn.border, "24 of 24 corner normals point against their faces"));
  EXPECT_TRUE(any_note(drawn.border, "inwards on 100.0 % of the outline"));
}

TEST(Extrude, ByPositionIsUnevenAndSaysSo) {
  const Scene scene = scene_of({object_of(box_mesh({3.0, 0.5, 0.5}))});
  CameraSettings settings = view(300, 120, Projection::orthographic);
  settings.direction = glm::dvec3(0.1, 0.1, 1.0);
  const Drawn drawn = draw_extruded(scene, build_model(scene, flat_mesh()), framing(scene, settings),
                                    {{"direction", word("position")}, {"space", word("object")}, {"object_width", value(0.05)}});
  for (const std::string& note : drawn.border.notes) fmt::print("{}\n", note);
  EXPECT_TRUE(any_note(drawn.border, "extrude by position: "));
  EXPECT_TRUE(any_note(drawn.border, "px wide along the outline"));
}

TEST(Extrude, OfAVolumeWhoseBandIsTooNarrowSaysWhatItNeeds) {
  LevelSetSettings grid;
  grid.voxel_size = 0.05;
  const LevelSet level_set = level_set_from_field(make_shape("sphere"), grid);
  const Scene scene = scene_of({{"volume", LevelSetSource{level_set, "ball.vdb"}, {}, glm::vec3(0.8f), 0, std::nullopt}});
  const SceneModel model = model_of(scene, "level_set");
  const Camera camera = framing(scene, view(120, 90));
  EXPECT_TRUE(draw_extruded(scene, model, camera, {{"width", value(1.0)}}).border.notes.empty());
  try {
    draw_extruded(scene, model, camera, {{"width", value(10.0)}});
    FAIL() << "nothing thrown";
  } catch (const InputError& error) {
    fmt::print("{}\n", error.what());
    EXPECT_EQ(error.fault().file, "ball.vdb");
    EXPECT_NE(error.fault().expected.find("a half width of"), std::string::npos);
  }
}

TEST(Extrude, DrawsTheSameBytesForAnyNumberOfThreads) {
  const Scene scene = scene_of({object_of(make_shape("torus"))});
  for (const std::string kind : {"mesh", "analytic", "level_set"}) {
    const SceneModel model = model_of(scene, kind);
    const Camera camera = framing(scene, view(130, 90));
    ExecutionSettings one, three;
    one.threads = 1;
    three.threads = 3;
    const PictureSettings settings{{call_of("extrude")}, 2, {}};
    const Picture a = draw_picture(scene, model, camera, settings, one), b = draw_picture(scene, model, camera, settings, three);
    EXPECT_EQ(a.border.pixels, b.border.pixels) << kind;
    EXPECT_EQ(a.notes, b.notes) << kind;
    for (const float ink : a.border.pixels) ASSERT_TRUE(ink >= 0.0f && ink <= 1.0f);
  }
}

// Samples share the grown mesh or the offset, and look for no notes after the first.
TEST(Extrude, OfSeveralSamplesIsThatOfEachAlone) {
  constexpr int kSamples = 3;
  const Scene scene =
      scene_of({object_of(make_shape("torus")), object_of(translate(make_shape("sphere", {{"radius", {0.6}}}), {1.5, 0.2, 0.1}))});
  const Camera camera = framing(scene, view(66, 44));
  // Two widths share nothing.
  const PictureSettings settings{
      {call_of("extrude", {{"width", value(5.0)}, {"mask", word("stencil")}}), call_of("extrude")}, kSamples, {}};
  for (const std::string kind : {"mesh", "analytic", "level_set"}) {
    const SceneModel model = build_model(scene, {.kind = kind, .voxels = 48, .level = 2});
    Picture alone;
    for (int sample = 0; sample < kSamples; ++sample) {
      const GBuffer seen = render_gbuffer(model, camera, {}, sample_offset(sample, kSamples));
      add_sample({seen, camera, model, scene}, settings.methods, alone);
    }
    finish_samples(settings, alone);
    const Picture shared = draw_picture(scene, model, camera, settings, {});
    EXPECT_EQ(shared.border.pixels, alone.border.pixels) << kind;
    EXPECT_EQ(shared.notes, alone.notes) << kind;
    EXPECT_GT(*std::max_element(shared.border.pixels.begin(), shared.border.pixels.end()), 0.9f) << kind;
  }
}

TEST(Extrude, InnerContoursAreInkedByBackFacesAlone) {
  // The near part of a tilted torus stands before its far part: more ink on the object than the stencil's none.
  const Scene scene = scene_of({object_of(make_shape("torus", {{"major", {1.0}}, {"minor", {0.4}}}))});
  CameraSettings settings = view(200, 120);
  settings.direction = glm::dvec3(0.0, 0.35, 1.0);
  for (const std::string kind : {"mesh", "analytic", "level_set"}) {
    SurfaceSettings how = surface_kind(kind);
    how.level = 4;
    const SceneModel model = build_model(scene, how);
    std::int64_t on_object[2] = {0, 0};
    for (const std::string mask : {"back_faces", "stencil"}) {
      const Drawn drawn = draw_extruded(scene, model, framing(scene, settings), {{"mask", word(mask)}});
      for (size_t i = 0; i < drawn.seen.id.size(); ++i)
        on_object[mask == "stencil"] += drawn.seen.id.pixels[i] != 0 && drawn.border.coverage.pixels[i] > 0.5f;
    }
    fmt::print("{}: {} pixels of inner contour\n", kind, on_object[0]);
    EXPECT_GT(on_object[0], 100) << kind;
    EXPECT_EQ(on_object[1], 0) << kind;
  }
}

}  // namespace
}  // namespace limn::test
