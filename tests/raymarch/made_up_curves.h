#pragma once
// Curves made up for what the certificate of lines goes by: their image, the sign of their curvature, and depths that grow along them.

#include <vector>

#include "raymarch/lines/invisibility.h"

namespace limn::test {

/// 100 by 100 px, ten px a unit; seen along -z.
inline Camera flat_view() {
  CameraSettings settings;
  settings.target = {0.0, 0.0, 0.0};
  settings.eye = {0.0, 0.0, 20.0};
  settings.projection = Projection::orthographic;
  settings.ortho_height = 10.0;
  settings.width_px = settings.height_px = 100;
  return resolve_camera(settings, {glm::dvec3(-5.0), glm::dvec3(5.0)});
}

/// A point of a curve, `px` right of and above the middle of the picture.
inline CurveSample sample_of(const Camera& camera, const glm::dvec2& px, double z, double radial_curvature) {
  CurveSample sample;
  sample.p = {0.1 * px.x, 0.1 * px.y, z};
  sample.high = sample.low = {0.0, 1.0, 0.0};
  sample.radial_curvature = radial_curvature;
  project_sample(camera, sample);
  return sample;
}

inline void add_way(const Camera& camera, const glm::dvec2& from, const glm::dvec2& to, int steps, double& z, double sign,
                    SurfaceCurve& curve) {
  for (int i = 0; i < steps; ++i) {
    curve.samples.push_back(sample_of(camera, glm::mix(from, to, (i + 0.5) / steps), z, sign));
    z -= 0.01;
  }
}

/// A curve that is known between its samples, where its polyline is the curve itself.
inline SurfaceCurve exact_curve(const Camera& camera, const std::vector<glm::dvec2>& px, const std::vector<double>& radial_curvatures) {
  SurfaceCurve curve;
  curve.smooth = true;
  double z = 2.0;
  for (size_t i = 0; i < px.size(); ++i, z -= 0.01) curve.samples.push_back(sample_of(camera, px[i], z, radial_curvatures[i]));
  for (CurveSample& sample : curve.samples) sample.more_on_left = 2;
  curve.between = [samples = curve.samples](size_t step, double share) {
    return glm::mix(samples[step].p, samples[std::min(step + 1, samples.size() - 1)].p, share);
  };
  return curve;
}

}  // namespace limn::test
