#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "samples/commands/options.h"

namespace CLI {
class Option;
}

namespace limn {

// Groups of the help.
inline constexpr const char* kSurface = "Surface";
inline constexpr const char* kOutput = "Output";
inline constexpr const char* kCamera = "Camera";

struct OptionText {
  const char* flags;
  const char* value;  ///< What stands behind it in the help: "WxH".
  const char* help;
  const char* group;
};

/// One argument, handed to `read` as text, so that every complaint is ours: one line that says what is expected.
CLI::Option* add(CLI::App& app, const OptionText& text, const std::function<void(const std::string&)>& read);
/// The same, as often as somebody likes.
CLI::Option* add_repeatable(CLI::App& app, const OptionText& text, std::function<void(const std::string&)> read);
/// An option without an argument.
void add_switch(CLI::App& app, const OptionText& text, bool& target);
/// A setting of surfaces by its name ("voxels").
CLI::Option* add_setting(CLI::App& app, Options& options, const char* name);

template <class T>
void add_unless_there(const T& one, std::vector<T>& all) {
  if (std::find(all.begin(), all.end(), one) == all.end()) all.push_back(one);
}

/// Of add_border() what says which ink: --method and --set; `compared`: --methods too.
void add_methods(CLI::App& app, Options& options, bool compared = false);

/// Adds the methods of a list, or of "all", to those that are compared. Throws InputError for a name that is none.
void read_compared_methods(const std::string& text, Options& options);
/// --surface, repeatable, and --surfaces.
void add_compared_surfaces(CLI::App& app, Options& options);

/// --case, --seed and --draws, in this group of the help.
void add_cases(CLI::App& app, Options& options, const char* group);

}  // namespace limn
