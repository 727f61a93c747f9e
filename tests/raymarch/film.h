#pragma once
// Sequences of pictures from a camera that trembles: random shots of closed forms, and how often their ink flips.

#include "raymarch/frames.h"
#include "raymarch/metric/flips.h"
#include "tests/random_seed.h"
#include "tests/raymarch/image_buffers.h"

namespace limn::test {

inline constexpr double kThreshold = 0.4;

/// A closed form: the largest curvature anywhere on it bounds how fast N.V changes from pixel to pixel.
struct Smooth {
  std::string name;
  Field field;
  double largest_curvature;
};

inline std::vector<Smooth> smooth_shapes() {
  return {{"sphere", make_shape("sphere", {{"radius", {1.0}}}), 1.0},
          {"torus", make_shape("torus", {{"major", {1.0}}, {"minor", {0.35}}}), 1.0 / 0.35}};
}

inline std::uint64_t fresh_seed() { return random_seed(); }

/// A path with any step up to a quarter of a pixel, and any view.
struct Shot {
  Scene scene;
  std::vector<Camera> cameras;
  FramePath path;
};

inline Shot shot_of(const Field& field, Projection projection, std::mt19937_64& random, int size_px = 160, int frames = 8) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Shot shot;
  shot.scene = scene_of({object_of(field)});
  CameraSettings settings = view(size_px, size_px, projection);
  do {
    settings.direction = glm::dvec3(unit(random), unit(random), unit(random));
  } while (glm::length(*settings.direction) < 0.2);
  shot.path = {.frames = frames, .step_px = 0.03 + 0.11 * (unit(random) + 1.0), .seed = random()};
  shot.cameras = path_cameras(framing(shot.scene, settings), bounds(shot.scene), shot.path);
  return shot;
}

struct Frame {
  Picture picture;
  Image<std::int32_t> before;  ///< Empty for the first.
};

inline std::vector<Frame> film(const Shot& shot, const SceneModel& model, const MethodCall& call) {
  FrameHistory history;
  std::vector<Frame> frames;
  for (const Camera& camera : shot.cameras) {
    frames.push_back({draw_picture(shot.scene, model, camera, {{call}, 1, {}}, {}, &history), {}});
    frames.back().before = history.pixels_before;
  }
  return frames;
}

struct Flicker {
  std::int64_t flips = 0, reference_flips = 0, beyond = 0, worst = 0;
  size_t worst_frame = 0;
};

inline Flicker flicker_of(const std::vector<Frame>& own, const std::vector<Frame>& reference) {
  Flicker sum;
  FlipHistory history;
  for (size_t k = 0; k < own.size(); ++k) {
    const FrameFlips frame =
        count_flips({own[k].picture.border, own[k].before}, {reference[k].picture.border, reference[k].before}, history);
    sum.flips += frame.flips;
    sum.reference_flips += frame.reference_flips;
    sum.beyond += frame.beyond;
    if (frame.flips > sum.worst) sum.worst = frame.flips, sum.worst_frame = k;
  }
  return sum;
}

inline MethodCall rim(double hysteresis) { return call_of("rim", {{"threshold", value(kThreshold)}, {"hysteresis", value(hysteresis)}}); }

/// Largest difference in N.V between two films where both show the surface: what a model's normals and positions make of it.
inline double largest_difference(const std::vector<Frame>& a, const std::vector<Frame>& b) {
  double largest = 0.0;
  for (size_t k = 0; k < a.size(); ++k) {
    const GBuffer &one = a[k].picture.gbuffer, &other = b[k].picture.gbuffer;
    for (size_t i = 0; i < one.id.size(); ++i) {
      // Beyond the flips' reach lies the silhouette, where a pixel sees the surface or does not.
      if (one.id.pixels[i] == 0 || other.id.pixels[i] == 0 || std::abs(other.n_dot_v.pixels[i] - kThreshold) > 0.35) continue;
      largest = std::max(largest, std::abs(double{one.n_dot_v.pixels[i]} - double{other.n_dot_v.pixels[i]}));
    }
  }
  return largest;
}

}  // namespace limn::test
