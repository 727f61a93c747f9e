#include "raymarch/border/edge_sources.h"

#include <fmt/core.h>

#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "raymarch/border/broken_lines.h"
#include "raymarch/border/edge_lines.h"
#include "raymarch/border/section_map.h"
#include "raymarch/gbuffer/picture_rows.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

EdgeSettings read_settings(EdgeOperator edge_operator, const Parameters& parameters) {
  EdgeSettings settings;
  settings.edge_operator = edge_operator;
  settings.debug = parameters.choice("view") == "debug";
  const double degrees = parameters.number("normal_threshold") * std::numbers::pi / 180.0;
  const auto weight = [&](const char* name) { return static_cast<float>(parameters.number(name)); };
  settings.sources[kDepthSource] = {weight("depth_weight"), weight("depth_threshold")};
  settings.sources[kNormalSource] = {weight("normal_weight"), static_cast<float>(2.0 * std::sin(0.5 * degrees))};
  settings.sources[kColorSource] = {weight("color_weight"), weight("color_threshold")};
  settings.sources[kIdSource] = {weight("id_weight"), weight("id_threshold")};
  settings.sources[kCustomSource] = {weight("custom_weight"), weight("custom_threshold")};
  if (parameters.flag("modulation")) {
    settings.distance_factor = static_cast<float>(parameters.number("distance_factor"));
    settings.grazing = {parameters.number("grazing_p"), parameters.number("grazing_hardness"), parameters.number("grazing_power"),
                        parameters.number("grazing_strength")};
  } else {
    settings.distance_factor = 0.0f;
    settings.grazing.strength = 0.0;
  }
  return settings;
}

/// The custom source: the caller's buffer, or a section map made here. Its weight falls to 0, with a note, where there is nothing to read.
SectionMap choose_custom(const std::string& name, const BorderInput& input, const Parameters& parameters, EdgeSettings& settings,
                         Border& border) {
  SectionMap made;
  EdgeSource& source = settings.sources[kCustomSource];
  if (source.weight == 0.0f) return made;
  const std::string& from = parameters.choice("custom_from");
  if (from == "buffer") {
    settings.custom = &input.gbuffer.custom;
    if (input.gbuffer.custom.size() != input.gbuffer.id.size()) {
      made.missing = "the scene fills no custom buffer; custom_from names other sources";
    }
  } else {
    const SectionSource sections = from == "groups"     ? SectionSource::groups
                                   : from == "position" ? SectionSource::position
                                                        : SectionSource::vertex_colors;
    made = section_map(input, sections, parameters.number("section_size"));
  }
  if (!made.missing.empty()) {
    source.weight = 0.0f;
    border.notes.push_back(fmt::format("{}: {}; the custom source draws nothing", name, made.missing));
  }
  return made;
}

float nearest_depth(const Image<float>& depth) {
  const auto smaller = [](float a, float b) { return b < a ? b : a; };
  return parallel_reduce(
      depth.size(), size_t{1} << 16, std::numeric_limits<float>::infinity(),
      [&](const IndexRange<size_t>& range, float nearest) {
        for (size_t i = range.begin(); i < range.end(); ++i) nearest = smaller(nearest, depth.pixels[i]);
        return nearest;
      },
      smaller);
}

/// Whether the surface runs on straight through this pixel, along the line and along the column: the chords to both neighbours within 3
/// degrees of each other, and of like lengths. A depth line here is a false one. (The normals are not asked: they may be the cause.)
bool smooth_here(const GBuffer& seen, int x, int y) {
  if (x < 1 || y < 1 || x + 1 >= seen.width || y + 1 >= seen.height) return false;
  const size_t i = seen.id.index(x, y);
  if (seen.id.pixels[i] == 0) return false;
  for (const size_t step : {size_t{1}, static_cast<size_t>(seen.width)}) {
    if (seen.id.pixels[i - step] != seen.id.pixels[i] || seen.id.pixels[i + step] != seen.id.pixels[i]) return false;
    const glm::vec3 before = seen.position.pixels[i] - seen.position.pixels[i - step];
    const glm::vec3 after = seen.position.pixels[i + step] - seen.position.pixels[i];
    const float a = glm::length(before), b = glm::length(after);
    if (std::max(a, b) > 3.0f * std::min(a, b) || glm::dot(before, after) < 0.9986f * a * b) return false;
  }
  return true;
}

struct DepthLines {
  std::atomic<std::int64_t> all{0}, false_ones{0};
};

bool any_of(const float* edges, int width) { return std::find(edges, edges + width, 1.0f) != edges + width; }

void count_depth_lines(const GBuffer& seen, int y, const float* edges, DepthLines& lines) {
  if (!any_of(edges, seen.width)) return;
  std::int64_t all = 0, false_ones = 0;
  for (int x = 0; x < seen.width; ++x) {
    if (edges[x] == 0.0f) continue;
    ++all;
    false_ones += smooth_here(seen, x, y);
  }
  lines.all += all;
  lines.false_ones += false_ones;
}

