#pragma once
// Fields of a specification as options of the command line: the one place that knows how they are written there.

#include <map>
#include <string>

#include "sdf/error.h"

namespace limn {

/// "voxel_size" -> "--voxel-size", "parameters.rim.width" -> "--set rim.width". A name that no option has stays as it is.
std::string flag_of(const std::string& field);

/// The sentence as somebody at a command line needs it: "surface = mesh" becomes "--surface mesh", "fresh = true" "--fresh", "max_memory"
/// "--max-memory". Only names of fields are touched.
std::string in_flags(const std::string& text);

/// The fault with its field, and what its texts say of fields, as options.
InputFault in_flags(InputFault fault);

/// True where the fault is about the specification and not about a file.
bool is_of_specification(const InputFault& fault);

/// A whole call, as it can be pasted.
class CallText {
 public:
  /// Begins with "limn", the command and, unless empty, the input.
  CallText(const std::string& command, const std::string& input) : text_("limn " + command + (input.empty() ? "" : " " + input)) {}
  /// An option with its value, as flag_of() writes the field.
  void add(const std::string& field, const std::string& value);
  /// An option without a value.
  void add(const std::string& field);
  const std::string& text() const { return text_; }  ///< What was added so far.

 private:
  std::string text_;
};

/// What a call sets, by option; of several parameters each by its own name ("--set rim.threshold").
std::map<std::string, std::string> settings_of_call(const std::string& call);

}  // namespace limn
