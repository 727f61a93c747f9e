#include <array>

#include "samples/commands/command.h"

namespace limn {

Command render_command();
Command compare_command();
Command study_command();
Command export_command();
Command info_command();
Command list_command();
Command plan_command();
Command merge_command();
Command stability_command();

std::span<const Command> commands() {
  static const std::array all = {
      render_command(), compare_command(), study_command(), plan_command(), stability_command(),
      export_command(), info_command(),    merge_command(), list_command(),
  };
  return all;
}

}  // namespace limn
