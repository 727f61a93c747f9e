#pragma once
// From a scene model to a finished picture: G-buffer, border, composite.

#include "raymarch/border.h"
#include "raymarch/shading.h"

namespace limn {

struct Mattes;  // raymarch/mattes.h: which objects and materials cover each pixel, and by how much

/// A finished picture and what it was made from.
struct Picture {
  GBuffer gbuffer{};  ///< Of the pixel centres.
  /// Ink coverage in [0, 1]: mean over the samples; all methods together. With PictureColors::bytes only of a sequence.
  Image<float> border{};
  Image<std::uint8_t> border_status{};     ///< Border::status of the methods at the pixel centres, the largest; empty where none has one.
  Image<glm::vec4> composite{};            ///< Linear, premultiplied RGBA. Only with PictureColors::linear.
  Image<glm::u8vec4> bytes{};              ///< The composite as PNG holds it: sRGB, alpha apart. Only with PictureColors::bytes.
  HitCounts counts{};                      ///< Of the pixel centres.
  std::shared_ptr<const Mattes> mattes{};  ///< Null where PictureSettings::mattes is false.
  std::vector<std::string> notes{};        ///< Of the methods.
  double trace_ms = 0.0,                   ///< For all samples.
      border_ms = 0.0;                     ///< For all methods and samples.
};

/// An outline method with its parameters.
struct MethodCall {
  const BorderMethod* method = nullptr;  ///< From border_methods(); not null when drawn.
  Parameters parameters{};               ///< From resolve(), for the method's own list.
};

/// What becomes of a picture's colours.
enum class PictureColors : std::uint8_t {
  linear,  ///< Picture::composite.
  bytes,   ///< Picture::bytes in place of composite and border, for who only writes a PNG.
  none     ///< Neither, for who reads the ink alone.
};

/// What a picture shows beside the scene: ink, background, layers.
struct PictureSettings {
  std::vector<MethodCall> methods{};      ///< Inks in order, the last on top.
  int samples = 1;                        ///< Per pixel, 1..1024: 1 is the centre; more follow the R2 sequence (Roberts 2018), centred.
  std::optional<glm::vec3> background{};  ///< Linear; unset: transparent.
  ShadingSettings shading{};              ///< Of what is beneath the inks.
  bool mattes = false;                    ///< Collects Picture::mattes from all samples.
  GBufferLayers layers{};                 ///< Of Picture::gbuffer. What the methods and the composite read may be there, too.
  PictureColors colors = PictureColors::linear;  ///< What Picture holds of them.
  bool hands_over_gbuffer = true;  ///< False, of a sequence: Picture::gbuffer is empty, and what the history keeps is not copied.
};

/// What these methods read, with or without what only their notes read.
GBufferLayers layers_read(std::span<const MethodCall> methods, bool with_notes = true);
/// What a composite reads: the shading's layers and the methods' inputs.
GBufferLayers layers_read(const PictureSettings& settings, bool with_notes = true);

/// What one frame leaves to the next. Empty before the first.
struct FrameHistory {
  /// One sample of the last frame.
  struct Sample {
    GBuffer gbuffer{};                 ///< Z, N and id, N.V of pixel-wise methods.
    std::vector<Image<float>> inks{};  ///< Of each method; none where no method holds on to them.
  };
  Camera camera{};                      ///< Of the last frame.
  std::vector<Sample> samples{};        ///< As many as PictureSettings::samples; the first alone where no method holds on to its ink.
  Image<std::int32_t> pixels_before{};  ///< Of the pixel centres, from the last frame to the one before it; empty after the first.
  GBuffer spare{};                      ///< Memory for the next frame.
};

/// With `history` the picture is the next of a sequence with the same model and settings, and becomes what the history holds.
/// Throws InputError where a method cannot run on the model.
Picture draw_picture(const Scene& scene, const SceneModel& model, const Camera& camera, const PictureSettings& settings,
                     const ExecutionSettings& how, FrameHistory* history = nullptr);

/// For several pictures from rays traced once: where in its pixel the ray of one of `samples` samples goes, the centre for sample 0. From 3
/// samples on their mean is the centre, so that nothing moves with their number.
glm::dvec2 sample_offset(int sample, int samples);
/// The methods' inks for one sample: of the frame before, and of this one.
struct SampleInks {
  std::vector<Image<float>> before{};   ///< Empty: there is none.
  Image<std::int32_t> pixels_before{};  ///< From this frame to the one before, as pixels_before() finds it; empty where there is none.
  std::vector<Image<float>> now{};      ///< One image for each method, in order.
};
/// Adds what the methods draw from one sample's G-buffer to the sums in `picture` (its own G-buffer stays as it is).
/// Throws InputError where a method finds that it cannot run on the model.
void add_sample(const BorderInput& input, std::span<const MethodCall> methods, Picture& picture, SampleInks* inks = nullptr,
                const ShadingSettings& shading = {});
/// Sums of `settings.samples` samples into means, over the background.
void finish_samples(const PictureSettings& settings, Picture& picture);

/// The object's colour under a light at the eye: color * (0.25 + 0.75 N.V), alpha 1 where something is hit.
Image<glm::vec4> shade_headlight(const GBuffer& gbuffer, const SceneModel& model);
/// The same with the colours that files give to their meshes.
Image<glm::vec4> shade_headlight(const BorderInput& input);
/// Lays ink over a premultiplied picture: mix(picture, ink, coverage).
void lay_ink(Image<glm::vec4>& picture, const Image<float>& coverage, const glm::vec3& color);
/// A method's border: in its colour, or in its colours where it has more than one; over what is beneath it.
void lay_ink(Image<glm::vec4>& picture, const Border& border);

}  // namespace limn
