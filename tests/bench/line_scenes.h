#pragma once
// Scenes of quadrics and planes that the suite of lines draws beside the built-in ones.

#include <string>
#include <vector>

#include "raymarch/scene.h"

namespace limn::bench {

struct NamedScene {
  std::string name{};
  Scene scene{};
};
std::vector<NamedScene> line_scenes();

}  // namespace limn::bench
