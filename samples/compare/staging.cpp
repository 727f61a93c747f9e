#include "samples/compare/staging.h"

#include <unistd.h>

#include <fstream>
#include <sstream>
#include <system_error>

#include "sdf/error.h"
#include "sdf/output_file.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

/// Files that we write, and the folder where nothing else is in it: whatever somebody else put there stays.
void remove_own(const fs::path& work) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(work, ignored)) {
    const std::string name = entry.path().filename().string();
    const bool own =
        name.starts_with(".limn-") || name.ends_with(".exr") || name == "sheet.png" || name == "rows.json" || name == "report.html";
    if (own && entry.is_regular_file(ignored)) fs::remove(entry.path(), ignored);
  }
  ::rmdir(work.c_str());
}

void check_replaceable(const fs::path& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return;
  if (fs::is_directory(file, ignored)) throw InputError({file.string(), "output", "", "is a folder", "the place of a file"});
  if (::access(file.c_str(), W_OK) != 0)
    throw InputError({file.string(), "output", "", "cannot be written", "a file that may be replaced"});
}

/// What stands in the place may be a link to elsewhere, which is kept; a rename would replace it.
void put(const fs::path& from, const fs::path& to) {
  std::error_code error;
  if (!fs::is_symlink(to, error)) {
    fs::rename(from, to, error);
    if (!error) return;
  }
  std::ifstream stream(from, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  if (!stream) throw MachineError(from.string() + ": cannot be read again");
  write_whole(to, bytes.str());
}

}  // namespace

StagedFolder::StagedFolder(const fs::path& folder) : folder_(folder), work_(folder / "compare.unfinished") {
  remove_own(work_);
  std::error_code error;
  fs::create_directory(work_, error);
  if (error)
    throw InputError({folder.string(), "output", "", "cannot be written to: " + error.message(), "a folder that may be written to"});
}

StagedFolder::~StagedFolder() { remove_own(work_); }

std::vector<fs::path> StagedFolder::publish(const std::vector<fs::path>& names) const {
  std::vector<fs::path> files;
  // All of them before the first is replaced.
  for (const fs::path& name : names) check_replaceable(folder_.path() / name);
  for (const fs::path& name : names) {
    put(work_ / name, folder_.path() / name);
    files.push_back(folder_.path() / name);
  }
  return files;
}

}  // namespace limn
