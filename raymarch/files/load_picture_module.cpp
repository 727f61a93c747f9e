#include "raymarch/files/picture_module.h"
#include "sdf/late_module.h"

namespace limn {

const PictureModule& picture_module() {
  static const PictureModule module = load_late_module<PictureModule>(kPictureModuleFile, kPictureModuleFunction);
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
