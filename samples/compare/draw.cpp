#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "raymarch/image_io.h"
#include "samples/compare/comparison.h"
#include "samples/empty_picture.h"
#include "sdf/color.h"
#include "sdf/error.h"

namespace limn {
namespace {

std::string reason_of(const InputError& error) {
  const std::string& expected = error.fault().expected;
  return error.fault().problem + (expected.empty() ? "" : " (expected " + expected + ")");
}

// A gigabyte of float pictures becomes a quarter of it; the page and the sheet show eight bits anyway.
Image<glm::u8vec4> packed(const Image<glm::vec4>& picture) {
  Image<glm::u8vec4> out(picture.width, picture.height);
  const auto byte = [](float value) { return static_cast<std::uint8_t>(std::lround(255.0f * std::min(std::max(value, 0.0f), 1.0f))); };
  for (size_t i = 0; i < out.size(); ++i) {
    const glm::vec4& color = picture.pixels[i];
    const glm::vec3 rgb = color.a > 0.0f ? glm::vec3(color) / color.a : glm::vec3(0.0f);
    out.pixels[i] = {byte(srgb_from_linear(rgb.r)), byte(srgb_from_linear(rgb.g)), byte(srgb_from_linear(rgb.b)), byte(color.a)};
  }
  return out;
}

// Everything of one model that is held while its cells are drawn.
struct Drawn {
  Picture seen;                   ///< G-buffer, and the shading without ink.
  std::vector<Picture> pictures;  ///< One a method, without G-buffers; empty where the cell is skipped.
};

void skip_unsupported(const SceneModel& model, const Scene& scene, size_t row, Comparison& comparison) {
  for (size_t column = 0; column < comparison.methods.size(); ++column) {
    for (const MethodCall& call : comparison.methods[column].calls) {
      Cell& cell = comparison.at(row, column);
      if (cell.skipped.empty()) cell.skipped = call.method->unsupported(model, scene);
    }
  }
}

void add_samples(const SceneModel& model, const GBuffer& gbuffer, size_t row, SharedOrders& orders, Comparison& comparison, Drawn& drawn,
                 ProgressBar& bar) {
  const ComparedModel& modelled = comparison.models[row];
  for (size_t column = 0; column < comparison.methods.size(); ++column) {
    Cell& cell = comparison.at(row, column);
    if (!cell.skipped.empty()) continue;
    if (const auto progress = bar.stage("drawing " + comparison.methods[column].name + ", " + modelled.title))
      progress(static_cast<double>(column) / static_cast<double>(comparison.methods.size()));
    try {
      add_sample({gbuffer, comparison.camera, model, modelled.scene, nullptr, &orders}, comparison.methods[column].calls,
                 drawn.pictures[column]);
    } catch (const InputError& error) {
      cell.skipped = reason_of(error);
    }
  }
}

// Kept beyond the model only where a later one may want it: the reference's mesh is finer than any, and large.
bool is_mesh_needed_later(const Comparison& comparison, size_t row) {
  const auto is_meshed = [&](size_t of) { return comparison.models[of].surface.kind.starts_with("mesh"); };
  if (row == 0) return false;
  for (size_t later = row + 1; later < comparison.models.size(); ++later) {
    if (is_meshed(later)) return true;
  }
  return false;
}

Drawn draw_model(size_t row, Comparison& comparison, const ExecutionSettings& how, ObjectMeshCache& meshes, ProgressBar& bar) {
  ComparedModel& modelled = comparison.models[row];
  SurfaceSettings settings = modelled.surface;
  settings.progress = bar.stage("building " + modelled.title);
  const SceneModel model = build_model(modelled.scene, settings, row > 0 ? &meshes : nullptr);
  if (!is_mesh_needed_later(comparison, row)) meshes.kept.clear();
  modelled.info = total(model);
  skip_unsupported(model, modelled.scene, row, comparison);
  ExecutionSettings tracing = how;
  tracing.progress = bar.stage("tracing " + modelled.title);
  Drawn drawn;
  drawn.pictures.resize(comparison.methods.size());
  SharedOrders orders;
  for (int sample = 0; sample < comparison.picture.samples; ++sample) {
    const auto start = std::chrono::steady_clock::now();
    GBuffer gbuffer = render_gbuffer(model, comparison.camera, tracing, sample_offset(sample, comparison.picture.samples));
    modelled.trace_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    add_samples(model, gbuffer, row, orders, comparison, drawn, bar);
    add_sample({gbuffer, comparison.camera, model, modelled.scene}, {}, drawn.seen);
    if (how.cancelled && how.cancelled()) throw Cancelled{};
    if (sample == 0) drawn.seen.gbuffer = std::move(gbuffer);
  }
  if (const auto progress = bar.stage("measuring " + modelled.title)) progress(0.0);
  measure_against_truth(row, model, drawn.seen, comparison, how);
  finish_samples(comparison.picture, drawn.seen);
  for (Picture& picture : drawn.pictures) finish_samples(comparison.picture, picture);
  modelled.counts = count_hits(drawn.seen.gbuffer);
  for (std::string& reason : why_empty(modelled.scene, model, comparison.camera, modelled.counts))
    modelled.info.warnings.push_back(std::move(reason));
  return drawn;
}

// One picture is a file as `limn render` writes it; several are layers of one file, over the shading without ink.
void write_layers(size_t row, const std::filesystem::path& folder, Comparison& comparison, Drawn& drawn) {
  ComparedModel& modelled = comparison.models[row];
  modelled.exr = folder / (modelled.name + ".exr");
  const std::string call = comparison.call + " [" + modelled.name + "]";
  if (!comparison.is_matrix() && comparison.at(row, 0).skipped.empty()) {
    std::swap(drawn.pictures[0].gbuffer, drawn.seen.gbuffer);
    write_exr(drawn.pictures[0], comparison.camera, call, modelled.exr);
    std::swap(drawn.pictures[0].gbuffer, drawn.seen.gbuffer);
    return;
  }
  std::vector<NamedLayer> layers;
  for (size_t column = 0; column < drawn.pictures.size(); ++column) {
    if (comparison.at(row, column).skipped.empty()) layers.push_back({comparison.methods[column].name, &drawn.pictures[column]});
  }
  write_exr(drawn.seen, comparison.camera, call, modelled.exr, layers);
}

void keep_cells(size_t row, Comparison& comparison, Drawn& drawn) {
  for (size_t column = 0; column < drawn.pictures.size(); ++column) {
    Cell& cell = comparison.at(row, column);
    if (!cell.skipped.empty()) continue;
    Picture& picture = drawn.pictures[column];
    cell.border_ms = picture.border_ms;
    cell.notes = std::move(picture.notes);
    cell.composite = packed(picture.composite);
    cell.border = std::move(picture.border);
    for (const float coverage : cell.border.pixels) cell.ink_px += double{coverage};
  }
}

std::vector<MetricValue> measured(const Picture& picture, const Picture& reference, const Camera& camera, MetricSubject subject) {
  std::vector<MetricValue> all;
  for (const Metric& metric : metrics()) {
    if (metric.subject != subject) continue;
    const std::vector<MetricValue> values = metric.measure({picture, reference, camera});
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

void measure_cells(size_t row, Picture& picture, Picture& reference, Comparison& comparison) {
  comparison.models[row].values = measured(picture, reference, comparison.camera, MetricSubject::gbuffer);
  for (size_t column = 0; column < comparison.methods.size(); ++column) {
    Cell &cell = comparison.at(row, column), &truth = comparison.at(0, column);
    if (!comparison.is_measured(cell)) continue;
    std::swap(picture.border, cell.border);
    std::swap(reference.border, truth.border);
    cell.values = measured(picture, reference, comparison.camera, MetricSubject::ink);
    std::swap(picture.border, cell.border);
    std::swap(reference.border, truth.border);
  }
}

void skip_model(size_t row, const std::string& reason, Comparison& comparison) {
  comparison.models[row].skipped = reason;
  for (size_t column = 0; column < comparison.methods.size(); ++column) comparison.at(row, column).skipped = reason;
}

}  // namespace

void draw_comparison(Comparison& comparison, const std::filesystem::path& folder, const ExecutionSettings& how, ProgressBar& bar) {
  Picture reference;
  ObjectMeshCache meshes;
  for (size_t row = 0; row < comparison.models.size(); ++row) {
    if (!comparison.models[row].skipped.empty()) {
      skip_model(row, comparison.models[row].skipped, comparison);
      continue;
    }
    try {
      Drawn drawn = draw_model(row, comparison, how, meshes, bar);
      write_layers(row, folder, comparison, drawn);
      keep_cells(row, comparison, drawn);
      if (row == 0) {
        comparison.seen = hit_window(drawn.seen.gbuffer);
        reference = std::move(drawn.seen);
        continue;
      }
      if (comparison.models[row].counts.hits > 0) comparison.seen = merge(comparison.seen, hit_window(drawn.seen.gbuffer));
      measure_cells(row, drawn.seen, reference, comparison);
    } catch (const InputError& error) {
      // What one representation cannot do is part of the answer, not the end of the comparison; without a reference there is none.
      if (row == 0) throw;
      skip_model(row, reason_of(error), comparison);
    }
  }
}

Image<glm::vec4> linear_composite(const Cell& cell) {
  Image<glm::vec4> out(cell.composite.width, cell.composite.height);
  std::array<float, 256> linear_of;
  for (size_t code = 0; code < linear_of.size(); ++code) linear_of[code] = linear_from_srgb(static_cast<float>(code) / 255.0f);
  for (size_t i = 0; i < out.size(); ++i) {
    const glm::u8vec4& color = cell.composite.pixels[i];
    const glm::vec3 linear(linear_of[color.r], linear_of[color.g], linear_of[color.b]);
    const float alpha = static_cast<float>(color.a) / 255.0f;
    out.pixels[i] = glm::vec4(linear * alpha, alpha);
  }
  return out;
}

double value_of(const Comparison& comparison, const Cell& cell, const std::string& name) {
  for (const std::vector<MetricValue>* values : {&cell.values, &comparison.model_of(cell).values, &cell.truth_values}) {
    for (const MetricValue& value : *values) {
      if (value.name == name) return value.value;
    }
  }
  return std::numeric_limits<double>::quiet_NaN();
}

double time_ms_of(const Comparison& comparison, const Cell& cell) {
  const ComparedModel& model = comparison.model_of(cell);
  return model.info.build_ms + model.trace_ms + cell.border_ms;
}

}  // namespace limn
