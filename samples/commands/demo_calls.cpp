#include "samples/commands/demo_calls.h"

#include <algorithm>
#include <sstream>

#include "raymarch/border.h"
#include "samples/scenes/scenes.h"
#include "sdf/error.h"

namespace limn {
namespace {

/// Two that have a formula and one cage, so that every representation occurs.
constexpr const char* kCompared[] = {"ellipsoid", "machined_part", "teacup"};
/// By every method: it is a mesh, as some of them need, with flat faces, round ones and edges.
constexpr const char* kDrawn = "rook";

std::string heading(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

constexpr std::string_view kFolder = "$OUT/";

/// "limn render teacup --look toon -o $OUT/gallery/teacup-toon.png".
DemoCall gallery_call(const std::string& line) {
  std::vector<std::string> words = shell_words(line);
  LIMN_CHECK(words.size() > 4 && words[0] == "limn" && words[words.size() - 2] == "-o" && words.back().starts_with(kFolder));
  const std::filesystem::path file = words.back().substr(kFolder.size());
  std::string caption = file.stem().string();
  std::replace(caption.begin(), caption.end(), '-', ' ');
  return {"Gallery", caption, {words.begin() + 1, words.end() - 2}, file, file};
}

DemoCall scene_call(const std::string& scene) {
  const std::string file = scene + ".png";
  return {"Scenes", heading(scene), {"render", scene, "--size", "640x480"}, file, file};
}

DemoCall compare_call(const std::string& scene) {
  const std::string folder = "compare-" + scene;
  return {"Comparisons", heading(scene), {"compare", scene}, folder, scene + ".png", folder + "/report.html"};
}

DemoCall method_call(const std::string& method) {
  const std::string file = "methods/" + method + ".png";
  return {"Outline methods",
          method,
          {"render", kDrawn, "--method", method, "--size", "480x480", "--samples", "4", "--background", "1,1,1"},
          file,
          file};
}

}  // namespace

std::vector<DemoCall> demo_calls(const std::string& size) {
  std::vector<DemoCall> calls;
  std::istringstream gallery(gallery_text());
  for (std::string line; std::getline(gallery, line);) {
    if (!line.empty() && line.front() != '#') calls.push_back(gallery_call(line));
  }
  for (const SceneDescriptor& scene : scenes()) calls.push_back(scene_call(scene.about.name));
  for (const char* const scene : kCompared) calls.push_back(compare_call(scene));
  for (const BorderMethod& method : border_methods()) calls.push_back(method_call(method.about.name));
  calls.push_back({"Outline methods",
                   "all methods on all models",
                   {"compare", kDrawn, "--methods", "all", "--voxels", "128", "--size", "960x720"},
                   "compare-methods",
                   "compare-methods/sheet.png",
                   "compare-methods/report.html"});
  if (size.empty()) return calls;
  for (DemoCall& call : calls) {
    const auto option = std::find(call.arguments.begin(), call.arguments.end(), "--size");
    if (option != call.arguments.end()) call.arguments.erase(option, option + 2);
    call.arguments.insert(call.arguments.end(), {"--size", size});
  }
  return calls;
}

std::vector<std::string> shell_words(const std::string& line) {
  std::vector<std::string> words;
  bool quoted = false, inside = false;
  for (const char c : line) {
    if (c == '\'') quoted = !quoted;
    if (c == ' ' && !quoted) {
      inside = false;
      continue;
    }
    if (!inside) words.emplace_back();
    inside = true;
    if (c != '\'') words.back() += c;
  }
  return words;
}

std::string shell_text(const DemoCall& call) {
  const auto quoted = [](const std::string& argument) {
    constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=,:+";
    return argument.find_first_not_of(kPlain) == std::string::npos && !argument.empty() ? argument : "'" + argument + "'";
  };
  std::string text = "limn";
  for (const std::string& argument : call.arguments)
    text += " " + quoted(argument.starts_with(kFolder) ? argument.substr(kFolder.size()) : argument);
  return text + " -o " + quoted(call.output.generic_string());
}

}  // namespace limn
