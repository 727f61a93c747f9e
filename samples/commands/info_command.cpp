#include <fmt/format.h>

#include <mutex>

#include "raymarch/audit.h"
#include "samples/commands/command.h"
#include "samples/commands/common.h"
#include "samples/commands/info_dump.h"
#include "samples/experiment/no_effect.h"
#include "samples/experiment/thread_settings.h"
#include "samples/output/output.h"
#include "samples/output/picture_facts.h"
#include "samples/output/progress.h"
#include "sdf/error.h"
#include "sdf/local_grid.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

Json vector_json(const glm::dvec3& v) { return {number_or_null(v.x), number_or_null(v.y), number_or_null(v.z)}; }
Json bounds_json(const Box& box) {
  if (box.empty()) return nullptr;
  return {{"lower", vector_json(box.lower)}, {"upper", vector_json(box.upper)}};
}

struct Report {
  std::string name, kind;
  Box bounds;
  Json counts = Json::object();
  std::vector<Finding> audit;
  std::vector<AuditCost> costs;
};

void report_mesh(const MeshSource& source, Report& report) {
  const Mesh& mesh = source.mesh;
  report.kind = source.scheme ? "cage" : "mesh";
  size_t triangles = 0, quads = 0;
  for (const std::int32_t size : mesh.face_sizes) {
    triangles += size == 3 ? 1 : 0;
    quads += size == 4 ? 1 : 0;
  }
  report.counts = {{"vertices", mesh.vertex_count()},
                   {"faces", mesh.face_count()},
                   {"triangles", triangles},
                   {"quads", quads},
                   {"n_gons", mesh.face_count() - triangles - quads},
                   {"creases", mesh.creases.size()},
                   {"corners", mesh.corners.size()},
                   {"materials", mesh.material_names.size()},
                   {"groups", mesh.group_names.size()}};
  if (source.scheme) report.counts["scheme"] = limn::name_of(*source.scheme);
}

void report_level_set(const LevelSetSource& source, Report& report) {
  const LevelSetInfo& info = source.level_set.info();
  report.kind = "level_set";
  report.counts = {{"active_voxels", info.active_voxels},
                   {"voxel_size", info.voxel_size},
                   {"half_width_voxels", info.half_width_voxels},
                   {"bytes", info.bytes}};
  if (!local_volume(source.level_set)) return;
  std::int64_t voxels = 0, bytes = 0;
  for (const LevelSet& grid : grids_of(source.level_set)) voxels += grid.info().active_voxels, bytes += grid.info().bytes;
  report.counts["active_voxels"] = voxels;
  report.counts["bytes"] = bytes;
  report.counts["voxel_sizes"] = grids_of(source.level_set).size();
}

Report report_of(const SceneObject& object, const SurfaceSettings& settings) {
  Report report{.name = object.name, .kind = "field", .bounds = bounds(object), .counts = Json::object(), .audit = {}, .costs = {}};
  if (const auto* mesh = std::get_if<MeshSource>(&object.source)) report_mesh(*mesh, report);
  if (const auto* level_set = std::get_if<LevelSetSource>(&object.source)) report_level_set(*level_set, report);
  report.audit = audit(object, {.surface = settings, .thorough = true}, &report.costs);
  return report;
}

std::vector<Report> reports_of(const Scene& scene, const SurfaceSettings& settings, const Options& options) {
  std::vector<Report> reports(scene.objects.size());
  ProgressBar bar(wants_progress(options.quiet, options.no_progress));
  const std::function<void(double)> show = bar.stage("checking objects");
  std::mutex mutex;
  size_t done = 0;
  parallel_for(size_t{0}, reports.size(), [&](size_t i) {
    reports[i] = report_of(scene.objects[i], settings);
    const std::lock_guard lock(mutex);
    if (show && reports.size() > 1) show(static_cast<double>(++done) / static_cast<double>(reports.size()));
  });
  return reports;
}

Json audit_json(const std::vector<Finding>& findings) {
  Json audit = Json::array();
  for (const Finding& finding : findings) {
    audit.push_back({{"check", finding.check},
                     {"severity", name_of(finding.severity)},
                     {"value", number_or_null(finding.value)},
                     {"message", finding.message},
                     {"remedy", finding.remedy},
                     {"surfaces", finding.surfaces},
                     {"methods", finding.methods}});
  }
  return audit;
}

