// Another project's experiment, without a command line: the cheapest level set of an ellipsoid whose border is right to a pixel.
#include <samples/plan/plan_job.h>

#include <cstdio>

int main() {
  limn::ExperimentSpec spec{.input = "ellipsoid", .surfaces = {"level_set"}};
  spec.camera.size_px = glm::ivec2(160, 120);
  const limn::SceneInput input = limn::load_input(spec);
  limn::ProgressBar bar(false);
  const limn::PlanJob job = limn::plan_for(spec, {.tolerance_px = 1.0}, input, bar);
  if (!job.answer.chosen) return 1;
  const limn::PlanTrial& chosen = job.answer.trials[*job.answer.chosen];
  std::printf("%s: %.3g px\n", job.answer.all_series[chosen.series].words_at(chosen.candidate).c_str(), chosen.measured.inner_px);
  return chosen.measured.inner_px <= 1.0 ? 0 : 1;
}
