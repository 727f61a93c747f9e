#include "samples/output/held_folder.h"

#include <unistd.h>

namespace limn {
namespace {

bool is_missing(const std::filesystem::path& folder) {
  std::error_code ignored;
  return !std::filesystem::exists(folder, ignored);
}

}  // namespace

HeldFolder::HeldFolder(const std::filesystem::path& folder) : path_(folder), made_(is_missing(folder)), lock_(folder) {}

// While the lock is held, so that nobody has begun to work in it; a folder with anything in it stays.
HeldFolder::~HeldFolder() {
  if (made_) ::rmdir(path_.c_str());
}

}  // namespace limn
