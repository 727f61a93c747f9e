#include "samples/commands/render_outputs.h"

#include <fmt/format.h>

#include <algorithm>

#include "samples/input/input_files.h"
#include "samples/output/output.h"
#include "sdf/error.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kEndings = {".exr", ".png", ".tif", ".tiff", ".jpg", ".jpeg", ".apng"};

}  // namespace

bool is_animated(const fs::path& file, const Options& options) {
  return ending_of(file) == ".apng" || (options.animate && ending_of(file) == ".png");
}

int pictures_of(const Options& options) { return std::max({options.spec.views, options.frames.frames, options.turntable}); }

bool has_frames(const Options& options) { return std::max(options.frames.frames, options.turntable) > 1; }
const char* name_of_one(const Options& options) { return has_frames(options) ? "frame" : "view"; }

// name.png, or name_v03.png for one of several views, name_f03.png for one of several frames.
fs::path picture_file(const fs::path& file, int index, const Options& options) {
  if (pictures_of(options) == 1 || is_animated(file, options)) return file;
  const auto digits = std::to_string(pictures_of(options) - 1).size();
  fs::path out = file;
  out.replace_filename(
      fmt::format("{}_{}{:0{}}{}", file.stem().string(), has_frames(options) ? 'f' : 'v', index, digits, file.extension().string()));
  return out;
}

std::vector<fs::path> outputs_of(const Options& options, const SceneInput& input) {
  if (!options.outputs.empty()) return options.outputs;
  const std::string name = default_output("render", input.name).string();
  return {name + ".exr", name + ".png"};
}

void check_outputs(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs, const Options& options) {
  for (size_t i = 0; i < outputs.size(); ++i) {
    const auto same = [&](const fs::path& other) { return fs::weakly_canonical(other) == fs::weakly_canonical(outputs[i]); };
    if (std::any_of(outputs.begin(), outputs.begin() + static_cast<std::ptrdiff_t>(i), same))
      throw InputError({outputs[i].string(), "--output", "", "is given twice", "a file of its own for each --output"});
  }
  for (const fs::path& file : outputs) {
    if (is_animated(file, options) && options.turntable == 0)
      throw InputError({file.string(), "--output", "", "plays frames, and there are none", ".png for one picture, or --turntable N"});
    for (int k = 0; k < pictures_of(options); ++k) {
      check_output_file(picture_file(file, k, options), options.no_clobber, kEndings);
      check_not_input(picture_file(file, k, options), inputs);
    }
  }
}

}  // namespace limn
