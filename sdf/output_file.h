#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace limn {

/// Calls `write` with the path of a temporary file in the target's folder (same extension, name starting ".limn-"), then renames it onto
/// `target`. Whatever happens before the rename — an exception, a signal that unwinds — the old file stays and the temporary one goes.
/// What a killed process left of this kind in the folder is removed at the first file written there (one that a living process works on
/// stays). Creates missing folders. Throws InputError where the folder cannot be written, MachineError where the disk fails.
void write_whole(const std::filesystem::path& target, const std::function<void(const std::filesystem::path&)>& write);

/// The same for text or bytes at hand.
void write_whole(const std::filesystem::path& target, std::string_view content);

/// Removes the temporary files that are open now; async-signal-safe, for SIGINT and SIGTERM handlers.
void remove_temporary_files() noexcept;

}  // namespace limn
