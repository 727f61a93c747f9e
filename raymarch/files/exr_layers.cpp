// The layers of a picture, as channels and header of one EXR file.

#include <algorithm>
#include <glm/gtc/type_ptr.hpp>

#include "raymarch/files/exr_file.h"
#include "raymarch/files/matte_layers.h"
#include "raymarch/files/picture_file.h"
#include "raymarch/image_output.h"
#include "sdf/error.h"
#include "sdf/version.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

/// `image` must be there until the file is written.
template <class Image, class Get>
void add_channel(std::vector<ExrChannel>& channels, const std::string& name, ExrType type, const Image& image, Get get) {
  const auto* const pixels = image.data();
  channels.push_back({name, type, [pixels, get](size_t first, size_t last, float* values) {
                        for (size_t i = first; i < last; ++i) *values++ = static_cast<float>(get(pixels[i]));
                      }});
}

/// Half holds whole numbers to 2048; beyond it ids are 32-bit.
ExrType type_of_ids(const Image<std::int32_t>& ids) {
  const auto [least, most] = std::minmax_element(ids.pixels.begin(), ids.pixels.end());
  if (ids.pixels.empty() || (*least >= -2048 && *most <= 2048)) return ExrType::half;
  return *least >= 0 ? ExrType::whole : ExrType::full;
}

const auto kItself = [](auto value) { return value; };

/// Of vectors the one component: a step of a fixed length through their numbers, where a subscript of glm's asks which it is each time.
template <glm::length_t count>
void add_component(std::vector<ExrChannel>& channels, const std::string& name, ExrType type,
                   const LargeVector<glm::vec<count, float>>& vectors, int axis) {
  const float* const first_number = vectors.empty() ? nullptr : glm::value_ptr(vectors.front()) + axis;
  channels.push_back({name, type, [first_number](size_t first, size_t last, float* values) {
                        for (size_t i = first; i < last; ++i) *values++ = first_number[static_cast<size_t>(count) * i];
                      }});
}

void add_layer(std::vector<ExrChannel>& channels, const NamedLayer& layer) {
  const auto half = ExrType::half;
  const char* const rgba[] = {".R", ".G", ".B", ".A"};
  for (int i = 0; i < 4; ++i) add_component(channels, layer.name + rgba[i], half, layer.picture->composite.pixels, i);
  add_channel(channels, layer.name + ".Y", half, layer.picture->border.pixels, kItself);
  if (!layer.picture->border_status.pixels.empty())
    add_channel(channels, layer.name + ".status", half, layer.picture->border_status.pixels, kItself);
}

std::vector<ExrChannel> channels_of(const Picture& picture) {
  const auto half = ExrType::half, full = ExrType::full;
  const GBuffer& seen = picture.gbuffer;
  std::vector<ExrChannel> channels;
  const char* const rgba[] = {"R", "G", "B", "A"};
  const char* const xyz[] = {"X", "Y", "Z"};
  for (int i = 0; i < 4; ++i) add_component(channels, rgba[i], half, picture.composite.pixels, i);
  add_channel(channels, "Z", full, seen.depth.pixels, kItself);
  for (int i = 0; i < 3; ++i) add_component(channels, std::string("P.") + xyz[i], full, seen.position.pixels, i);
  for (int i = 0; i < 3; ++i) add_component(channels, std::string("N.") + xyz[i], full, seen.normal.pixels, i);
  add_channel(channels, "NdotV.Y", full, seen.n_dot_v.pixels, kItself);
  add_channel(channels, "border.Y", half, picture.border.pixels, kItself);
  add_channel(channels, "id.Y", type_of_ids(seen.id), seen.id.pixels, kItself);
  add_channel(channels, "material.Y", type_of_ids(seen.material), seen.material.pixels, kItself);
  add_channel(channels, "status.Y", half, seen.status.pixels, kItself);
  if (!picture.border_status.pixels.empty()) add_channel(channels, "border_status.Y", half, picture.border_status.pixels, kItself);
  if (picture.mattes != nullptr)
    for (int i = 0; i < 3; ++i) add_component(channels, std::string("albedo.") + rgba[i], half, picture.mattes->albedo.pixels, i);
  return channels;
}

std::vector<MatteLayer> mattes_of(const Picture& picture) {
  return picture.mattes != nullptr ? matte_layers(*picture.mattes) : std::vector<MatteLayer>();
}

/// EXR matrices multiply row vectors from the right: row after row, they hold what ours hold column after column.
std::array<float, 16> row_after_row(const glm::dmat4& matrix) {
  std::array<float, 16> values;
  for (int i = 0; i < 16; ++i) values[static_cast<size_t>(i)] = static_cast<float>(matrix[i / 4][i % 4]);
  return values;
}

std::vector<ExrAttribute> exr_attributes(std::span<const MatteLayer> mattes, const Camera& camera, const std::string& call) {
  std::vector<ExrAttribute> attributes = {{"limn:version", kVersion},
                                          {"limn:call", call},
                                          {"Software", std::string("limn ") + kVersion},
                                          {"capDate", "1970:01:01 00:00:00"},
                                          {"worldToCamera", row_after_row(camera_from_world_matrix(camera))},
                                          {"worldToNDC", row_after_row(ndc_from_world_matrix(camera))}};
  for (const MatteLayer& layer : mattes)
    for (const auto& [name, value] : layer.header) attributes.push_back({name, value});
  return attributes;
}

ExrPicture exr_picture(const Picture& picture, std::span<const MatteLayer> mattes, std::span<const NamedLayer> layers, const Camera& camera,
                       const std::string& call) {
  ExrPicture exr{picture.gbuffer.width, picture.gbuffer.height, exr_attributes(mattes, camera, call), channels_of(picture)};
  for (const MatteLayer& matte : mattes)
    for (const auto& [name, values] : matte.channels) add_channel(exr.channels, name, ExrType::full, values, kItself);
  for (const NamedLayer& layer : layers) add_layer(exr.channels, layer);
  return exr;
}

}  // namespace

OutputFile exr_output(const Picture& picture, const Camera& camera, const std::string& call, const fs::path& file,
                      std::span<const NamedLayer> layers) {
  const std::string extension = lower_extension(file);
  if (extension != ".exr") throw InputError({file.string(), {}, extension, "unknown extension for all layers", ".exr"});
  return {file, [&picture, &camera, &call, file, layers](const fs::path& temporary) {
            const std::vector<MatteLayer> mattes = mattes_of(picture);
            write_exr_file(temporary, file.string(), exr_picture(picture, mattes, layers, camera, call));
          }};
}

void write_exr(const Picture& picture, const Camera& camera, const std::string& call, const std::filesystem::path& file,
               std::span<const NamedLayer> layers) {
  const OutputFile output = exr_output(picture, camera, call, file, layers);
  write_together({&output, 1});
}

}  // namespace limn
