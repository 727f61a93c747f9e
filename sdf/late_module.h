#pragma once
// Parts of limn that stand on libraries that take long to load: modules of their own, loaded when they are first asked for.

#include <cstddef>
#include <cstring>
#include <string>

#include "sdf/version.h"

namespace limn {

/// The function of that name in the module `file`, which is where helper programs are (find_helper). Never unloaded: libraries' threads
/// and tables last to the end. Throws MachineError.
void* find_late_function(const std::string& file, const std::string& function);

/// Asks for so much memory and gives it back. Libraries that make threads while they are loaded end the program where there is none for the
/// stacks; who is told of memory that ends can say so (std::set_new_handler). Throws std::bad_alloc.
void want_memory(std::size_t bytes);

/// Throws MachineError: "the module FILE cannot be loaded: PROBLEM".
[[noreturn]] void refuse_late_module(const std::string& file, const std::string& problem);

/// A module's table of functions, filled in by its one exported function, void FUNCTION(Table&). The table says in `version` which limn it
/// is of: another one's may have other functions. `bytes`: that its libraries take while they are loaded. Throws MachineError, and
/// std::bad_alloc where there are fewer.
template <class Table>
Table load_late_module(const std::string& file, const std::string& function, std::size_t bytes) {
  want_memory(bytes);
  Table table;
  reinterpret_cast<void (*)(Table&)>(find_late_function(file, function))(table);
  if (table.version == nullptr || std::strcmp(table.version, kVersion) != 0)
    refuse_late_module(file, std::string("it is of limn ") + (table.version ? table.version : "?") + ", not " + kVersion);
  return table;
}

}  // namespace limn
