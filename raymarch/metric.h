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

struct CurveFindings;  // raymarch/metric/curve_findings.h

/// Everything a metric may read. Plain references and pointers; what its subject does not need may be empty or null.
struct MetricInput {
  const Picture& picture;                ///< What is judged.
  const Picture& reference;              ///< Same camera and size.
  const Camera& camera;                  ///< Of both pictures.
  const BorderCurves* curves = nullptr;  ///< The model's border (raymarch/measured_border.h).
  const BorderTruth* truth = nullptr;    ///< Same camera and threshold.
  /// Ink of `picture` while the camera moves by parts of a pixel, one image a frame.
  std::span<const Image<float>> moved{};
  std::span<const Image<float>> reference_moved{};  ///< The same frames of `reference`.
  /// pixels_before() of each frame of `moved` but the first (raymarch/frames.h). Empty: each pixel is what it was.
  std::span<const Image<std::int32_t>> moved_before{};
  std::span<const Image<std::int32_t>> reference_moved_before{};  ///< The same of `reference_moved`.
  const SceneModel* model = nullptr;                              ///< What `curves` were measured on; `prediction` asks it for its normals.
  /// What metrics of the same `curves` and `truth` leave for each other. Null: each finds it anew. Used by one metric at a time.
  CurveFindings* findings = nullptr;
};

/// One number of a metric.
struct MetricValue {
  std::string name{};  ///< "normal_error_mean"
  double value = 0.0;  ///< NaN where there is nothing to measure.
  std::string unit{};  ///< "px", "deg", "" for a share, a ratio or a count
};

/// A metric: a file in raymarch/metric/ and a line in its registry.
struct Metric {
  Description about{};                ///< Name, help and source.
  std::vector<std::string> values{};  ///< Names of the values it yields, with units: "normal_error_mean [deg]".
  bool lower_is_better = true;        ///< Of all its values; where false, higher is better.
  /// The numbers, each with its unit; NaN where the subject is missing.
  std::vector<MetricValue> (*measure)(const MetricInput& input);
  MetricSubject subject = MetricSubject::gbuffer;  ///< What `measure` looks at.
  bool any_threshold = false;                      ///< Of curves: the same whatever N.V the truth's inner border lies at.
};

/// All metrics, in the order of raymarch/metric/all_metrics.cpp.
const Registry<Metric>& metrics();
/// Throws InputError naming the nearest known metric. `file` and `field` go into the message.
inline const Metric& find_metric(const std::string& name, const std::string& file = {}, const std::string& field = {}) {
  return metrics().find(name, file, field);
}

/// Where two borders differ: missing in blue, false in red, common in grey, on white; linear RGBA.
Image<glm::vec4> difference_picture(const Image<float>& border, const Image<float>& reference);

}  // namespace limn
