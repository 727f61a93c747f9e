#pragma once
// What `limn list` lists, by name, for help and completion.

#include <string>
#include <vector>

namespace limn {

/// "shapes", ..., and "reference".
std::vector<std::string> list_kinds();
/// Of one of these: "rim", ... of "methods". Empty where there is no such kind.
std::vector<std::string> names_of_kind(const std::string& kind);

}  // namespace limn
