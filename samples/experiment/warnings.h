#pragma once
// What a person should know before trusting a result: the audit's findings that matter for what is asked, and what building a model told.

#include "raymarch/picture.h"

namespace limn {

/// What is done with the scene.
struct WarningNeeds {
  std::vector<std::string> surfaces{};  ///< Names; empty: settings.kind, or what each object is by itself.
  std::vector<std::string> methods{};   ///< Names; empty: all.
  ObjectMeshCache* meshes = nullptr;    ///< Where a mesh that is looked at is kept for the model, or taken from; null: nowhere.
  bool thorough = false;                ///< Every check rather than the quick ones, and what helps with each finding.
};

/// Looks at every object, and tells what matters for what is asked, a line each.
std::vector<std::string> warnings_of(const Scene& scene, const SurfaceSettings& settings, const WarningNeeds& needs);

std::vector<std::string> names_of(const std::vector<MethodCall>& methods);

}  // namespace limn
