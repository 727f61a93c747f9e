#pragma once
// What every report page carries in itself, from samples/page/; the build embeds the files into the program.

#include <string_view>

namespace limn {

extern const std::string_view kPageStyle;
extern const std::string_view kPageScript;
extern const std::string_view kSliderScript;  ///< img-comparison-slider, with its licence.

}  // namespace limn
