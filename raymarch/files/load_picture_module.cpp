#include <dlfcn.h>

#include <cstring>

#include "raymarch/files/picture_module.h"
#include "sdf/error.h"
#include "sdf/guard.h"
#include "sdf/version.h"

namespace limn {
namespace {

PictureModule load() {
  const std::filesystem::path file = find_helper(kPictureModuleFile);
  const auto failed = [&](const std::string& problem) {
    return MachineError("the module " + file.string() + " cannot be loaded: " + problem);
  };
  // Never unloaded: OpenImageIO's threads and tables last to the end.
  void* const module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) throw failed(::dlerror());
  void* const found = ::dlsym(module, kPictureModuleFunction);
  if (found == nullptr) throw failed(::dlerror());
  PictureModule functions;
  reinterpret_cast<void (*)(PictureModule&)>(found)(functions);
  if (functions.version == nullptr || std::strcmp(functions.version, kVersion) != 0)
    throw failed(std::string("it is of limn ") + (functions.version ? functions.version : "?") + ", not " + kVersion);
  return functions;
}

}  // namespace

const PictureModule& picture_module() {
  static const PictureModule module = load();
  return module;
}

std::future<void> load_picture_module_early() {
  return std::async(std::launch::async, [] {
    try {
      picture_module();
    } catch (const std::exception&) {
      // Whoever needs it asks again, and gets the error.
    }
  });
}

}  // namespace limn
