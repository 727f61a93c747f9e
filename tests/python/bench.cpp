// How long pictures of 1920 x 1080 take in C++, for tests/python/bench.py to compare with the same from Python. Prints milliseconds of
// wall clock and of processor, a line a picture.

#include <ctime>

#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "raymarch/picture.h"
#include "samples/experiment/job.h"

int main(int argc, char** argv) {
  limn::ExperimentSpec spec;
  spec.input = argc > 1 ? argv[1] : "gyroid";
  spec.camera.size_px = glm::ivec2(1920, 1080);
  const int pictures = argc > 2 ? std::atoi(argv[2]) : 5;
  limn::SceneInput input = limn::load_input(spec);
  const limn::SceneModel model = limn::build_model(input.scene, limn::surface_settings(spec, input));
  const limn::Camera camera = limn::resolve_camera(limn::camera_settings(spec.camera, input), limn::bounds(input.scene));
  const limn::PictureSettings settings = limn::picture_settings(spec.border, input);
  for (int i = 0; i < pictures; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t before = std::clock();
    const limn::Picture picture = limn::draw_picture(input.scene, model, camera, settings, {});
    const double processor_ms = 1e3 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
    std::printf("%.3f %.3f\n", std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count(), processor_ms);
    if (picture.border.pixels.empty()) return 1;
  }
  return 0;
}
