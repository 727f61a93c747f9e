// A plane that fills the view has no border: no image method may draw one with modulation on; with it off the edge methods must.

#include "tests/raymarch/image_buffers.h"

namespace limn {
namespace {

using test::drawn;
using test::value;
using test::word;

struct View {
  Camera camera;
  std::string name;
};

/// Sizes from tiny to 640, both projections; perspective with focal lengths from 9 to 2000 px.
std::vector<View> views() {
  std::vector<View> all;
  for (const glm::ivec2 size : {glm::ivec2(1, 1), {16, 9}, {64, 64}, {240, 131}, {640, 7}}) {
    for (const double scale_px : {9.0, 70.0, 2000.0}) {
      for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        all.push_back({test::straight_camera(size.x, size.y, projection, scale_px),
                       std::to_string(size.x) + "x" + std::to_string(size.y) + " scale " + std::to_string(scale_px) +
                           (projection == Projection::perspective ? " perspective" : " orthographic")});
      }
    }
  }
  return all;
}

/// Seen at up to `tilt` degrees: orthographic by every ray, perspective by the pixel of the picture that grazes most. Empty where the field
/// of view is too wide for the plane to fill it. `turn` is the direction in the image in which the plane recedes.
std::optional<GBuffer> tilted_plane(const Camera& camera, double tilt_deg, double turn_deg) {
  const glm::dvec2 recede(std::cos(glm::radians(turn_deg)), std::sin(glm::radians(turn_deg)));
  const auto largest_angle = [&](double angle) {
    const glm::dvec3 normal(-std::sin(angle) * recede, std::cos(angle));
    double least = 1.0;
    for (const int x : {0, camera.width_px - 1}) {
      for (const int y : {0, camera.height_px - 1})
        least = std::min(least, -glm::dot(normal, camera_ray(camera, x + 0.5, y + 0.5).direction));
    }
    return glm::degrees(std::acos(std::clamp(least, -1.0, 1.0)));
  };
  double low = 0.0, high = glm::radians(90.0);
  if (largest_angle(low) > tilt_deg) return std::nullopt;
  for (int i = 0; i < 60; ++i) (largest_angle(0.5 * (low + high)) <= tilt_deg ? low : high) = 0.5 * (low + high);
  // Near, so that single precision keeps its digits, and far enough that no ray starts behind the plane.
  const double distance =
      camera.projection == Projection::perspective ? 1.0 : std::hypot(camera.width_px, camera.height_px) / camera.pixels_per_unit;
  return test::plane_buffer(camera, {-std::sin(low) * recede, std::cos(low)}, distance);
}

std::map<std::string, ParameterInput> settings_for(const std::string& method, bool modulation) {
  if (method != "roberts" && method != "sobel") return {};
  return {{"modulation", word(modulation ? "true" : "false")}};
}

TEST(BorderPlane, NoImageMethodDrawsALineOnAPlaneAtAnyTiltWithModulationOn) {
  int planes = 0;
  for (const View& view : views()) {
    for (const double turn : {0.0, 37.0, 90.0}) {
      for (const double tilt : {0.0, 20.0, 45.0, 60.0, 65.0, 75.0, 85.0, 88.0, 89.0}) {
        const std::optional<GBuffer> plane = tilted_plane(view.camera, tilt, turn);
        if (!plane) continue;
        ++planes;
        for (const std::string& method : test::image_methods()) {
          const Border border = drawn(method, *plane, view.camera, settings_for(method, true));
          ASSERT_EQ(test::area(border.coverage), 0.0) << method << " " << view.name << " tilt " << tilt << " turn " << turn;
          EXPECT_TRUE(border.notes.empty()) << border.notes[0];
        }
      }
    }
  }
  EXPECT_GT(planes, 400);
}

TEST(BorderPlane, WithModulationOffTheFalseLinesAreThereAndCounted) {
  for (const std::string method : {"roberts", "sobel"}) {
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
      const Camera camera = test::straight_camera(64, 48, projection, 400.0);
      for (const double tilt : {80.0, 85.0, 89.0}) {
        const std::optional<GBuffer> plane = tilted_plane(camera, tilt, 37.0);
        ASSERT_TRUE(plane);
        const Border off = drawn(method, *plane, camera, settings_for(method, false));
        EXPECT_GT(test::area(off.coverage), 0.2 * 64 * 48) << method << " tilt " << tilt;
        ASSERT_EQ(off.notes.size(), 1u);
        EXPECT_NE(off.notes[0].find("does not jump"), std::string::npos);
        EXPECT_EQ(test::area(drawn(method, *plane, camera, settings_for(method, true)).coverage), 0.0);
      }
    }
  }
}

TEST(BorderPlane, EachOfTheTwoModulationsIsNeeded) {
  // Grazing alone: a floor that reaches far needs a threshold that grows with depth. Distance alone: a steep plane needs the angle.
  const Camera camera = test::straight_camera(64, 64, Projection::perspective, 40.0);
  const GBuffer floor = *tilted_plane(camera, 89.0, 90.0);
  for (const std::string method : {"roberts", "sobel"}) {
    EXPECT_GT(test::area(drawn(method, floor, camera, {{"distance_factor", value(0)}}).coverage), 0.0);
    EXPECT_GT(test::area(drawn(method, floor, camera, {{"grazing_strength", value(0)}}).coverage), 0.0);
    EXPECT_EQ(test::area(drawn(method, floor, camera).coverage), 0.0);
  }
}

TEST(BorderPlane, ATracedPlaneIsAsQuietAsAWrittenOne) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    for (const double tilt : {0.0, 60.0, 86.0}) {
      Scene scene = test::scene_of({test::object_of(make_shape("plane"))});
      CameraSettings settings = test::view(96, 64, projection);
      settings.vertical_fov = glm::radians(2.0);
      settings.ortho_height = 0.3;
      settings.target = glm::dvec3(0.0);
      settings.eye = 4.0 * glm::dvec3(std::sin(glm::radians(tilt)), std::cos(glm::radians(tilt)), 0.0);
      settings.up = glm::dvec3(0.0, 0.0, 1.0);
      const Camera camera = test::framing(scene, settings);
      const SceneModel model = test::model_of(scene);
      const GBuffer seen = render_gbuffer(model, camera, {});
      ASSERT_EQ(count_hits(seen).hits, 96 * 64);
      for (const std::string& method : test::image_methods()) {
        const Border border = find_border_method(method).draw({seen, camera, model, scene}, test::parameters_of(method));
        EXPECT_EQ(test::area(border.coverage), 0.0) << method << " tilt " << tilt;
      }
    }
  }
}

}  // namespace
}  // namespace limn
