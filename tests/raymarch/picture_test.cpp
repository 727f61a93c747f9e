// Composite, inks, samples, and the metrics on pictures made by hand.

#include <algorithm>
#include <cmath>

#include "raymarch/metric.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

double value_of(const Metric& metric, const MetricInput& input, const std::string& name) {
  for (const MetricValue& value : metric.measure(input)) {
    if (value.name == name) return value.value;
  }
  ADD_FAILURE() << "no value " << name;
  return std::nan("");
}

Picture sphere_picture(int samples = 1, std::optional<glm::vec3> background = std::nullopt) {
  const Scene scene = scene_of({object_of(make_shape("sphere"))});
  return draw_picture(scene, model_of(scene), framing(scene, view(64, 64)), {{call_of("rim")}, samples, background}, {});
}

TEST(Picture, TheHeadlightShadesFromAQuarterToTheWholeColour) {
  const Scene scene = scene_of({object_of(make_shape("sphere"))});
  const SceneModel model = model_of(scene);
  CameraSettings settings = view(33, 33);
  settings.target = glm::dvec3(0.0);
  const GBuffer seen = render_gbuffer(model, framing(scene, settings), {});
  const Image<glm::vec4> shaded = shade_headlight(seen, model);
  EXPECT_NEAR(shaded.at(16, 16).r, 0.8f, 1e-5f);
  EXPECT_EQ(shaded.at(0, 0), glm::vec4(0.0f));
  for (size_t i = 0; i < seen.id.size(); ++i) {
    if (seen.id.pixels[i]) {
      EXPECT_NEAR(shaded.pixels[i].g, 0.5f * (0.25f + 0.75f * seen.n_dot_v.pixels[i]), 1e-6f);
    }
  }
}

TEST(Picture, InkIsMixedOverAPremultipliedPicture) {
  Image<glm::vec4> picture(2, 1, glm::vec4(0.2f, 0.1f, 0.0f, 0.5f));
  Image<float> coverage(2, 1);
  coverage.pixels = {0.25f, 1.0f};
  lay_ink(picture, coverage, {1.0f, 0.0f, 0.4f});
  EXPECT_NEAR(glm::length(picture.pixels[0] - glm::vec4(0.4f, 0.075f, 0.1f, 0.625f)), 0.0f, 1e-6f);
  EXPECT_NEAR(glm::length(picture.pixels[1] - glm::vec4(1.0f, 0.0f, 0.4f, 1.0f)), 0.0f, 1e-6f);
}

TEST(Picture, TheLastInkLiesOnTop) {
  const Scene scene = scene_of({object_of(make_shape("sphere"))});
  const auto all = [](double red) { return call_of("fresnel", {{"width", {{1.0}, {}, {}}}, {"color", {{red, 0.0, 0.0}, {}, {}}}}); };
  const Picture picture = draw_picture(scene, model_of(scene), framing(scene, view(9, 9)), {{all(0.2), all(0.9)}, 1, {}}, {});
  EXPECT_NEAR(picture.composite.at(4, 4).r, 0.9f, 1e-6f);
  EXPECT_EQ(picture.border.at(4, 4), 1.0f);
}

// The last sample finishes the sums, and normals are traced for the notes of the first alone: the same bits as from all layers of every
// sample, added up and finished by a pass of its own.
TEST(Picture, IsThatOfItsSamplesFinishedAfterwards) {
  const Scene scene = scene_of({object_of(make_shape("torus"))});
  const SceneModel model = model_of(scene);
  const Camera camera = framing(scene, view(96, 54));
  for (const char* const method : {"rim", "fresnel", "sobel"}) {
    for (const int samples : {1, 2, 5}) {
      for (const std::optional<glm::vec3>& background : {std::optional<glm::vec3>(), std::optional<glm::vec3>({0.3f, 0.7f, 0.1f})}) {
        PictureSettings settings{{call_of(method)}, samples, background};
        settings.layers = layers_read(settings.methods);
        const Picture drawn = draw_picture(scene, model, camera, settings, {});
        Picture sums;
        for (int sample = 0; sample < samples; ++sample) {
          const GBuffer all = render_gbuffer(model, camera, {}, sample_offset(sample, samples));
          add_sample({all, camera, model, scene}, settings.methods, sums);
        }
        finish_samples(settings, sums);
        EXPECT_TRUE(drawn.composite.pixels == sums.composite.pixels) << method << ", " << samples << " samples";
        EXPECT_TRUE(drawn.border.pixels == sums.border.pixels) << method << ", " << samples << " samples";
        EXPECT_EQ(drawn.notes, sums.notes);
        EXPECT_GT(*std::max_element(drawn.border.pixels.begin(), drawn.border.pixels.end()), 0.9f);
      }
    }
  }
}

