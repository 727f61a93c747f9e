#pragma once
// Internal: pictures whose methods are pixel-wise. Each tile is inked, shaded and added up by the thread that traced it, as long as it is
// in its cache; no layer goes through memory but those that somebody reads afterwards.

#include "raymarch/picture.h"

namespace limn {

/// True where draw_pixel_wise() draws such pictures, of models to which no file gives colours.
bool is_pixel_wise(const PictureSettings& settings);
bool is_pixel_wise(const SceneModel& model, const PictureSettings& settings);

/// Up to so many samples of a picture in bytes are added up tile by tile; more need its sums in memory, as each has lists of what tiles
/// see.
inline constexpr int kSamplesTogether = 8;

/// As draw_picture() does, the same bytes. `history`: null, or of methods that do not hold on to their ink.
Picture draw_pixel_wise(const Scene& scene, const SceneModel& model, const Camera& camera, const PictureSettings& settings,
                        const ExecutionSettings& how, FrameHistory* history);

}  // namespace limn
