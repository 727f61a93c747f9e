#pragma once
// The outline seam: a method is a pure function of what is seen. One file in raymarch/border/ and one line in its registry.

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <utility>

#include "raymarch/gbuffer.h"
#include "sdf/registry.h"

namespace limn {

/// The frame before, for methods that hold on to what they drew there.
struct BorderBefore {
  const Image<float>& coverage;       ///< The same method's.
  const Image<std::int32_t>& pixels;  ///< pixels_before() (raymarch/frames.h).
};

/// Which of two groups of objects that meet in the picture is in front.
struct GroupOrder {
  std::int64_t places = 0;      ///< Pairs of neighbouring pixels.
  double lower_in_front = 0.0;  ///< Those where the group with the lower key is clearly in front, less those where the other is.
};
using GroupOrders = std::map<std::pair<std::int32_t, std::int32_t>, GroupOrder>;  ///< By their keys (ids or materials), lower first.
struct SharedLines;      // raymarch/border/contours.cpp: the lines of what is seen, solved once
struct SharedExtrusion;  // raymarch/border/extrude.h: an object grown
/// What all samples and methods that see one model from one eye share; who needs it first fills it in.
struct SharedFindings {
  std::shared_ptr<const GroupOrders> of_objects{},                   ///< Keys are ids; null until somebody needs them.
      of_materials{};                                                ///< Keys are materials; null until somebody needs them.
  std::vector<std::shared_ptr<const SharedLines>> lines{};           ///< One for each settings that a method asked with.
  std::vector<std::shared_ptr<const SharedExtrusion>> extrusions{};  ///< One for each object and settings that a method asked with.
};

/// Everything a method may read. Plain references; a method keeps none of them.
struct BorderInput {
  const GBuffer& gbuffer;                ///< With the layers that BorderMethod::inputs names.
  const Camera& camera;                  ///< That the G-buffer was seen by.
  const SceneModel& model;               ///< What the G-buffer shows.
  const Scene& scene;                    ///< What the model was made from.
  const BorderBefore* before = nullptr;  ///< Null where there is no frame before.
  SharedFindings* shared = nullptr;      ///< Null: found anew for each call.
  bool with_notes = true;                ///< False where nobody reads Border::notes: of a picture's samples after the first.
};

/// Ink of one method. `coverage` in [0, 1], finite, the G-buffer's size.
struct Border {
  Image<float> coverage{};           ///< 0 no ink, 1 all ink.
  glm::vec3 color{0.0f};             ///< Linear.
  Image<glm::vec3> colors{};         ///< Linear ink colour of each pixel, where a method inks in more than one; empty: `color` everywhere.
  Image<std::uint8_t> status{};      ///< Non-zero where the method is undefined and what it drew is clamped; empty where it never is.
  std::vector<std::string> notes{};  ///< What failed here, in words with numbers; empty where nothing did.
  /// Where the ink's edge runs along an object between the pixels: the index of the pixel whose object fills the share of this one that
  /// the ink leaves free. -1: what the pixel itself shows does. Empty: everywhere so.
  Image<std::int32_t> beneath{};
};

/// Coverage of pixels, any number of them, each from its own N.V and id (0: nothing is hit, no ink). Sizes equal; called from many threads
/// at a time.
using PixelInk = std::function<void(std::span<const float> n_dot_v, std::span<const std::int32_t> id, std::span<float> coverage)>;

/// An outline method: a file in raymarch/border/ and a line in its registry.
struct BorderMethod {
  Description about{};                  ///< Name, help and source.
  std::vector<std::string> inputs{};    ///< Layers it reads (Z, P, N, NdotV, id, material, face, custom) and "mesh" where it needs one.
  std::vector<Parameter> parameters{};  ///< What `draw` reads, in the order of help.
  /// Empty where it can run on the model, else the reason why not.
  std::string (*unsupported)(const SceneModel& model, const Scene& scene);
  /// Draws. Called once for each picture or sample; throws InputError where the model turns out not to be drawable.
  Border (*draw)(const BorderInput& input, const Parameters& parameters);
  /// The number whose level curve N.V = number ends the ink, so that the ink's place can be measured against the truth. Null where the ink
  /// ends elsewhere: of what such a method draws only the model's silhouette has a truth.
  double (*truth_threshold)(const Parameters& parameters) = nullptr;
  std::vector<std::string>
      only_for_notes{};  ///< Of `inputs`, what only its notes read: not traced where there are none (BorderInput::with_notes).
  /// What a pixel-wise method draws where there is no frame before: pictures ink each tile as soon as it is traced. Its ink has one colour,
  /// and its notes are surface_notes(). Null where a method looks at more than a pixel's N.V and id.
  PixelInk (*pixel_ink)(const Parameters& parameters) = nullptr;
};

/// The method that draws where nobody names one.
inline constexpr const char* kDefaultMethod = "rim";

/// All outline methods, in the order of raymarch/border/all_methods.cpp.
const Registry<BorderMethod>& border_methods();
/// Throws InputError naming the nearest known method. `file` and `field` go into the message.
inline const BorderMethod& find_border_method(const std::string& name, const std::string& file = {}, const std::string& field = {}) {
  return border_methods().find(name, file, field);
}

}  // namespace limn
