#include "tests/bench/line_scenes.h"

#include "samples/scenes/scenes.h"
#include "tests/bench/line_parts.h"

namespace limn::bench {
std::vector<NamedScene> line_scenes() {
  std::vector<NamedScene> all;
  for (const SceneDescriptor& descriptor : scenes()) all.push_back({descriptor.about.name, descriptor.make()});
  for (const SolidPart& part : line_parts())
    if (!find_scene(part.name)) all.push_back({part.name, scene_of(part)});
  return all;
}

}  // namespace limn::bench