TEST(Picture, NormalsThatOnlyNotesReadAreNotTracedWithoutThem) {
  EXPECT_TRUE(layers_read(std::vector{call_of("rim")}).normal);
  EXPECT_FALSE(layers_read(std::vector{call_of("rim")}, false).normal);
  EXPECT_FALSE(layers_read(std::vector{call_of("rim"), call_of("fresnel")}, false).normal);
  EXPECT_TRUE(layers_read(std::vector{call_of("rim"), call_of("sobel")}, false).normal);
  // What only notes read is something that the method reads.
  for (const BorderMethod& method : border_methods()) {
    for (const std::string& input : method.only_for_notes)
      EXPECT_NE(std::find(method.inputs.begin(), method.inputs.end(), input), method.inputs.end()) << method.about.name << ": " << input;
  }
}

TEST(Picture, CoverageOverSamplesApproachesTheAreaOfTheBorder) {
  // Orthographic sphere of radius R: the border is a ring of area pi R^2 c^2.
  CameraSettings settings = view(48, 48, Projection::orthographic);
  settings.ortho_height = 2.4;
  const Scene scene = scene_of({object_of(make_shape("sphere", {{"radius", {1.0}}}))});
  const Camera camera = framing(scene, settings);
  double error[2];
  for (const int samples : {1, 64}) {
    const Picture picture = draw_picture(scene, model_of(scene), camera, {{call_of("rim")}, samples, {}}, {});
    double area = 0.0, alpha = 0.0;
    for (size_t i = 0; i < picture.border.size(); ++i) {
      area += picture.border.pixels[i];
      alpha += picture.composite.pixels[i].a;
    }
    const double disc = 3.14159265358979 * camera.pixels_per_unit * camera.pixels_per_unit;
    error[samples > 1] = std::abs(area / (disc * 0.16) - 1.0);
    if (samples > 1) {
      EXPECT_NEAR(alpha / disc, 1.0, 0.002);
    }
  }
  EXPECT_LT(error[1], 0.01);
  EXPECT_LT(error[1], std::max(error[0], 0.005));
}

TEST(Picture, TheFirstSampleIsThePixelCentre) {
  const Scene scene = scene_of({object_of(make_shape("sphere"))});
  const SceneModel model = model_of(scene);
  const Camera camera = framing(scene, view(16, 16));
  const GBuffer centres = render_gbuffer(model, camera, {});
  for (const int samples : {1, 5}) {
    const Picture picture = draw_picture(scene, model, camera, {{call_of("rim")}, samples, {}}, {});
    EXPECT_EQ(picture.gbuffer.depth.pixels, centres.depth.pixels);
  }
}

