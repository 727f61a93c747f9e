// From where pictures are taken, and how many.

#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>

#include "samples/commands/options_parts.h"
#include "samples/spec/parse.h"
#include "sdf/error.h"

namespace limn {
namespace {

/// From where the camera looks, and how the picture is framed.
void add_view_angles(CLI::App& app, CameraSpec& camera) {
  auto* eye = app.get_option("--eye");
  const auto number = [&app](const char* flag, const char* value, const char* help, std::optional<double>& target) {
    return add(app, {flag, value, help, kCamera}, [&target, flag](const std::string& text) { target = parse_number(flag, text); });
  };
  number("--azimuth", "DEG", "looks from so far round --up: 0 from the front (+z; where z is up -y), 90 from the right; default 38.7",
         camera.azimuth_deg)
      ->excludes(eye);
  add(app, {"--elevation", "DEG", "looks from so far above the horizon, -90 to 90; default 25.1", kCamera},
      [&camera](const std::string& text) {
        camera.elevation_deg = parse_number("--elevation", text);
        if (std::abs(*camera.elevation_deg) > 90.0) throw InputError({"", "--elevation", text, "out of range", "-90 to 90 degrees"});
      })
      ->excludes(eye);
  number("--roll", "DEG", "the picture turns clockwise; default 0", camera.roll_deg);
  number("--zoom", "FACTOR", "the picture enlarged about its middle, above 0; default 1", camera.zoom);
  number("--margin", "SHARE", "of the picture left free on each side of what is framed, 0 to below 0.5; default 0.07", camera.margin)
      ->excludes(eye);
}

}  // namespace

void add_camera(CLI::App& app, Options& options, bool with_views, const std::string& default_size) {
  const std::string size_help = "picture in pixels, 1..16384 each; default " + default_size;
  add(app, {"--size", "WxH", size_help.c_str(), kCamera},
      [&options](const std::string& text) { options.spec.camera.size_px = parse_size("--size", text); });
  add(app, {"--eye", "X,Y,Z", "where the camera stands, world units; default: framed", kCamera},
      [&options](const std::string& text) { options.spec.camera.eye = parse_vector3("--eye", text); });
  add(app, {"--target", "X,Y,Z", "what it looks at, world units; default: the middle of what is drawn", kCamera},
      [&options](const std::string& text) { options.spec.camera.target = parse_vector3("--target", text); });
  add(app, {"--up", "X,Y,Z", "what is up in the picture: a direction, or an axis such as z or -y; default y", kCamera},
      [&options](const std::string& text) { options.spec.camera.up = parse_direction("--up", text); });
  auto* fov = add(app, {"--fov", "DEG", "vertical field of view, degrees, above 0 and below 180; default 35", kCamera},
                  [&options](const std::string& text) { options.spec.camera.fov_deg = parse_number("--fov", text); });
  auto* ortho = add(app, {"--ortho", "HEIGHT", "orthographic, the picture's height in world units; default: perspective", kCamera},
                    [&options](const std::string& text) { options.spec.camera.ortho_height = parse_number("--ortho", text); });
  fov->excludes(ortho);
  add_view_angles(app, options.spec.camera);
  if (!with_views) return;
  add(app, {"--views", "N", "N pictures from directions spread evenly on the sphere, 1..10000; default 1: the camera's own", kCamera},
      [&options](const std::string& text) { options.spec.views = parse_integer("--views", text, 1, 10'000); });
}

void add_turntable(CLI::App& app, Options& options) {
  add(app, {"--turntable", "N", "N pictures, 2..10000, while the camera goes once round about --up; they share one size", kCamera},
      [&options](const std::string& text) { options.turntable = parse_integer("--turntable", text, 2, 10'000); })
      ->excludes(app.get_option("--views"))
      ->excludes(app.get_option("--frames"));
  auto* turntable = app.get_option("--turntable");
  app.add_flag("--animate", options.animate, "one picture that plays all frames instead of a file a frame: .png; an .apng always does")
      ->group(kCamera)
      ->needs(turntable);
  add(app, {"--fps", "N", "frames a second of such a picture, above 0 up to 100; default 24", kCamera},
      [&options](const std::string& text) {
        options.lines.frames_per_second = parse_number_above("--fps", text, 0.0, false, "above 0 and up to 100 frames a second");
        if (options.lines.frames_per_second > 100.0)
          throw InputError({"", "--fps", text, "out of range", "above 0 and up to 100 frames a second"});
      })
      ->needs(turntable);
}

void add_frames(CLI::App& app, Options& options, const char* help) {
  auto* frames = add(app, {"--frames", "N", help, kCamera},
                     [&options](const std::string& text) { options.frames.frames = parse_integer("--frames", text, 1, 10'000); });
  frames->excludes(app.get_option("--views"));
  add(app, {"--path-step", "PX", "how far the picture moves from frame to frame, pixels, above 0 up to 1; default 0.1", kCamera},
      [&options](const std::string& text) {
        const char* const right = "above 0 and up to 1 pixel";
        options.frames.step_px = parse_number_above("--path-step", text, 0.0, false, right);
        if (options.frames.step_px > 1.0) throw InputError({"", "--path-step", text, "out of range", right});
      })
      ->needs(frames);
  add(app, {"--seed", "N", "random seed of the camera path, 0..2147483647; default 1", kCamera}, [&options](const std::string& text) {
    options.frames.seed = static_cast<std::uint64_t>(parse_integer("--seed", text, 0, std::numeric_limits<int>::max()));
  })->needs(frames);
}

}  // namespace limn
