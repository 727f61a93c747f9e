#include "samples/input/input_files.h"

#include "sdf/error.h"

namespace limn {

namespace fs = std::filesystem;

std::vector<std::filesystem::path> files_of(const SceneInput& input) {
  std::vector<std::filesystem::path> files;
  if (!input.file.empty()) files.emplace_back(input.file);
  for (const std::string& formula : input.formulas) files.emplace_back(formula);
  for (const SceneObject& object : input.scene.objects) {
    if (const auto* mesh = std::get_if<MeshSource>(&object.source); mesh != nullptr && !mesh->file.empty()) files.emplace_back(mesh->file);
    if (const auto* volume = std::get_if<LevelSetSource>(&object.source); volume != nullptr && !volume->file.empty())
      files.emplace_back(volume->file);
  }
  return files;
}

void check_not_input(const fs::path& file, const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs) {
    std::error_code ignored;
    if (!fs::equivalent(file, input, ignored)) continue;
    const std::string what = file == input ? "is the input itself" : "is the input " + input.string();
    throw InputError({file.string(), "output", "", what + "; choose another name", ""});
  }
}

void check_not_holding_input(const fs::path& folder, const std::vector<fs::path>& inputs, const std::string& who) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) return;
  for (const fs::path& input : inputs) {
    const fs::path real = fs::canonical(input, ignored);
    for (fs::path above = real.parent_path(); above.has_relative_path(); above = above.parent_path()) {
      if (!fs::equivalent(above, folder, ignored)) continue;
      throw InputError({folder.string(), "output", "",
                        "holds the input " + input.string() + " and is emptied by " + who + "; choose another folder", ""});
    }
  }
}

}  // namespace limn
