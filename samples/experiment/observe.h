#pragma once
// One model in one view: its G-buffers, and what outline methods draw from them.

#include <functional>

#include "raymarch/frames.h"
#include "raymarch/picture.h"
#include "sdf/error.h"

namespace limn {

/// Times of the same work, done several times; all the same where it was done once. ms, wall clock.
struct Timing {
  double median_ms = 0.0,  ///< Of an even number the mean of the two in the middle.
      low_ms = 0.0,        ///< The least.
      high_ms = 0.0;       ///< The largest.
};
/// Of at least one time.
Timing timing_of(std::vector<double> times_ms);

/// A model from one camera, before any method.
struct Seen {
  Picture picture{};                          ///< G-buffer; its border is left empty, its composite is the shading where one was asked for.
  std::vector<GBuffer> moved{};               ///< Frames after the first, which is `picture`.
  std::vector<Camera> cameras{};              ///< Of them.
  std::vector<Image<std::int32_t>> before{};  ///< pixels_before() of them.
  Timing trace{};                             ///< Of the first.
  double all_ms = 0.0;                        ///< Of all frames.
};

/// Traces the pixel centres; with `path` every frame of it, the first from the camera itself, into the memory of `out`. Throws Cancelled.
Seen look(const SceneModel& model, const Scene& scene, const Camera& camera, const std::optional<FramePath>& path,
          const ExecutionSettings& how, GBuffer out = {});

/// Traces the first picture of what was seen again, for its time alone: until there are `repeats` times, or the new ones took `most_ms`.
void time_again(const SceneModel& model, const Camera& camera, int repeats, double most_ms, const ExecutionSettings& how, Seen& seen);

/// What a method draws on one model in one view.
struct Drawing {
  Picture picture{};                  ///< Without a G-buffer: border, its time and notes; composite where one was asked for.
  std::vector<Image<float>> moved{};  ///< Ink frame by frame, the first is the picture's again; empty without a path.
  std::string refused{};              ///< Why there is none.
};

/// Whether methods know the frame before: a reference must not, its flips are those of the border itself.
enum class Frames { in_sequence, each_alone };

/// One method's ink at the pixel centres, and of every frame that was seen.
Drawing draw(const MethodCall& call, const SceneModel& model, const Scene& scene, const Camera& camera, const Seen& seen, Frames frames);

/// A model in one view, and all methods' pictures of it.
struct DrawnView {
  Seen seen{};                      ///< Its picture's composite is the shading without ink.
  std::vector<Drawing> drawings{};  ///< One a method.
};
/// Called with a method's index before it draws a sample.
using BeforeMethod = std::function<void(size_t method)>;
/// Lines of models that are seen by one camera.
using LinesOfView = std::vector<std::shared_ptr<const SharedLines>>;
/// Several methods from rays that are traced once: means over the settings' samples, over the shaded model. A method that cannot draw says
/// why in its drawing. `lines` are those of other models, and get this one's: of what models have in common they are solved once. Throws
/// Cancelled.
DrawnView draw_all(std::span<const std::vector<MethodCall>> methods, const SceneModel& model, const Scene& scene, const Camera& camera,
                   const PictureSettings& settings, const ExecutionSettings& how, LinesOfView& lines,
                   const BeforeMethod& before_method = {});

/// What is wrong and what was expected, for a page or a row.
std::string reason_of(const InputError& error);

}  // namespace limn
