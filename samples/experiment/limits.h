#pragma once
// Limits of memory and time: what a call is expected to take, refused before it starts where that is too much, and held to while it runs.

#include <string>
#include <vector>

#include "raymarch/picture.h"
#include "samples/spec/spec.h"

namespace limn {

/// What the program takes before it does anything; the library of pictures (OpenImageIO), which comes when a .tif or .jpg is written;
/// and that of volumes (OpenVDB), which comes when a volume is read or written.
inline constexpr double kProgramBytes = 18e6, kPictureLibraryBytes = 125e6, kVolumeLibraryBytes = 40e6;

/// What the machine lets a program have: its memory, or less where a control group says so. Bytes.
double machine_memory();

/// What a call draws, beside the surfaces.
struct PictureLoad {
  double pixels = 0.0;           ///< Of one picture.
  double bytes_per_pixel = 0.0;  ///< Held at a time.
  double pictures = 0.0;         ///< Traced: views times samples.
  double other_ms = 0.0;         ///< Methods, writing.
  double library_bytes = 0.0;    ///< kPictureLibraryBytes where a .tif or .jpg is written.
};
/// Pictures drawn one after the other.
struct PlannedPictures {
  int views = 1;
  bool writes_layers = false;  ///< As .exr files.
  bool is_sequence = false;    ///< The reference is drawn, too, and both are followed from frame to frame.
};
PictureLoad picture_load(const Camera& camera, const PictureSettings& picture, const PlannedPictures& planned);

/// What a call is expected to take: mostly right to a factor of two, for time on a machine like that of the constants.
struct CallCost {
  double model_bytes = 0.0, picture_bytes = 0.0, library_bytes = 0.0, time_ms = 0.0;
  double bytes() const { return kProgramBytes + library_bytes + model_bytes + picture_bytes; }
};
/// `with_cages` and `cache` as in size_of (samples/experiment/cost.h).
CallCost expected_call(const Scene& scene, const SurfaceSettings& settings, const PictureLoad& load, bool with_cages = true,
                       ObjectMeshCache* cache = nullptr);

/// What a call models.
struct PlannedModels {
  std::vector<std::string> kinds{};   ///< Representations that are modelled one after the other; empty: settings.kind.
  ObjectMeshCache* meshes = nullptr;  ///< What is found to tell what they take stays there for build_model. Null: it goes.
  bool always = false;                ///< What is expected is told, however little it is.
};

/// Largest model that may be built beside the program and `other_bytes` (libraries, pictures), bytes; SurfaceSettings::max_bytes.
std::int64_t model_bytes_left(const LimitSpec& limits, double other_bytes);

/// Throws InputError where the call is expected to take more than its limits or the machine's memory allow (twice the time), with what
/// would take less. Returns what is expected; nothing where that is little and there is no limit, unless `models.always`.
std::optional<CallCost> check_limits(const LimitSpec& limits, const Scene& scene, const SurfaceSettings& settings, const PictureLoad& load,
                                     const PlannedModels& models = {});

/// Holds the process to its limits from here on. Memory: what it may allocate is limited, and where that runs out it ends
/// with one line and exit code 1 (`goes_on`: std::bad_alloc is thrown instead). Throws InputError for less memory than it has already.
void hold_limits(const LimitSpec& limits, bool goes_on);

}  // namespace limn
