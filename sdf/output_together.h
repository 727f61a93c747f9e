#pragma once
// Files that belong together, written whole or not at all.

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace limn {

/// A file to be written: `write` is called with the path of a temporary file.
struct OutputFile {
  std::filesystem::path target{};                             ///< Where it is to be.
  std::function<void(const std::filesystem::path&)> write{};  ///< Throws where writing fails.
};

/// Text or bytes at hand.
OutputFile bytes_output(const std::filesystem::path& target, std::string bytes);

/// For `write` of an OutputFile: throws MachineError naming `target` where the disk fails.
void write_bytes(const std::filesystem::path& temporary, const std::filesystem::path& target, std::string_view content);

/// Files that belong together, each as by write_whole (sdf/output_file.h): all are written to temporary files before the first takes its
/// place. Where one cannot be written or put in place, all old ones stay. A process that is killed while they take their places
/// (microseconds) leaves files missing, never an old one beside a new one.
void write_together(std::span<const OutputFile> files);

/// True while files take their places: no moment to end the process, if it can be helped. Async-signal-safe.
bool outputs_are_being_replaced() noexcept;

}  // namespace limn