std::string bounds_text(const Box& box) {
  if (box.empty()) return "nothing";
  return fmt::format("[{:g}, {:g}, {:g}] to [{:g}, {:g}, {:g}]", box.lower.x, box.lower.y, box.lower.z, box.upper.x, box.upper.y,
                     box.upper.z);
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

// Below what is wrong: for whom, and what helps.
std::string finding_text(const Finding& finding) {
  constexpr const char* kBelow = "                                    ";
  std::string text = fmt::format("  {:<8} {:<24} {}\n", name_of(finding.severity), finding.check, in_flags(finding.message));
  if (finding.severity == Severity::info) return text;
  std::string whom = joined(finding.surfaces);
  if (!finding.methods.empty()) whom += (whom.empty() ? "" : "; ") + joined(finding.methods);
  if (!whom.empty()) text += fmt::format("{}fails: {}\n", kBelow, whom);
  if (!finding.remedy.empty()) text += fmt::format("{}remedy: {}\n", kBelow, in_flags(finding.remedy));
  return text;
}

std::string report_text(const Report& report) {
  std::string text = fmt::format("{}: {}, {}\n", report.name, report.kind, bounds_text(report.bounds));
  std::string counts;
  for (const auto& [key, value] : report.counts.items()) {
    std::string label = key;
    std::replace(label.begin(), label.end(), '_', ' ');
    counts += (counts.empty() ? "  " : ", ") + label + " " +
              (value.is_string()         ? value.get<std::string>()
               : value.is_number_float() ? fmt::format("{:g}", value.get<double>())
                                         : value.dump());
  }
  if (!counts.empty()) text += counts + "\n";
  for (const Finding& finding : report.audit) text += finding_text(finding);
  return text;
}

bool is_sound(const Report& report) {
  return std::all_of(report.audit.begin(), report.audit.end(), [](const Finding& finding) { return finding.severity == Severity::info; });
}

/// Of many objects those that something is wrong with, and how many the rest are; --json has them all.
std::string reports_text(const std::vector<Report>& reports) {
  constexpr size_t kMostInFull = 100, kMostListed = 50;
  std::string text;
  const bool in_full = reports.size() <= kMostInFull;
  size_t sound = 0, listed = 0;
  for (const Report& report : reports) {
    if (!in_full && is_sound(report))
      ++sound;
    else if (in_full || listed++ < kMostListed)
      text += report_text(report);
  }
  if (listed > kMostListed) text += fmt::format("{} more objects with warnings (--json lists them)\n", listed - kMostListed);
  if (sound > 0) text += fmt::format("{} objects without a warning (--json lists them)\n", sound);
  return text;
}

/// "bunny: quick checks 31 ms (parts 30 ms, …), the others 240 ms (thin 200 ms, …)".
std::string costs_text(const Report& report) {
  std::string text = report.name;
  for (const bool quick : {true, false}) {
    double all = 0.0;
    std::string each;
    for (const AuditCost& cost : report.costs) {
      if (cost.quick != quick) continue;
      all += cost.ms;
      each += fmt::format("{}{} {}", each.empty() ? "" : ", ", cost.check, time_text(cost.ms));
    }
    text += fmt::format("{} {} ({})", quick ? ": quick checks" : ", the others", time_text(all), each);
  }
  return text;
}

Json grids_json(const std::vector<GridSummary>& grids) {
  Json list = Json::array();
  for (const GridSummary& grid : grids) {
    list.push_back({{"name", grid.name},
                    {"type", grid.value_type},
                    {"class", grid.grid_class},
                    {"active_voxels", grid.active_voxels < 0 ? Json() : Json(grid.active_voxels)},
                    {"voxel_size", grid.voxel_size}});
  }
  return list;
}

std::string grids_text(const std::vector<GridSummary>& grids) {
  std::string text;
  for (const GridSummary& grid : grids) {
    const std::string voxels =
        grid.active_voxels < 0 ? "voxels (the file does not count them)" : fmt::format("{} active voxels", grid.active_voxels);
    text += fmt::format("  grid     {:<24} {} {}, {} of {:g}\n", grid.name.empty() ? "(no name)" : grid.name, grid.grid_class,
                        grid.value_type, voxels, grid.voxel_size);
  }
  return text;
}

const char* kind_name(InputKind kind) {
  switch (kind) {
    case InputKind::mesh:
      return "mesh";
    case InputKind::level_set:
      return "level_set";
    case InputKind::field:
      return "field";
    case InputKind::scene_file:
    case InputKind::built_in:
      break;
  }
  return "scene";
}

// A volume that cannot be drawn as a level set is still worth a look: its grids, and the reason.
int report_volume_without_level_set(const Options& options, const std::vector<GridSummary>& grids, const InputError& error) {
  Finding finding{.check = "level_set", .severity = Severity::error, .message = error.what()};
  if (options.json) {
    print_json({{"kind", "level_set"},
                {"bounds", nullptr},
                {"counts", {{"grids", grids.size()}}},
                {"audit", audit_json({finding})},
                {"grids", grids_json(grids)}});
  } else {
    print_text(fmt::format("{}: {} grids\n{}  {:<8} {:<24} {}\n", options.spec.input, grids.size(), grids_text(grids), "error",
                           finding.check, in_flags(finding.message)));
  }
  return 0;
}

void print_report(const Options& options, SceneInput input, const std::vector<GridSummary>& grids) {
  SurfaceSettings settings = surface_settings(options.spec, input);
  refuse_unchecked(options.spec.surface, input);
  if (!options.spec.surface.gradient && !input.surface.gradient) settings.gradient.clear();
  const std::vector<Report> reports = reports_of(input.scene, settings, options);
  if (options.verbose) {
    for (const Report& report : reports) print_note(costs_text(report));
  }
  const Box all = bounds(input.scene);
  if (!options.json) {
    std::string text;
    if (reports.size() > 1)
      text = fmt::format("{}: {}, {} objects, {}\n", options.spec.input, kind_name(input.kind), reports.size(), bounds_text(all));
    print_text(text + reports_text(reports) + grids_text(grids));
    return;
  }
  Json document = {
      {"kind", kind_name(input.kind)}, {"bounds", bounds_json(all)}, {"counts", {{"objects", reports.size()}}}, {"audit", Json::array()}};
  Json objects = Json::array();
  for (const Report& report : reports) {
    for (const auto& [key, value] : report.counts.items()) {
      if (value.is_number_integer()) document["counts"][key] = document["counts"].value(key, std::int64_t{0}) + value.get<std::int64_t>();
    }
    for (Json finding : audit_json(report.audit)) {
      if (reports.size() > 1) finding["object"] = report.name;
      document["audit"].push_back(std::move(finding));
    }
    objects.push_back({{"name", report.name}, {"kind", report.kind}, {"bounds", bounds_json(report.bounds)}, {"counts", report.counts}});
  }
  document["objects"] = std::move(objects);
  if (input.kind == InputKind::level_set) document["grids"] = grids_json(grids);
  print_json(document);
}

int report_picture(const Options& options) {
  const PictureFile picture = read_picture_file(options.spec.input);
  if (options.json)
    print_json(picture_json(picture));
  else
    print_text(picture_text(picture, options.spec.input));
  return 0;
}

void add_options(CLI::App& app, Options& options) {
  add_input(app, options);
  add_surface(app, options, {.surface = false});
  add_json(app, options);
  add_dump(app, options);
  add_execution(app, options);
}

int run(const Options& options) {
  const ThreadLimit threads(options.spec.threads);
  if (is_picture_file(options.spec.input)) {
    refuse_surface_settings(options.spec, "a picture");
    if (!options.dump.what.empty()) throw InputError({"", "dump", options.dump.what, "a picture holds no formula and no level set", ""});
    return report_picture(options);
  }
  if (!options.dump.what.empty()) {
    print_text(dump_text(options, load(options)));
    return 0;
  }
  std::vector<GridSummary> grids;
  if (input_kind(options.spec.input) == InputKind::level_set) {
    grids = list_grids(options.spec.input);
    if (options.spec.grids.empty()) {
      try {
        print_report(options, load(options), grids);
        return 0;
      } catch (const InputError& error) {
        // Of the call, and not of what is in the file.
        if (is_of_specification(error.fault())) throw;
        return report_volume_without_level_set(options, grids, error);
      }
    }
  }
  print_report(options, load(options), grids);
  return 0;
}

}  // namespace

Command info_command() {
  return {"info", "says what is in a file, and what is wrong with it",
          "  limn info bunny.obj\n  limn info gyroid --voxels 64\n  limn info smoke.vdb --json\n  limn info teacup.exr\n"
          "  limn info gyroid --dump tape\n  limn info gyroid --voxels 64 --dump bricks --brick 3",
          add_options, run};
}

}  // namespace limn
