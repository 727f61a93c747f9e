#include "listed_files.h"

#include <array>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace limn::foreign {

std::vector<ListedFile> listed_files(const std::filesystem::path& list) {
  std::vector<ListedFile> files;
  std::ifstream stream(list);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream words(line);
    std::array<std::string, 4> field{};
    for (std::string& each : field) std::getline(words, each, '\t');
    const std::string& outcome = field[2];
    const bool known = outcome == "drawn" || outcome == "drawn!" || outcome == "refused";
    if (!known || (outcome != "drawn" && field[3].empty()))
      throw std::runtime_error(list.string() + ":" + std::to_string(number) + ": expected GROUP, PATH, drawn or drawn! or refused, REASON");
    files.push_back({field[0], field[1], outcome != "refused", outcome == "drawn", field[3]});
  }
  if (files.empty()) throw std::runtime_error(list.string() + ": no such file, or nothing in it");
  return files;
}

std::filesystem::path folder_of(const std::string& group) {
  const char* const models = std::getenv("LIMN_MODELS");
  const std::filesystem::path folder = group == "assimp"   ? "/usr/share/assimp/models"
                                       : group == "cgal"   ? LIMN_CGAL_DATA
                                       : group == "data"   ? LIMN_TEST_DATA
                                       : models != nullptr ? models
                                                           : "";
  std::error_code ignored;
  return std::filesystem::is_directory(folder, ignored) ? folder : std::filesystem::path{};
}

}  // namespace limn::foreign
