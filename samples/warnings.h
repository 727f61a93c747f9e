#pragma once
// What a person should know before trusting a result: the audit's findings that matter for what is asked, and what building a model told.

#include "raymarch/picture.h"
#include "samples/output.h"

namespace limn {

/// What is done with the scene.
struct WarningNeeds {
  std::vector<std::string> surfaces{};  ///< Names; empty: settings.kind, or what each object is by itself.
  std::vector<std::string> methods{};   ///< Names; empty: all.
};

/// Looks at every object, quickly (thoroughly with --verbose), and prints what matters as a line each on stderr unless --quiet: before any
/// work is done. Returns the lines without "limn: warning: ".
std::vector<std::string> warn_of_input(const Options& options, const Scene& scene, const SurfaceSettings& settings,
                                       const WarningNeeds& needs);

/// "limn: warning: ..." on stderr, a line each, unless --quiet.
void print_warnings(const Options& options, const std::vector<std::string>& warnings);

std::vector<std::string> names_of(const std::vector<MethodCall>& methods);

}  // namespace limn
