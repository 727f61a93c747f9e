#pragma once
// What an experiment is asked to do, without a command line: models x views x methods of one input. What is unset is the scene file's or
// the library's to choose.

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "raymarch/truth.h"
#include "sdf/descriptor.h"
#include "subdiv/refine.h"

namespace limn {

/// How an object is modelled.
struct SurfaceSpec {
  std::optional<std::string> kind{};          ///< Representation (limn list surfaces).
  std::optional<int> voxels{};                ///< Along the longest side.
  std::optional<double> voxel_size{};         ///< World; instead of `voxels`.
  std::optional<double> half_width_voxels{};  ///< Of the narrow band.
  std::optional<std::string> gradient{};      ///< How normals of level sets are computed (limn list gradients).
  std::optional<int> level{};                 ///< Subdivision or tessellation level, 0..8.
  bool level_for_view = false;                ///< As fine as the picture shows; `level` is unset then.
  std::optional<Scheme> scheme{};             ///< Makes a cage of a mesh.
  std::optional<NormalKind> normals{};        ///< Of meshes.
  std::optional<double> smooth_angle_deg{};   ///< Of meshes drawn as they are.
};

/// The camera, where it is not the scene's own.
struct CameraSpec {
  std::optional<glm::ivec2> size_px{};   ///< Width and height of the picture.
  std::optional<glm::dvec3> eye{},       ///< World.
      target{},                          ///< World: what the camera looks at.
      up{};                              ///< World: what is up in the picture.
  std::optional<double> fov_deg{};       ///< Vertical; makes the camera a pinhole.
  std::optional<double> ortho_height{};  ///< World; makes it orthographic.
  std::optional<double> azimuth_deg{},   ///< Where the camera looks from, about `up`: 0 from the front, growing towards the right.
      elevation_deg{},                   ///< Above the horizon.
      roll_deg{},                        ///< The picture turns clockwise.
      zoom{},                            ///< The picture enlarged about its middle.
      margin{};                          ///< Share of the picture left free on each side.

  bool turns() const { return azimuth_deg || elevation_deg; }  ///< True where the call says from where to look, without an eye.
  bool is_set() const {
    return eye || target || up || fov_deg || ortho_height || turns() || roll_deg || zoom || margin;
  }  ///< True where anything but the size is set.
};

/// A value for a parameter of methods.
struct ParameterSetting {
  std::string key{};       ///< "threshold" for every method that has it, or "rim.threshold".
  ParameterInput value{};  ///< {{0.4}} for a number.
};

/// Outline methods and their parameters.
struct BorderSpec {
  std::vector<std::string> methods{};          ///< Of one picture, in order.
  std::vector<std::string> columns{};          ///< Each makes pictures of its own; instead of `methods`.
  std::vector<ParameterSetting> parameters{};  ///< Over the scene file's, in order.
  int samples = 1;                             ///< Rays a pixel.
  std::optional<std::string> look{};           ///< Name of a look: methods, shading and background that nobody else names.
  std::optional<std::string> shading{};        ///< Name of a shading.
  std::optional<glm::dvec3> background{};      ///< Linear.
};

/// What a call may take.
struct LimitSpec {
  std::optional<std::int64_t> max_memory{};  ///< Bytes, of the whole program.
  std::optional<double> max_time_ms{};       ///< Of the whole call.
};

/// One input, the models and methods to draw it by, from where, and within which limits.
struct ExperimentSpec {
  std::string input{};                  ///< A file or the name of a built-in scene.
  std::vector<std::string> grids{};     ///< Of a volume, by name; "all" for all of its level sets.
  std::vector<std::string> surfaces{};  ///< Representations; empty: the experiment's own choice.
  SurfaceSpec surface{};                ///< How the models are built.
  CameraSpec camera{};                  ///< Over the scene's.
  int views = 1;                        ///< Directions spread over the sphere; 1: the camera's own.
  BorderSpec border{};                  ///< What is drawn.
  /// What the true border of meshes and volumes is asked of; unset: given.
  std::optional<TruthReference> reference{};
  LimitSpec limits{};  ///< Beyond them the call fails.
  int threads = 0;     ///< 0: all.
};

/// The axes of a study. Empty: the study's own choice.
struct SweepSpec {
  std::vector<int> levels{},                      ///< Of meshes; rising.
      voxels{};                                   ///< Along the longest side of level sets; rising.
  std::vector<NormalKind> normals{};              ///< Of meshes.
  std::vector<std::string> gradients{};           ///< Of level sets.
  std::vector<double> thresholds{};               ///< Of every method that has one; rising.
  std::vector<double> local_px{};                 ///< Tolerances of local meshes, px, above 0; rising. Empty: there are none.
  std::optional<int> views{};                     ///< Directions spread over the sphere; ExperimentSpec::views is not read.
  bool flicker = false;                           ///< Measures flicker, too: a moving camera (kFlickerPath).
  std::optional<std::int64_t> max_model_bytes{};  ///< Larger models are left out.
};

/// A study: an experiment over several resolutions.
struct StudySpec {
  ExperimentSpec experiment{};  ///< What is studied.
  SweepSpec sweep{};            ///< Which models of it.
};

/// A search for the cheapest model that is right to a tolerance.
struct PlanSpec {
  std::optional<double> tolerance_px{};        ///< Above 0.
  bool silhouette = false;                     ///< Only it has to be right.
  std::optional<double> budget_ms{};           ///< Of building and tracing one picture.
  std::optional<std::int64_t> budget_bytes{};  ///< Of the model.
};

}  // namespace limn
