#include "raymarch/files/picture_module.h"
#include "sdf/late_module.h"

namespace limn {

const PictureModule& picture_module() {
  // Its 260 libraries' pages, and the stacks of their threads.
  constexpr size_t kBytes = size_t{128} << 20;
  static const PictureModule module = load_late_module<PictureModule>(kPictureModuleFile, kPictureModuleFunction, kBytes);
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
