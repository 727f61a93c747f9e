// limn-hash.so: SHA-1 of OpenImageIO's library of helpers, which loads in a few milliseconds without the library itself.

#include <OpenImageIO/hash.h>

#include "raymarch/files/hash_module.h"
#include "sdf/version.h"

namespace limn {
namespace {

std::string sha1(std::span<const std::span<const std::byte>> parts) {
  OIIO::SHA1 hash;
  for (const std::span<const std::byte> part : parts) hash.append(part.data(), part.size());
  return hash.digest();
}

}  // namespace
}  // namespace limn

extern "C" __attribute__((visibility("default"))) void limn_hash_module(limn::HashModule& module) {
  using namespace limn;
  module = {kVersion, sha1};
}
