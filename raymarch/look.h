#pragma once
// Looks: how a picture is drawn that somebody wants to show. One file in raymarch/look/ and one line in its registry.

#include <map>
#include <string>
#include <vector>

#include "raymarch/shading.h"
#include "sdf/descriptor.h"
#include "sdf/registry.h"

namespace limn {

/// An outline method of a look, with what it sets.
struct LookInk {
  std::string method{};                                ///< Name in border_methods().
  std::map<std::string, ParameterInput> parameters{};  ///< By name; the others have their defaults.
};

/// Shading, ink and ground that go together.
struct Look {
  Description about{};          ///< Name, help and source.
  ShadingSettings shading{};    ///< Beneath the ink.
  std::vector<LookInk> inks{};  ///< In order, the last on top.
  glm::vec3 ground{1.0f};       ///< Behind everything, linear, unless the picture is transparent.
};

/// All looks, in the order of raymarch/look/all_looks.cpp.
const Registry<Look>& looks();

}  // namespace limn
