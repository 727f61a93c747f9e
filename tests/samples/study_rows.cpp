#include "tests/samples/study_rows.h"

#include <fmt/format.h>

#include <cmath>
#include <random>
#include <set>

#include "raymarch/image_io.h"

namespace limn::test {
namespace {

struct Law {
  const char* surface;
  const char* parameter;
  const char* value;
  double factor, order;
};
// Of the inner border's displacement in px at a resolution of 1.
constexpr Law kLaws[] = {{"mesh", "normals", "flat", 90.0, 1.0},           {"mesh", "normals", "vertex", 160.0, 1.5},
                         {"mesh", "normals", "limit", 300.0, 2.0},         {"level_set", "gradient", "cell", 40.0, 1.0},
                         {"level_set", "gradient", "central", 220.0, 2.0}, {"level_set", "gradient", "cubic", 150.0, 2.0}};

void add_cell(SyntheticStudy& study, StudyRow row, double inner, double silhouette) {
  const double kr_scale = 14.0;  // px for a degree
  const std::pair<const char*, double> values[] = {{"hausdorff_max", 4.0 * inner},
                                                   {"inner_displacement_mean", -0.3 * inner},
                                                   {"inner_displacement_rms", inner},
                                                   {"silhouette_displacement_rms", silhouette},
                                                   {"prediction_displacement_rms", inner * (1.0 + 0.05 * std::sin(10.0 * inner))},
                                                   {"hausdorff", 3.0 * inner}};
  for (const auto& [name, value] : values) {
    row.metric = name;
    row.value = value;
    row.unit = "px";
    study.rows.push_back(row);
  }
  row.metric = "prediction_normal_error_rms";
  row.value = inner / kr_scale;
  row.unit = "deg";
  study.rows.push_back(row);
}

}  // namespace

double synthetic_order(const std::string& series) {
  for (const Law& law : kLaws) {
    StudyRow row;
    row.surface = law.surface;
    row.surface_parameters = {{law.parameter, law.value}};
    if (series_of(row) == series) return law.order;
  }
  return 0.0;
}

SyntheticStudy synthetic_study(const SyntheticSettings& settings) {
  SyntheticStudy study;
  std::mt19937 random(settings.seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  study.head = {.id = "synthetic",
                .input = "egg.toml",
                .scene = "egg",
                .call = "limn study egg.toml --views 12",
                .truth = "the field itself, within 0.005 px"};
  study.head.views = settings.views;
  for (const Law& law : kLaws) {
    for (int step = 0; step < 7; ++step) {
      const bool mesh = std::string(law.surface) == "mesh";
      const int voxels = 16 << step;
      StudyRow row;
      row.scene = "egg";
      row.surface = law.surface;
      row.surface_parameters = {{law.parameter, law.value},
                                mesh ? std::pair<const std::string, std::string>{"level", std::to_string(step)}
                                     : std::pair<const std::string, std::string>{"voxels", std::to_string(voxels)}};
      row.resolution = mesh ? 0.3 * std::pow(0.5, step) : 1.0 / voxels;
      row.bytes =
          mesh ? static_cast<std::int64_t>(2000.0 * std::pow(4.0, step)) : static_cast<std::int64_t>(600.0 * voxels * voxels / 16.0);
      row.build = timing_of({mesh ? 0.4 * std::pow(3.6, step) : 0.02 * std::pow(voxels, 1.5)});
      row.method = "rim";
      for (const double threshold : settings.thresholds) {
        row.method_parameters = {{"threshold", fmt::format("{}", threshold)}};
        for (int view = 0; view < settings.views; ++view) {
          row.view = view;
          row.key = fmt::format("{}-{}-{}-{}-{}", law.surface, law.value, step, threshold, view);
          row.trace = timing_of({30.0 + 2.0 * step + 0.5 * view});
          row.border_ms = 4.0;
          ++study.head.cells;
          if (settings.with_failures && std::string(law.value) == "cubic" && step == 6) {
            StudyRow failed = row;
            failed.failed = "it would take about 6.2 GB, which is more than --max-memory 4.0 GB";
            failed.bytes = 0;
            failed.build = failed.trace = {};
            failed.border_ms = 0.0;
            study.rows.push_back(failed);
            continue;
          }
          const double scatter = std::exp(settings.scatter * normal(random));
          add_cell(study, row, law.factor * std::pow(row.resolution, law.order) * threshold / 0.4 * scatter,
                   60.0 * row.resolution * row.resolution * scatter);
        }
      }
    }
  }
  return study;
}

void write_synthetic_thumbnails(const std::vector<StudyRow>& rows, const std::filesystem::path& folder) {
  std::set<std::string> done;
  for (const StudyRow& row : rows) {
    if (row.metric != "inner_displacement_rms" || !done.insert(row.key).second) continue;
    Image<glm::vec4> picture(96, 72);
    const float shift = static_cast<float>(std::min(row.value, 12.0));
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        const float radius = std::hypot(static_cast<float>(x - 48), 1.3f * static_cast<float>(y - 36));
        const bool here = radius > 24.0f + shift && radius<36.0f, there = radius> 24.0f && radius < 36.0f + 0.5f * shift;
        picture.at(x, y) = here && there ? glm::vec4(0.4f, 0.4f, 0.4f, 1.0f)
                           : here        ? glm::vec4(0.85f, 0.03f, 0.02f, 1.0f)
                           : there       ? glm::vec4(0.02f, 0.1f, 0.85f, 1.0f)
                                         : glm::vec4(1.0f);
      }
    }
    write_image(picture, thumbnail_file(folder, row.key));
  }
}

}  // namespace limn::test
