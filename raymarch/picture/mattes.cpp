#include "raymarch/mattes.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "sdf/error.h"

namespace limn {
namespace {

std::string material_name(const SceneObject& object, std::int32_t material) {
  const auto* mesh = std::get_if<MeshSource>(&object.source);
  const std::int32_t own = material - object.material;
  if (mesh != nullptr && own >= 0 && static_cast<size_t>(own) < mesh->mesh->material_names.size() && !mesh->mesh->face_materials.empty()) {
    const std::string& name = mesh->mesh->material_names[static_cast<size_t>(own)];
    if (!name.empty()) return name;
  }
  return fmt::format("material {}", material);
}

void count(std::uint16_t index, size_t pixel, Matte& matte) {
  for (size_t rank = pixel * kMatteRanks; index != 0 && rank < (pixel + 1) * kMatteRanks; ++rank) {
    if (matte.indices[rank] != index && matte.indices[rank] != 0) continue;
    matte.indices[rank] = index;
    ++matte.counts[rank];
    return;
  }
}

std::uint32_t mixed(std::uint32_t k) { return std::rotl(k * 0xcc9e2d51u, 15) * 0x1b873593u; }

}  // namespace

std::uint32_t matte_hash(const std::string& name) {
  const auto byte = [&](size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(name[i])); };
  std::uint32_t h = 0;
  const size_t blocks = name.size() / 4;
  for (size_t b = 0; b < blocks; ++b) {
    const size_t i = 4 * b;
    h = std::rotl(h ^ mixed(byte(i) | byte(i + 1) << 8 | byte(i + 2) << 16 | byte(i + 3) << 24), 13) * 5 + 0xe6546b64u;
  }
  std::uint32_t tail = 0;
  for (size_t i = name.size(); i > 4 * blocks; --i) tail = tail << 8 | byte(i - 1);
  if (name.size() % 4 != 0) h ^= mixed(tail);
  h ^= static_cast<std::uint32_t>(name.size());
  h = (h ^ h >> 16) * 0x85ebca6bu;
  h = (h ^ h >> 13) * 0xc2b2ae35u;
  h ^= h >> 16;
  // All exponent bits alike would be 0, a denormal number, an infinity or none: the specification flips one of them.
  const std::uint32_t exponent = h >> 23 & 255u;
  return exponent == 0 || exponent == 255 ? h ^ 1u << 23 : h;
}

float matte_id(std::uint32_t hash) { return std::bit_cast<float>(hash); }

MatteCollector::MatteCollector(const Scene& scene, int width, int height) : scene_(scene) {
  mattes_.width = width;
  mattes_.height = height;
  const size_t size = static_cast<size_t>(width) * static_cast<size_t>(height) * kMatteRanks;
  for (Matte* matte : {&mattes_.objects, &mattes_.materials}) {
    matte->indices.assign(size, 0);
    matte->counts.assign(size, 0);
  }
  mattes_.albedo = Image<glm::vec3>(width, height, glm::vec3(0.0f));
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const std::string& name = scene.objects[i].name;
    objects_.push_back(index_of(name.empty() ? fmt::format("object {}", i + 1) : name, mattes_.objects));
  }
}

/// Equal names are one matte.
std::uint16_t MatteCollector::index_of(const std::string& name, Matte& matte) {
  std::map<std::uint32_t, std::uint16_t>& known = &matte == &mattes_.objects ? object_hashes_ : material_hashes_;
  const std::uint32_t hash = matte_hash(name);
  if (const auto found = known.find(hash); found != known.end()) return found->second;
  if (matte.names.size() == std::numeric_limits<std::uint16_t>::max()) return 0;
  matte.names.push_back({name, hash});
  return known[hash] = static_cast<std::uint16_t>(matte.names.size());
}

void MatteCollector::add(const GBuffer& gbuffer, const Image<glm::vec3>& colors) {
  LIMN_CHECK(gbuffer.width == mattes_.width && gbuffer.height == mattes_.height && colors.size() == mattes_.albedo.size());
  for (size_t i = 0; i < gbuffer.id.size(); ++i) {
    const std::int32_t id = gbuffer.id.pixels[i];
    if (id == 0) continue;
    const auto object = static_cast<size_t>(id - 1);
    const std::int32_t material = gbuffer.material.pixels[i];
    const auto [known, is_new] = materials_.try_emplace({id, material}, std::uint16_t{0});
    if (is_new) known->second = index_of(material_name(scene_.objects[object], material), mattes_.materials);
    count(objects_[object], i, mattes_.objects);
    count(known->second, i, mattes_.materials);
    mattes_.albedo.pixels[i] += colors.pixels[i];
  }
}

std::shared_ptr<const Mattes> MatteCollector::finish(int samples) {
  mattes_.samples = samples;
  for (glm::vec3& color : mattes_.albedo.pixels) color /= static_cast<float>(samples);
  for (Matte* matte : {&mattes_.objects, &mattes_.materials}) {
    for (size_t first = 0; first < matte->indices.size(); first += kMatteRanks) {
      // Insertion: stable, so that equal shares keep the order in which they were met.
      for (size_t i = first + 1; i < first + kMatteRanks; ++i) {
        for (size_t k = i; k > first && matte->counts[k] > matte->counts[k - 1]; --k) {
          std::swap(matte->counts[k], matte->counts[k - 1]);
          std::swap(matte->indices[k], matte->indices[k - 1]);
        }
      }
    }
  }
  return std::make_shared<const Mattes>(std::move(mattes_));
}

}  // namespace limn
