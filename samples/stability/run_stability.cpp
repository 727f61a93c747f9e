#include "samples/stability/run_stability.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "raymarch/image_io.h"
#include "samples/experiment/job.h"
#include "samples/stability/corpus.h"
#include "samples/stability/judge.h"
#include "sdf/error.h"
#include "sdf/guard.h"

namespace limn {
namespace {

// A note for each of many views says the same many times over.
constexpr size_t kMostSaid = 8;

std::string file_name(const StabilityCell& cell) {
  std::string name = cell.case_name + (cell.draw > 0 ? fmt::format("-{}", cell.draw) : "") + "-" + cell.surface;
  if (!cell.method.empty()) name += "-" + cell.method;
  std::string out;
  for (const char c : name) out += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '.' ? c : '_';
  return out + ".png";
}

void keep_picture(const StabilityFinding& finding, const std::filesystem::path& folder, StabilityCell& cell) {
  constexpr int kLargest_px = 2048;
  const Image<glm::vec4>& picture = finding.picture;
  if (folder.empty() || picture.size() == 0 || picture.width > kLargest_px || picture.height > kLargest_px) return;
  cell.picture = "pictures/" + file_name(cell);
  write_image(picture, folder / cell.picture);
}

/// Empty where the method can run on what the surface came to.
std::string unsupported(CaseContext& context, const MethodCall* method) {
  if (!context.unsupported().empty()) return context.unsupported();
  const StabilityStage& stage = context.stage();
  return method == nullptr ? std::string() : method->method->unsupported(stage.model, stage.scene);
}

StabilityEvent look(CaseContext& context, const StabilityCheck& check, const MethodCall* method, const Parameters& with) {
  try {
    StabilityEvent event;
    event.finding = check.run(context, method, with);
    // What is looked at without a method is the rim's surface.
    add_said(said_of(context.stage(), method == nullptr ? "rim" : method->method->about.name), event.finding->said);
    for (const Finding& finding : context.stage().findings) event.audit.emplace_back("audit: " + finding.message);
    if (event.finding->said.size() > kMostSaid) event.finding->said.resize(kMostSaid);
    return event;
  } catch (const InputError& error) {
    return {std::nullopt, error.what(), {}};
  }
}

StabilityCase smaller(StabilityCase one, const StabilityRunSettings& settings) {
  if (settings.longest_side_px) {
    for (glm::ivec2& size : one.sizes_px) {
      const double factor = std::min(1.0, static_cast<double>(*settings.longest_side_px) / std::max(size.x, size.y));
      size = glm::max(glm::ivec2(1), glm::ivec2(glm::dvec2(size) * factor));
    }
  }
  if (settings.draws) one.draws = one.random.empty() && one.views == 1 ? 1 : *settings.draws;
  return one;
}

/// Kept out of a cell's own work: what is the same for all methods of a case.
struct CaseRun {
  const StabilityCase& which;
  const StabilityCheck& check;
  Parameters with;
  const StabilityRunSettings& settings;
};

StabilityCell run_cell(const CaseRun& run, CaseContext& context, int draw, const MethodCall* method) {
  StabilityCell cell;
  cell.case_name = run.which.text.name;
  cell.draw = draw;
  cell.surface = context.surface();
  if (method != nullptr) cell.method = methods_text({*method});
  cell.unit = run.check.unit;
  cell.seed = run.settings.seed;
  cell.parameters.assign(context.values().begin(), context.values().end());
  StabilityEvent event;
  try {
    if (const std::string reason = unsupported(context, method); !reason.empty()) {
      cell.outcome = StabilityOutcome::skipped;
      cell.message = reason;
      return cell;
    }
    event = look(context, run.check, method, run.with);
  } catch (const InputError& error) {
    event.refused = error.what();
  }
  judge(run.which, event, cell);
  if (event.finding) keep_picture(*event.finding, run.settings.folder, cell);
  return cell;
}

void run_case(const CaseRun& run, StabilityResults& results) {
  for (int draw = 0; draw < run.which.draws; ++draw) {
    for (const std::string& surface : run.which.surfaces) {
      const auto& wanted = run.settings.surfaces;
      if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), surface) == wanted.end()) continue;
      CaseContext context(run.which, draw, run.settings.seed, surface, run.settings.how);
      const std::vector<std::string>& methods = run.settings.methods;
      if (!run.check.of_methods) {
        if (!methods.empty()) continue;
        results.cells.push_back(run_cell(run, context, draw, nullptr));
        continue;
      }
      for (const MethodCall& method : context.methods()) {
        if (!methods.empty() && std::find(methods.begin(), methods.end(), method.method->about.name) == methods.end()) continue;
        if (run.settings.how.cancelled && run.settings.how.cancelled()) throw Cancelled{};
        results.cells.push_back(run_cell(run, context, draw, &method));
      }
    }
  }
}

}  // namespace

std::vector<StabilityCase> stability_corpus() {
  std::vector<StabilityCase> cases;
  for (const CorpusFile& file : corpus_files()) cases.push_back(parse_case(std::string(file.text), std::string(file.name)));
  return cases;
}

StabilityCase find_stability_case(const std::string& name_or_file) {
  std::vector<std::string> names;
  for (const CorpusFile& file : corpus_files()) {
    const std::string name = std::filesystem::path(file.name).stem().string();
    if (name == name_or_file) return parse_case(std::string(file.text), std::string(file.name));
    names.push_back(name);
  }
  if (!name_or_file.ends_with(".toml")) throw InputError({"", "case", name_or_file, "unknown case", known_names(name_or_file, names)});
  check_readable(name_or_file, "a case (.toml)");
  std::ifstream stream(name_or_file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw InputError({name_or_file, "", "", "cannot be read", "a readable case (.toml)"});
  return parse_case(text.str(), name_or_file);
}

StabilityResults run_stability(const std::vector<StabilityCase>& cases, const StabilityRunSettings& settings) {
  StabilityResults results;
  results.seed = settings.seed;
  for (size_t i = 0; i < cases.size(); ++i) {
    const StabilityCase one = smaller(cases[i], settings);
    const StabilityCheck& check = find_stability_check(one.text.check);
    const CaseRun run{one, check, resolve(check.parameters, one.with, one.file, "with."), settings};
    results.cases.push_back(one.text);
    run_case(run, results);
    if (settings.progress) settings.progress(static_cast<double>(i + 1) / static_cast<double>(cases.size()));
  }
  return results;
}

}  // namespace limn
