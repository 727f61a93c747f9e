#pragma once
// What every report page carries in itself, from samples/page/; the build embeds the files into the program.

#include <string_view>

namespace limn {

extern const std::string_view kPageStyle;
extern const std::string_view kPageScript;
extern const std::string_view kSliderScript;    ///< img-comparison-slider, with its licence.
extern const std::string_view kStudyStyle;      ///< After kPageStyle.
extern const std::string_view kStudyNumbers;    ///< What a study's page reckons itself.
extern const std::string_view kStudyCharts;     ///< What the charts of a study look like.
extern const std::string_view kStudyScript;     ///< What moves them.
extern const std::string_view kStabilityStyle;  ///< After kPageStyle.
extern const std::string_view kStabilityScript;
extern const std::string_view kVegaScript;  ///< These three in this order, each with its licence.
extern const std::string_view kVegaLiteScript;
extern const std::string_view kVegaEmbedScript;

}  // namespace limn
