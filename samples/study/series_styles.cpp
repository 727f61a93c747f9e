#include "samples/study/series_styles.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace limn {
namespace {

/// The usual ones first, so that a model looks the same in every study: models from a formula beside each other have different colours, as
/// have those of a cage (7 colours and 6 markers repeat: style 9 has the colour of 2 and another marker).
constexpr std::array<std::pair<std::string_view, size_t>, 10> kUsualStyles = {{{"level set, central gradient", 0},
                                                                               {"mesh, limit normals", 1},
                                                                               {"level set, cubic gradient", 2},
                                                                               {"mesh, vertex normals", 3},
                                                                               {"mesh, flat facets", 4},
                                                                               {"level set, cell gradient", 5},
                                                                               {"analytic", 6},
                                                                               {"mesh level set, central gradient", 7},
                                                                               {"mesh level set, cubic gradient", 9},
                                                                               {"mesh level set, cell gradient", 12}}};
constexpr size_t kFirstOtherStyle = 14, kStyles = 42;

}  // namespace

std::vector<size_t> styles_of(const std::vector<std::string>& series) {
  std::vector<size_t> styles;
  styles.reserve(series.size());
  for (const std::string& name : series) {
    const auto usual = std::find_if(kUsualStyles.begin(), kUsualStyles.end(), [&](const auto& one) { return one.first == name; });
    if (usual != kUsualStyles.end()) {
      styles.push_back(usual->second);
      continue;
    }
    // By the name, not by the place: FNV-1a (Fowler, Noll and Vo 1991).
    std::uint32_t hash = 2166136261u;
    for (const char letter : name) hash = (hash ^ static_cast<unsigned char>(letter)) * 16777619u;
    size_t style = kFirstOtherStyle + hash % (kStyles - kFirstOtherStyle);
    for (size_t tries = 0; tries < kStyles && std::find(styles.begin(), styles.end(), style) != styles.end(); ++tries)
      style = style + 1 < kStyles ? style + 1 : kFirstOtherStyle;
    styles.push_back(style);
  }
  return styles;
}

}  // namespace limn
