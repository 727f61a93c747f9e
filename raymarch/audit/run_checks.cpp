#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "raymarch/audit/facts.h"
#include "sdf/local_grid.h"
#include "sdf/quantile.h"
#include "subdiv/refine.h"

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;
constexpr size_t kSmallFaces = 100'000, kSampledFaces = 20'000;

bool meet(std::span<const std::string> of, std::span<const std::string> asked) {
  return of.empty() || std::any_of(asked.begin(), asked.end(),
                                   [&](const std::string& name) { return std::find(of.begin(), of.end(), name) != of.end(); });
}

bool is_concerned(const AuditCheck& check, const AuditSettings& settings) {
  if (settings.surfaces.empty() && settings.methods.empty()) return true;
  return check.warns && (settings.surfaces.empty() || meet(check.surfaces, settings.surfaces)) &&
         (settings.methods.empty() || meet(check.methods, settings.methods));
}

}  // namespace

const char* name_of(Severity severity) {
  switch (severity) {
    case Severity::info:
      return "info";
    case Severity::warning:
      return "warning";
    case Severity::error:
      break;
  }
  return "error";
}

std::vector<Finding> audit(const SceneObject& object, const AuditSettings& settings, std::vector<AuditCost>* costs) {
  AuditFacts facts(object, settings);
  std::vector<Finding> findings;
  // The checks look at grids of one voxel size.
  if (facts.level_set() != nullptr && local_volume(facts.level_set()->level_set) != nullptr) return findings;
  for (const AuditCheck& check : audit_checks()) {
    const bool named = std::find(settings.checks.begin(), settings.checks.end(), check.about.name) != settings.checks.end();
    if (!named && (!settings.checks.empty() || (!settings.thorough && !check.quick))) continue;
    if (!is_concerned(check, settings)) continue;
    const auto started = Clock::now();
    check.look(facts, findings);
    if (costs != nullptr)
      costs->push_back({check.about.name, check.quick, std::chrono::duration<double, std::milli>(Clock::now() - started).count()});
  }
  return findings;
}

bool matters(const Finding& finding, std::span<const std::string> surfaces, std::span<const std::string> methods) {
  return finding.severity != Severity::info && meet(finding.surfaces, surfaces) && meet(finding.methods, methods);
}

std::vector<std::string> methods_reading(std::span<const std::string> inputs) {
  std::vector<std::string> names;
  for (const BorderMethod& method : border_methods()) {
    const auto reads = [&](const std::string& input) {
      return std::any_of(method.inputs.begin(), method.inputs.end(), [&](const std::string& own) { return own == input; });
    };
    if (std::any_of(inputs.begin(), inputs.end(), reads)) names.push_back(method.about.name);
  }
  return names;
}

std::optional<Scheme> AuditFacts::scheme() const {
  if (mesh() == nullptr) return std::nullopt;
  return settings.surface.scheme ? settings.surface.scheme : mesh()->scheme;
}

const MeshFacts& AuditFacts::mesh_facts() {
  if (mesh_facts_) return *mesh_facts_;
  const Mesh& of = mesh()->mesh;
  const bool all = settings.thorough || of.face_count() <= kSmallFaces;
  mesh_facts_ = std::make_unique<MeshFacts>(all ? limn::mesh_facts(of) : sampled_mesh_facts(of, kSampledFaces));
  return *mesh_facts_;
}

std::string AuditFacts::sample_text() {
  const MeshFacts& facts = mesh_facts();
  return facts.looked_at == facts.faces
             ? ""
             : fmt::format(" (counted around {} of its {} faces; limn info looks at all)", facts.looked_at, facts.faces);
}

const SurfaceSamples& AuditFacts::samples() {
  if (samples_) return *samples_;
  samples_ = std::make_unique<SurfaceSamples>();
  if (!bounds(object).finite() || bounds(object).empty()) return *samples_;
  if (const Field* source = field()) *samples_ = sample_field(*source);
  if (mesh() != nullptr) *samples_ = sample_mesh(object, settings.surface);
  if (level_set() != nullptr) *samples_ = sample_level_set(object);
  return *samples_;
}

double known_quantile(std::vector<double> values, double share) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  return lower_quantile(std::move(values), share);
}

double share_below(std::span<const double> values, double limit) {
  if (values.empty()) return 0.0;
  const auto below = std::count_if(values.begin(), values.end(), [&](double value) { return value < limit; });
  return static_cast<double>(below) / static_cast<double>(values.size());
}

}  // namespace limn
