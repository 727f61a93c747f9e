#pragma once
// Pictures in and out. Files are written whole: to a temporary file beside the target, then renamed.

#include <filesystem>
#include <map>

#include "raymarch/picture.h"
#include "sdf/color.h"

namespace limn {

/// A picture that shares another one's G-buffer, as a layer of that one's file: NAME.R, .G, .B, .A and NAME.Y, its ink.
struct NamedLayer {
  std::string name{};                ///< NAME of the channels.
  const Picture* picture = nullptr;  ///< Not null; must outlive the call that writes it.
};

/// Every layer of a picture as one EXR: R G B A, Z, P, N, NdotV, border, id, material, status (float32 for Z, P, N, NdotV; half elsewhere,
/// 32-bit unsigned for ids above 2048), border_status where a method has one; then the `layers`. The header carries the program's version,
/// `call` (limn:call), worldToCamera, worldToNDC, and no time stamp.
void write_exr(const Picture& picture, const Camera& camera, const std::string& call, const std::filesystem::path& file,
               std::span<const NamedLayer> layers = {});

/// The composite as .png, .tif or .jpg: un-premultiplied where the format has alpha, laid over white where it has none; sRGB, 8 bit.
void write_image(const Image<glm::vec4>& linear_premultiplied, const std::filesystem::path& file);
/// Of sRGB with alpha kept apart, as Picture::bytes has it, as .png.
void write_image(const Image<glm::u8vec4>& bytes, const std::filesystem::path& file);
/// The same PNG in memory, for pages that hold their pictures.
std::vector<std::byte> encode_png(const Image<glm::vec4>& linear_premultiplied);
std::vector<std::byte> encode_png(const Image<glm::u8vec4>& bytes);  ///< Of bytes as Picture::bytes has them.

/// One named channel of an image file, top row first. Throws InputError.
Image<float> read_channel(const std::filesystem::path& file, const std::string& channel);
/// Channels of an image file, in the file's order. Throws InputError where it cannot be read.
std::vector<std::string> channel_names(const std::filesystem::path& file);

}  // namespace limn
