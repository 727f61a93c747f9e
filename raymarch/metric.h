#pragma once
// Numbers that say how far a picture is from a reference. One file in raymarch/metric/ and one line in its registry.

#include "raymarch/picture.h"
#include "raymarch/truth.h"
#include "sdf/registry.h"

namespace limn {

/// What a metric looks at. One that finds its subject missing measures nothing: NaN.
enum class MetricSubject {
  gbuffer,  ///< `picture` and `reference`, their G-buffers: the same for every outline method.
  ink,      ///< `picture` and `reference`, their ink.
  curves,   ///< `curves` and `truth`.
  motion,   ///< `moved` and `reference_moved`.
};

struct MetricInput {
  const Picture& picture;
  const Picture& reference;  ///< Same camera and size.
  const Camera& camera;
  const BorderCurves* curves = nullptr;  ///< The model's border (raymarch/measured_border.h).
  const BorderTruth* truth = nullptr;    ///< Same camera and threshold.
  /// Ink while the camera moves by parts of a pixel, one picture a frame; the same frames for both.
  std::span<const Image<float>> moved{};
  std::span<const Image<float>> reference_moved{};
  /// pixels_before() of each frame but the first (raymarch/frames.h). Empty: each pixel is what it was.
  std::span<const Image<std::int32_t>> moved_before{};
  std::span<const Image<std::int32_t>> reference_moved_before{};
  const SceneModel* model = nullptr;  ///< What `curves` were measured on; `prediction` asks it for its normals.
};

struct MetricValue {
  std::string name{};  ///< "normal_error_mean"
  double value = 0.0;  ///< NaN where there is nothing to measure.
  std::string unit{};  ///< "px", "deg", "" for a share, a ratio or a count
};

struct Metric {
  Description about{};
  std::vector<std::string> values{};  ///< Names of the values it yields, with units: "normal_error_mean [deg]".
  bool lower_is_better = true;
  std::vector<MetricValue> (*measure)(const MetricInput& input);
  MetricSubject subject = MetricSubject::gbuffer;
  bool any_threshold = false;  ///< Of curves: the same whatever N.V the truth's inner border lies at.
};

const Registry<Metric>& metrics();
inline const Metric& find_metric(const std::string& name, const std::string& file = {}, const std::string& field = {}) {
  return metrics().find(name, file, field);
}

/// Where two borders differ: missing in blue, false in red, common in grey, on white; linear RGBA.
Image<glm::vec4> difference_picture(const Image<float>& border, const Image<float>& reference);

}  // namespace limn
