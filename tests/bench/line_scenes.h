#pragma once
// What the suite of lines draws: the built-in scenes and the parts that are not among them.

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
