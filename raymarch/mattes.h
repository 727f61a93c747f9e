#pragma once
// Which objects and materials cover each pixel, and by how much: what Cryptomatte layers hold (Psyop, specification 1.2.0). And in which
// colours of their own.

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "raymarch/picture.h"

namespace limn {

inline constexpr int kMatteRanks = 4;  ///< Names kept for each pixel: the first that its samples meet.

/// A name of a matte.
struct MatteName {
  std::string name{};      ///< Of an object or a material.
  std::uint32_t hash = 0;  ///< matte_hash(name).
};

/// One kind of matte.
struct Matte {
  std::vector<MatteName> names{};  ///< Of the scene; beyond 65,535 of them the rest is left out.
  /// Of each pixel, kMatteRanks of them: a name's index plus 1, most samples first; 0 where there are no more.
  std::vector<std::uint16_t> indices{};
  std::vector<std::uint16_t> counts{};  ///< Samples that show it.
};

/// Mattes of a finished picture.
struct Mattes {
  int width = 0,    ///< Pixels.
      height = 0;   ///< Pixels.
  int samples = 1;  ///< Of each pixel.
  Matte objects{},  ///< By the names of objects.
      materials{};  ///< By the names of materials.
  /// Mean over the samples of the colours without light, linear; 0 for samples that hit nothing.
  Image<glm::vec3> albedo{};
};

/// MurmurHash3_x86_32 (Appleby 2011) with seed 0, moved off the bits that would be no finite float other than 0.
std::uint32_t matte_hash(const std::string& name);
/// The float with the same bits.
float matte_id(std::uint32_t hash);

/// Collects mattes sample by sample. Objects go by their names; materials by the names that files give them, else "material N".
class MatteCollector {
 public:
  /// The scene must outlive this.
  MatteCollector(const Scene& scene, int width, int height);
  /// Reads the layers `id` and `material`. `colors`: of each pixel, without light.
  void add(const GBuffer& gbuffer, const Image<glm::vec3>& colors);
  /// After so many samples.
  std::shared_ptr<const Mattes> finish(int samples);

 private:
  std::uint16_t index_of(const std::string& name, Matte& matte);

  const Scene& scene_;
  Mattes mattes_{};
  std::vector<std::uint16_t> objects_{};                                        ///< Of each object its name's index plus 1.
  std::map<std::pair<std::int32_t, std::int32_t>, std::uint16_t> materials_{};  ///< Of an id and a material.
  std::map<std::uint32_t, std::uint16_t> object_hashes_{}, material_hashes_{};
};

}  // namespace limn
