// While the camera trembles by parts of a pixel, ink flips no more than the truth's does.

#include "raymarch/frames.h"
#include "raymarch/metric/flips.h"
#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"
#include "sdf/error.h"

namespace limn {
namespace {

/// One model's frames, as they come.
struct Film {
  const SceneModel& model;
  const Scene& scene;
  const MethodCall& method;
  bool in_sequence;  ///< False: no frame knows the one before.
  GBuffer seen{};
  Camera camera{};
  Border border{};
  Image<std::int32_t> before{};

  void next(const Camera& to, const ExecutionSettings& how) {
    GBuffer now = render_gbuffer(model, to, how);
    before = seen.id.pixels.empty() ? Image<std::int32_t>() : pixels_before(now, to, seen, camera);
    const BorderBefore then{border.coverage, before};
    const bool knows = in_sequence && !before.pixels.empty();
    Border drawn = method.method->draw({now, to, model, scene, knows ? &then : nullptr}, method.parameters);
    border = std::move(drawn);
    seen = std::move(now);
    camera = to;
  }
};

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  const StabilityStage& stage = context.stage();
  const Scene& truth_scene = context.truth_scene();
  SurfaceSettings natural;
  natural.kind.clear();  // each object as it is by itself
  const SceneModel truth = build_model(truth_scene, natural);
  if (const std::string reason = method->method->unsupported(truth, truth_scene); !reason.empty()) {
    throw InputError({"", "method", method->method->about.name, "cannot draw the truth: " + reason, ""});
  }
  StabilityRandom random = context.random();
  Worst worst;
  for (const StabilityView& view : context.views()) {
    const FramePath path{
        .frames = with.integer("frames"), .step_px = with.number("step"), .seed = static_cast<std::uint64_t>(random.next() * 0x1p53)};
    Film own{stage.model, stage.scene, *method, true}, reference{truth, truth_scene, *method, false};
    FlipHistory history;
    FrameFlips sum;
    int worst_frame = 0;
    std::int64_t most = 0;
    int frame = 0;
    for (const Camera& camera : path_cameras(view.camera, bounds(truth_scene), path)) {
      own.next(camera, context.how());
      reference.next(camera, context.how());
      const FrameFlips flips = count_flips({own.border.coverage, own.before}, {reference.border.coverage, reference.before}, history);
      sum.flips += flips.flips;
      sum.reference_flips += flips.reference_flips;
      sum.beyond += flips.beyond;
      sum.border += flips.border;
      if (flips.beyond > most) most = flips.beyond, worst_frame = frame;
      ++frame;
    }
    const double index = sum.border > 0 ? static_cast<double>(sum.beyond) / static_cast<double>(sum.border) : 0.0;
    worst.see(index,
              fmt::format("{} flips over {} frames {:g} px apart, {} of the truth, {} beyond it, most in frame {} ({})", sum.flips,
                          path.frames, path.step_px, sum.reference_flips, sum.beyond, worst_frame, most),
              stage, view, &own.border);
  }
  return worst.take();
}

}  // namespace

StabilityCheck flips_beyond_check() {
  return {{"flips_beyond", "flicker index: flips that are not the truth's, for each pixel of its border and frame of a trembling camera",
           "limn"},
          "flips a border pixel",
          true,
          {stability_whole("frames", 8, 2, 1000, "of the path"),
           stability_number("step", 0.15, "px", "that the picture moves from frame to frame, above 0 up to 1")},
          run};
}

}  // namespace limn
