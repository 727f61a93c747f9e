#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

#include "samples/input/toml_reader.h"

namespace limn {

/// What `read` makes of the file `path` that the key names. One that is missing or locked away is told with the line that names it; what is
/// wrong inside one with its own.
template <class Read>
auto read_named(TomlReader& reader, const char* key, const std::filesystem::path& path, const Read& read) {
  try {
    return read();
  } catch (const InputError& error) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored) && ::access(path.c_str(), R_OK) == 0) throw;
    reader.fail(*reader.take(key), key, path.string() + ": " + error.fault().problem, error.fault().expected);
  }
}

}  // namespace limn
