#pragma once
// Where results go, checked before any work is done for them.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace limn {

/// JSON that keeps the order in which keys were added.
using Json = nlohmann::ordered_json;

/// limn-out/COMMAND/NAME.
std::filesystem::path default_output(const std::string& command, const std::string& name);

/// Lower-case, with the dot.
std::string ending_of(const std::filesystem::path& file);

/// Throws InputError unless `file` can be written: a known ending, not a folder, a place where files can be made, and, with `no_clobber`,
/// not there yet.
void check_output_file(const std::filesystem::path& file, bool no_clobber, const std::vector<std::string>& endings);
/// The same for a folder that will hold several files.
void check_output_folder(const std::filesystem::path& folder, bool no_clobber);

/// One JSON document on stdout. Its sentences (warnings, notes, remedies) name settings as options of the command line do (in_flags).
void print_json(Json document);
void print_text(const std::string& text);  ///< Text on stdout. Throws MachineError where it cannot be written.
/// A sentence on stderr, kept to one line, with settings as options.
void print_note(const std::string& text);

/// A finite number, or null: JSON has no NaN.
Json number_or_null(double value);

/// "12.3 MB".
std::string bytes_text(double bytes);
/// "850 ms", "1.24 s".
std::string time_text(double milliseconds);

}  // namespace limn
