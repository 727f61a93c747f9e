#pragma once
// Pictures for write_together: what they refer to must be there until they are written.

#include "raymarch/image_io.h"
#include "sdf/output_together.h"

namespace limn {

/// As write_exr.
OutputFile exr_output(const Picture& picture, const Camera& camera, const std::string& call, const std::filesystem::path& file,
                      std::span<const NamedLayer> layers = {});
/// As write_image.
OutputFile image_output(const Image<glm::vec4>& linear_premultiplied, const std::filesystem::path& file);
/// Of Picture::bytes, as .png.
OutputFile image_output(const Image<glm::u8vec4>& bytes, const std::filesystem::path& file);

}  // namespace limn
