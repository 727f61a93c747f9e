#pragma once
// Hashes of contents, in a module of their own (helpers/hash_module.cpp): studies need them before they can start, and loading all of
// OpenImageIO for them would take a fifth of a second.

#include <cstddef>
#include <span>
#include <string>

namespace limn {

struct HashModule {
  const char* version = nullptr;  ///< Of limn: another one's module may have other functions.

  /// Of all parts, one after another: 40 hexadecimal digits.
  std::string (*sha1)(std::span<const std::span<const std::byte>> parts) = nullptr;
};

/// What a module exports: void limn_hash_module(HashModule&), which fills in its functions.
inline constexpr const char* kHashModuleFile = "limn-hash.so";
inline constexpr const char* kHashModuleFunction = "limn_hash_module";

/// Loaded once. Throws MachineError where it is not there or is another version's.
const HashModule& hash_module();

}  // namespace limn
