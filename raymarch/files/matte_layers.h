#pragma once
// Cryptomatte layers of a picture file (Psyop, "Cryptomatte specification" 1.2.0).

#include <string>
#include <utility>
#include <vector>

#include "raymarch/mattes.h"

namespace limn {

/// One kind of matte, as channels and header entries have it.
struct MatteLayer {
  std::string name{};                                                  ///< "CryptoObject".
  std::vector<std::pair<std::string, std::vector<float>>> channels{};  ///< "CryptoObject00.R" and its pixels: ids and coverages in turn.
  std::vector<std::pair<std::string, std::string>> header{};           ///< name, hash, conversion and manifest.
};

/// CryptoObject and CryptoMaterial, with as many levels of two ranks each as the picture needs.
std::vector<MatteLayer> matte_layers(const Mattes& mattes);

}  // namespace limn
