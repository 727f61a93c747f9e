#include "raymarch/measured_border.h"

#include "raymarch/measured_border/between_crossings.h"
#include "raymarch/measured_border/join_necks.h"
#include "sdf/error.h"

namespace limn {

BorderCurves measure_border(const SceneModel& model, const Camera& camera, const GBuffer& gbuffer, const MeasuredBorderSettings& settings,
                            const ExecutionSettings& how) {
  LIMN_CHECK(settings.threshold >= 0.0 && settings.threshold < 1.0 && settings.precision_px > 0.0);
  LIMN_CHECK(gbuffer.width == camera.width_px && gbuffer.height == camera.height_px);
  prepare_points(model);
  BorderCrossings found = find_crossings(model, camera, gbuffer, settings, how);
  const ChainedCurves pieces = chain_crossings(model, camera, gbuffer, settings.threshold, found.crossings, found.rays);
  const ChainedCurves chains = join_necks(model, camera, settings.threshold, pieces, found.rays);
  return refine_chains(model, camera, settings, chains, how, found.rays);
}

}  // namespace limn
