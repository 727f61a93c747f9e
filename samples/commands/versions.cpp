#include "samples/commands/versions.h"

#include <OpenImageIO/oiioversion.h>
#include <embree3/rtcore_config.h>
#include <fmt/format.h>
#include <hwy/highway.h>
#include <opensubdiv/version.h>
#include <openvdb/version.h>
#include <tbb/version.h>
#include <toml++/impl/version.h>

#include <CLI/Version.hpp>
#include <nlohmann/json.hpp>

#include "sdf/version.h"

namespace limn {
namespace {

/// What the kernels run on here: the best of the targets they were compiled for that this machine has.
std::string simd_target() {
#if LIMN_SIMD
  const std::int64_t usable = hwy::SupportedTargets() & HWY_TARGETS;
  return hwy::TargetName(usable & -usable);  // a better target is a lower bit
#else
  return "off (scalar build)";
#endif
}

}  // namespace

std::string version_text() {
  return fmt::format(
      "limn {}\n"
      "SIMD {}\n"
      "OpenVDB {}.{}.{}, OpenSubdiv {}.{}.{}, OpenImageIO {}, Embree {}, oneTBB {}.{}\n"
      "CLI11 {}, toml++ {}.{}.{}, nlohmann-json {}.{}.{}, fmt {}.{}.{}",
      kVersion, simd_target(), OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER, OPENVDB_LIBRARY_MINOR_VERSION_NUMBER,
      OPENVDB_LIBRARY_PATCH_VERSION_NUMBER, OPENSUBDIV_VERSION_NUMBER / 10000, OPENSUBDIV_VERSION_NUMBER / 100 % 100,
      OPENSUBDIV_VERSION_NUMBER % 100, OIIO_VERSION_STRING, RTC_VERSION_STRING, TBB_VERSION_MAJOR, TBB_VERSION_MINOR, CLI11_VERSION,
      TOML_LIB_MAJOR, TOML_LIB_MINOR, TOML_LIB_PATCH, NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH,
      FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100);
}

}  // namespace limn
