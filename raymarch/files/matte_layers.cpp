#include "raymarch/files/matte_layers.h"

#include <fmt/format.h>

namespace limn {
namespace {

std::string json_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      quoted.append(1, '\\').append(1, c);
    else if (static_cast<unsigned char>(c) < 0x20)
      quoted += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      quoted += c;
  }
  return quoted + "\"";
}

std::map<std::string, std::uint32_t> sorted(const Matte& matte) {
  std::map<std::string, std::uint32_t> names;
  for (const MatteName& one : matte.names) names[one.name] = one.hash;
  return names;
}

std::string manifest_of(const Matte& matte) {
  std::string text;
  for (const auto& [name, hash] : sorted(matte)) text += fmt::format("{}{}:\"{:08x}\"", text.empty() ? "" : ",", json_text(name), hash);
  return "{" + text + "}";
}

/// Ranks that some pixel has, at least two: a level.
int ranks_of(const Matte& matte) {
  int most = 2;
  for (size_t i = 0; i < matte.indices.size(); ++i) {
    const int rank = static_cast<int>(i % kMatteRanks) + 1;
    if (rank > most && matte.counts[i] > 0) most = rank;
  }
  return most;
}

MatteLayer layer_of(const std::string& name, const Matte& matte, int samples) {
  MatteLayer layer{.name = name};
  const size_t pixels = matte.indices.size() / kMatteRanks;
  const int levels = (ranks_of(matte) + 1) / 2;
  for (int rank = 0; rank < 2 * levels; ++rank) {
    std::vector<float> ids(pixels), coverage(pixels);
    for (size_t i = 0; i < pixels; ++i) {
      const size_t at = i * kMatteRanks + static_cast<size_t>(rank);
      if (matte.counts[at] == 0) continue;
      ids[i] = matte_id(matte.names[matte.indices[at] - 1u].hash);
      coverage[i] = static_cast<float>(matte.counts[at]) / static_cast<float>(samples);
    }
    const std::string level = fmt::format("{}{:02}", name, rank / 2);
    layer.channels.emplace_back(level + (rank % 2 == 0 ? ".R" : ".B"), std::move(ids));
    layer.channels.emplace_back(level + (rank % 2 == 0 ? ".G" : ".A"), std::move(coverage));
  }
  // The specification takes the first seven digits of the name's own hash.
  const std::string key = fmt::format("cryptomatte/{:.7}/", fmt::format("{:08x}", matte_hash(name)));
  layer.header = {{key + "name", name},
                  {key + "hash", "MurmurHash3_32"},
                  {key + "conversion", "uint32_to_float32"},
                  {key + "manifest", manifest_of(matte)}};
  return layer;
}

}  // namespace

std::vector<MatteLayer> matte_layers(const Mattes& mattes) {
  return {layer_of("CryptoObject", mattes.objects, mattes.samples), layer_of("CryptoMaterial", mattes.materials, mattes.samples)};
}

}  // namespace limn
