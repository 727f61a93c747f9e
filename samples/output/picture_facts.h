#pragma once
// limn info of a picture: its size, layers and types, who made it by which call, and what is wrong with it.

#include "raymarch/files/picture_file.h"
#include "samples/output/output.h"

namespace limn {

Json picture_json(const PictureFile& picture);
std::string picture_text(const PictureFile& picture, const std::string& name);

}  // namespace limn
