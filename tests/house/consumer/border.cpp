// A border drawn and measured in ten lines: an egg as a formula, its level set against the truth.
#include <raymarch/raymarch.h>

#include <cstdio>

int main() {
  limn::Scene scene;
  scene.objects.push_back({.name = "egg", .source = limn::field_from_formula([](auto x, auto y, auto z) {
                                            return sqrt(x * x + y * y + z * z) + 0.2 * y - 1.0;
                                          })});
  const limn::SceneModel model = limn::build_model(scene, {.kind = "level_set", .voxels = 128});
  const limn::Camera camera = limn::resolve_camera({.width_px = 320, .height_px = 240}, limn::bounds(scene));
  const limn::Picture picture = limn::draw_picture(scene, model, camera, {}, {});
  const limn::BorderTruth truth = limn::solve_truth(scene, camera, {}, {});
  const limn::BorderCurves curves = limn::measure_border(model, camera, picture.gbuffer, {}, {});
  double rms_px = 1e9;
  for (const limn::MetricValue& value : limn::find_metric("inner_displacement").measure({picture, picture, camera, &curves, &truth})) {
    std::printf("%s %g %s\n", value.name.c_str(), value.value, value.unit.c_str());
    if (value.name == "inner_displacement_rms") rms_px = value.value;
  }
  return rms_px < 0.5 ? 0 : 1;
}
