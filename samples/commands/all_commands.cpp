// The subcommands. A new one is a file of this folder that defines NAME_command(), and one line here.

#include <array>

#include "samples/commands/command.h"

#define LIMN_COMMANDS(X) \
  X(render)              \
  X(compare)             \
  X(study)               \
  X(contours)            \
  X(judge)               \
  X(plan)                \
  X(stability)           \
  X(export)              \
  X(info)                \
  X(merge)               \
  X(list)                \
  X(demo)                \
  X(man)                 \
  X(completion)

namespace limn {

#define LIMN_DECLARE(name) Command name##_command();
LIMN_COMMANDS(LIMN_DECLARE)
#undef LIMN_DECLARE

std::span<const Command> commands() {
#define LIMN_ENTRY(name) name##_command(),
  static const std::array all = {LIMN_COMMANDS(LIMN_ENTRY)};
#undef LIMN_ENTRY
  return all;
}

}  // namespace limn