TEST(Picture, ABackgroundFillsWhatIsTransparent) {
  const Picture picture = sphere_picture(3, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_NEAR(glm::length(picture.composite.at(0, 0) - glm::vec4(0.1f, 0.2f, 0.3f, 1.0f)), 0.0f, 1e-6f);
  for (const glm::vec4& color : picture.composite.pixels) EXPECT_NEAR(color.a, 1.0f, 1e-5f);
}

TEST(Picture, SamplesOutOfRangeAreRefused) {
  EXPECT_THROW(sphere_picture(0), InputError);
  EXPECT_THROW(sphere_picture(1025), InputError);
}

TEST(Metrics, OfAPictureAgainstItselfAreNought) {
  const Picture picture = sphere_picture();
  const Camera camera;
  for (const Metric& metric : metrics()) {
    const std::vector<MetricValue> values = metric.measure({picture, picture, camera});
    ASSERT_EQ(values.size(), metric.values.size()) << metric.about.name;
    for (size_t i = 0; i < values.size(); ++i) {
      EXPECT_EQ(metric.values[i], values[i].name + (values[i].unit.empty() ? "" : " [" + values[i].unit + "]"));
      if (values[i].name.ends_with("_x") || values[i].name.ends_with("_y")) continue;  // where the first of many equals lies
      if (metric.subject == MetricSubject::curves || metric.subject == MetricSubject::motion) {
        EXPECT_TRUE(std::isnan(values[i].value)) << values[i].name;  // there are no curves and no moves
        continue;
      }
      if (metric.about.name == "topology" && !values[i].name.ends_with("difference")) continue;  // counts
      EXPECT_EQ(values[i].value, metric.lower_is_better ? 0.0 : 1.0) << values[i].name;
    }
  }
  EXPECT_THROW(find_metric("overlapp"), InputError);
}

TEST(Metrics, CountWhatIsMissingAndWhatIsFalse) {
  Picture a = sphere_picture(), b = a;
  a.border = b.border = Image<float>(64, 64, 0.0f);
  const Camera camera;
  for (int i = 0; i < 10; ++i) b.border.at(i, 0) = 1.0f;  // the reference: ten
  for (int i = 4; i < 13; ++i) a.border.at(i, 0) = 1.0f;  // six of them, and three false
  a.border.at(20, 0) = 0.5f;                              // half a false one
  const Metric& differ = find_metric("pixels_differ");
  EXPECT_EQ(value_of(differ, {a, b, camera}, "pixels_differ"), 8.0);
  EXPECT_EQ(value_of(differ, {a, b, camera}, "pixels_missing"), 4.0);
  EXPECT_EQ(value_of(differ, {a, b, camera}, "pixels_false"), 3.5);
  EXPECT_NEAR(value_of(find_metric("overlap"), {a, b, camera}, "overlap"), 6.0 / 13.5, 1e-12);
  const Image<glm::vec4> picture = difference_picture(a.border, b.border);
  EXPECT_GT(picture.at(0, 0).b, 3.0f * picture.at(0, 0).r);    // missing: blue
  EXPECT_GT(picture.at(12, 0).r, 3.0f * picture.at(12, 0).b);  // false: red
  EXPECT_EQ(picture.at(5, 0).r, picture.at(5, 0).b);           // common: grey
  EXPECT_LT(picture.at(5, 0).r, 0.9f);
  EXPECT_EQ(picture.at(63, 63), glm::vec4(1.0f));
}

TEST(Metrics, NormalAndDepthErrorsNameTheWorstPixel) {
  const Picture reference = sphere_picture();
  Picture picture = reference;
  const Camera camera;
  const double angle = 0.01;
  const glm::dvec3 n(reference.gbuffer.normal.at(30, 25));
  const glm::dvec3 across = glm::normalize(glm::cross(n, glm::dvec3(0.3, 0.5, -0.7)));
  picture.gbuffer.normal.at(30, 25) = glm::vec3(std::cos(angle) * n + std::sin(angle) * across);
  picture.gbuffer.depth.at(31, 26) += 0.25f;
  const double hits = static_cast<double>(count_hits(reference.gbuffer).hits);
  const Metric &normal = find_metric("normal_error"), &depth = find_metric("depth_error");
  EXPECT_NEAR(value_of(normal, {picture, reference, camera}, "normal_error_max"), glm::degrees(angle), 1e-5);
  EXPECT_NEAR(value_of(normal, {picture, reference, camera}, "normal_error_mean"), glm::degrees(angle) / hits, 1e-7);
  EXPECT_EQ(value_of(normal, {picture, reference, camera}, "normal_error_p99"), 0.0);
  EXPECT_EQ(value_of(normal, {picture, reference, camera}, "normal_error_max_x"), 30.0);
  EXPECT_EQ(value_of(normal, {picture, reference, camera}, "normal_error_max_y"), 25.0);
  EXPECT_NEAR(value_of(depth, {picture, reference, camera}, "depth_error_max"), 0.25, 1e-6);
  EXPECT_EQ(value_of(depth, {picture, reference, camera}, "depth_error_max_x"), 31.0);
}

TEST(Metrics, HaveNothingToMeasureWhereNothingIsHit) {
  const Scene scene = scene_of({});
  const Picture picture = draw_picture(scene, model_of(scene), framing(scene, view(4, 4)), {}, {});
  const Camera camera;
  EXPECT_TRUE(std::isnan(value_of(find_metric("normal_error"), {picture, picture, camera}, "normal_error_max")));
  EXPECT_EQ(value_of(find_metric("overlap"), {picture, picture, camera}, "overlap"), 1.0);
}

}  // namespace
}  // namespace limn::test
