#pragma once
// The audit: what in an input makes which representation and which method fail, with a number and the remedy. A check is one file in
// raymarch/audit/ and one line in its registry.

#include "raymarch/border.h"
#include "sdf/registry.h"

namespace limn {

/// How bad a finding is, from good to know upwards.
enum class Severity { info, warning, error };
/// "info", "warning", "error".
const char* name_of(Severity severity);

/// One finding: what was looked for, how much of it there is, what follows from it in a sentence, and what helps.
struct Finding {
  std::string check{};                  ///< AuditCheck::about.name.
  Severity severity = Severity::info;   ///< The worst that follows.
  double value = 0.0;                   ///< The number that `message` names.
  std::string message{};                ///< One sentence.
  std::string remedy{};                 ///< Empty where nothing is wrong.
  std::vector<std::string> surfaces{};  ///< Representations it makes fail; empty with a severity above info: all.
  std::vector<std::string> methods{};   ///< Outline methods it makes fail; empty with a severity above info: all.
};

/// What is to be done with the input. Checks speak of the resolution and the gradient in `surface`; no gradient: of all of them.
struct AuditSettings {
  SurfaceSettings surface{};  ///< Resolution, gradient and level that the object is modelled with.
  /// Looks at everything, in a time that grows with the input; otherwise only at what a bounded sample of it tells, which takes less than
  /// about 50 ms and one pass over it.
  bool thorough = false;
  /// What the object is drawn as and by, as in `matters`: checks that can warn of neither are left out. Empty: anything.
  std::vector<std::string> surfaces{},  ///< Representations.
      methods{};                        ///< Outline methods.
  std::vector<std::string> checks{};    ///< Names of those that are run, whatever they take; empty: all.
};

class AuditFacts;  // raymarch/audit/facts.h: what several checks look at, made when first asked for

/// One check: a file in raymarch/audit/ and a line in its registry.
struct AuditCheck {
  Description about{};  ///< name: Finding::check.
  bool quick = false;   ///< Takes less than about 50 ms, of what is not small from a sample.
  /// Appends what it finds; nothing where it has nothing to say about that kind of object.
  void (*look)(AuditFacts& facts, std::vector<Finding>& findings);
  /// What its warnings may be for, at most. It is not run where something else is asked for.
  bool warns = true;                    ///< False: it only tells.
  std::vector<std::string> surfaces{};  ///< Empty: any.
  std::vector<std::string> methods{};   ///< Empty: any.
};
/// All checks, in the order of raymarch/audit/all_audit_checks.cpp.
const Registry<AuditCheck>& audit_checks();

/// What a check took. What several look at counts for the first that asks for it.
struct AuditCost {
  std::string check{};  ///< AuditCheck::about.name.
  bool quick = false;   ///< AuditCheck::quick.
  double ms = 0.0;      ///< Wall clock.
};

/// What the checks find in one object, in the registry's order. Appends to `costs`, if given, a line for each check that was run.
std::vector<Finding> audit(const SceneObject& object, const AuditSettings& settings, std::vector<AuditCost>* costs = nullptr);

/// True where a finding is a warning or an error for any of the surfaces drawn by any of the methods (names; empty: by none that matters,
/// so that only what every method suffers from counts).
bool matters(const Finding& finding, std::span<const std::string> surfaces, std::span<const std::string> methods);

/// Methods that read the layer or need of that name ("NdotV", "mesh"), from their own lists.
std::vector<std::string> methods_reading(std::span<const std::string> inputs);

}  // namespace limn