/// Ink of one line of the picture, and its debug colours.
void ink_line(const EdgeSettings& settings, const EdgeFlags& flags, int y, Border& border) {
  const int width = border.coverage.width;
  float* ink = &border.coverage.at(0, y);
  for (size_t s = 0; s < kSourceCount; ++s) {
    if (!settings.used(s)) continue;
    const float* edges = flags.of(s);
    const float weight = settings.debug ? 1.0f : settings.sources[s].weight;
    for (int x = 0; x < width; ++x) ink[x] = std::max(ink[x], weight * edges[x]);
  }
  if (!settings.debug) return;
  for (int x = 0; x < width; ++x) {
    glm::vec3 color(flags.of(kDepthSource)[x], flags.of(kNormalSource)[x], flags.of(kColorSource)[x]);
    const bool other =
        (settings.used(kIdSource) && flags.of(kIdSource)[x] > 0.0f) || (settings.used(kCustomSource) && flags.of(kCustomSource)[x] > 0.0f);
    if (color == glm::vec3(0.0f) && other) color = glm::vec3(0.5f);
    border.colors.at(x, y) = color;
  }
}

void add_notes(const std::string& name, const DepthLines& lines, Border& border) {
  if (lines.false_ones > 0) {
    border.notes.push_back(fmt::format("{}: {} of {} pixels of depth lines are false: the surface is steep there but does not jump", name,
                                       lines.false_ones.load(), lines.all.load()));
  }
}

}  // namespace

double slope_gain(EdgeOperator edge_operator) { return edge_operator == EdgeOperator::roberts ? 1.0 : 2.0; }

double grazing_factor(const GrazingModulation& modulation, double n_dot_v) {
  const auto in = static_cast<float>(n_dot_v);
  float out = 0.0f;
  grazing_factors(modulation, &in, 1, &out);
  return double{out};
}

std::vector<Parameter> edge_parameters(EdgeOperator edge_operator) {
  const GrazingModulation grazing;
  const double depth_px = 5.0 * slope_gain(edge_operator);
  return {
      a_number("depth_weight", 1.0).in(0.0, 1.0).help("ink of depth edges; 0 leaves them out"),
      a_number("depth_threshold", depth_px).in(0.0, 1e6).unit("px").help("least jump of depth, in sizes of a pixel at that depth"),
      a_number("normal_weight", 1.0).in(0.0, 1.0).help("ink of normal edges; 0 leaves them out"),
      a_number("normal_threshold", 30.0).in(0.0, 180.0).unit("deg").help("least angle between normals"),
      a_number("color_weight", 0.0).in(0.0, 1.0).help("ink of edges of the shaded colour; 0 leaves them out"),
      a_number("color_threshold", 0.2).in(0.0, 2.0).help("least difference of linear colour"),
      a_number("id_weight", 1.0).in(0.0, 1.0).help("ink of edges between objects and materials; 0 leaves them out"),
      a_number("id_threshold", 0.5).in(0.0, 2.0).help("least edge strength of ids, which differ by 0 or 1"),
      a_number("custom_weight", 0.0).in(0.0, 1.0).help("ink of edges of the scene's custom buffer; 0 leaves them out"),
      a_number("custom_threshold", 0.1).in(0.0, 1e6).help("least difference in the custom buffer"),
      a_choice("custom_from", {"buffer", "vertex_colors", "groups", "position"})
          .help("what fills the custom buffer: the caller, the mesh's vertex colours or face groups, or cells of a world grid"),
      a_number("section_size", 0.25).in(1e-6, 1e9).unit("world").help("side of the grid's cells for custom_from=position"),
      a_flag("modulation", true).help("modulate the depth threshold by distance and by grazing angle"),
      a_number("distance_factor", 1.0).in(0.0, 1.0).help("1: the depth threshold grows as the depth; 0: as at the nearest visible point"),
      a_number("grazing_p", grazing.p).in(0.01, 1.0).help("share of the fresnel term's range, from the top, that raises the threshold"),
      a_number("grazing_hardness", grazing.hardness).in(0.0, 0.99).help("how soon the raise is complete"),
      a_number("grazing_power", grazing.power).in(0.01, 64.0).help("exponent of the fresnel term 1 - N.V"),
      a_number("grazing_strength", grazing.strength)
          .in(0.0, 1e4)
          .help("threshold times 1 + this where the view grazes; 12 silences planes up to 89 degrees"),
      a_choice("view", {"ink", "debug"}).help("debug: depth, normal, colour edges in red, green, blue, others grey"),
      a_color("color", {0.0, 0.0, 0.0}).help("ink, linear RGB"),
  };
}

Border draw_edges(EdgeOperator edge_operator, const std::string& name, const BorderInput& input, const Parameters& parameters) {
  const GBuffer& seen = input.gbuffer;
  EdgeSettings settings = read_settings(edge_operator, parameters);
  Border border;
  const SectionMap sections = choose_custom(name, input, parameters, settings, border);
  if (!sections.sections.pixels.empty()) settings.custom = &sections.sections;
  border.color = glm::vec3(parameters.vector3("color"));
  border.coverage = {seen.width, seen.height, 0.0f};
  if (settings.debug) border.colors = {seen.width, seen.height, glm::vec3(0.0f)};
  DepthLines depth_lines;
  const float nearest = nearest_depth(seen.depth);
  if (std::isfinite(nearest)) {
    for_each_band(seen.height, [&](int y0, int y1) {
      EdgeLines lines(settings, input, nearest);
      EdgeFlags flags(seen.width);
      for (int y = y0; y < y1; ++y) {
        lines.find_edges(y, flags);
        ink_line(settings, flags, y, border);
        if (settings.used(kDepthSource)) count_depth_lines(seen, y, flags.of(kDepthSource), depth_lines);
      }
    });
  }
  add_notes(name, depth_lines, border);
  if (std::string note = broken_lines_note(name, input, border.coverage); !note.empty()) border.notes.push_back(std::move(note));
  return border;
}

}  // namespace limn
