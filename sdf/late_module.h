#pragma once
// Parts of limn that stand on libraries that take long to load: modules of their own, loaded when they are first asked for.

#include <cstring>
#include <string>

#include "sdf/version.h"

namespace limn {

/// The function of that name in the module `file`, which is where helper programs are (find_helper). Never unloaded: libraries' threads
/// and tables last to the end. Throws MachineError.
void* find_late_function(const std::string& file, const std::string& function);

/// Throws MachineError: "the module FILE cannot be loaded: PROBLEM".
[[noreturn]] void refuse_late_module(const std::string& file, const std::string& problem);

/// A module's table of functions, filled in by its one exported function, void FUNCTION(Table&). The table says in `version` which limn it
/// is of: another one's may have other functions. Throws MachineError.
template <class Table>
Table load_late_module(const std::string& file, const std::string& function) {
  Table table;
  reinterpret_cast<void (*)(Table&)>(find_late_function(file, function))(table);
  if (table.version == nullptr || std::strcmp(table.version, kVersion) != 0)
    refuse_late_module(file, std::string("it is of limn ") + (table.version ? table.version : "?") + ", not " + kVersion);
  return table;
}

}  // namespace limn
