#pragma once
// How often a sequence's ink flips, beside the same frames of what the scene is.

#include <cstdint>
#include <string>
#include <vector>

#include "raymarch/frames.h"
#include "raymarch/metric/flips.h"
#include "raymarch/picture.h"
#include "samples/input/input.h"
#include "samples/output/output.h"

namespace limn {

/// Of a frame's pixels.
struct FlipPlaces {
  std::int64_t unseen = 0;                             ///< Their piece of surface was not in sight the frame before.
  double lowest_n_dot_v = 1.0, highest_n_dot_v = 0.0;  ///< Of those that flipped; lowest above highest where none did.
};

/// A sequence being watched: the reference, drawn by the same methods without hysteresis, and the counts so far.
struct FlickerWatch {
  FramePath path{};
  std::string reference_words{};
  std::string no_reference{};  ///< Why the methods cannot draw it; then only the sequence's own flips are counted.
  Scene scene{};
  SceneModel reference{};
  PictureSettings picture{};
  FrameHistory history{};
  FlipHistory flips{};
  struct Frame {
    FrameFlips counts{};
    FlipPlaces places{};
  };
  std::vector<Frame> frames{};
};

/// Builds the reference: what `limn compare` measures against.
FlickerWatch watch_flicker(const ExperimentSpec& spec, const FramePath& path, const SceneInput& input, const SurfaceSettings& surface);
/// Counts the next frame, drawn with `history`.
void watch_frame(const Picture& picture, const FrameHistory& history, const Camera& camera, const ExecutionSettings& how,
                 FlickerWatch& watch);
/// {frames, step_px, seed, reference, flips, reference_flips, beyond, flicker, worst_frame, per_frame: [...]}.
Json flicker_json(const FlickerWatch& watch);
std::string flicker_sentence(const FlickerWatch& watch);

}  // namespace limn
