#pragma once
// What `limn demo` draws: calls of the program itself, so that the page can show how to make each picture.

#include <filesystem>
#include <string>
#include <vector>

namespace limn {

/// One call of the program, and the file it makes that the page shows.
struct DemoCall {
  std::string section;                 ///< Heading on the page, and what progress says: "Scenes".
  std::string caption;                 ///< "machined part".
  std::vector<std::string> arguments;  ///< Without the output: {"render", "rook"}; "$OUT/" stands for the demo's folder.
  std::filesystem::path output;        ///< Of --output, relative to the demo's folder.
  std::filesystem::path picture;       ///< Relative to the demo's folder; shown on the page.
  std::filesystem::path page{};        ///< A report that the picture leads to; empty: none.
};

/// The gallery (samples/gallery.txt), every built-in scene, three of them compared, and every outline method on one; in the order of the
/// page. `size`: of every picture, as
/// --size takes it; empty: each call's own.
std::vector<DemoCall> demo_calls(const std::string& size);

/// "limn render rook -o rook.png", quoted for a shell where it must be.
std::string shell_text(const DemoCall& call);

/// What stands in quotes or between spaces, as a shell reads it.
std::vector<std::string> shell_words(const std::string& line);

/// Texts that are part of the program: samples/gallery.txt, and the scene that it draws.
const char* gallery_text();
const char* still_life_text();

/// index.html: the pictures with their calls. No requests to anywhere but the files beside it.
std::string demo_page(const std::vector<DemoCall>& calls);

}  // namespace limn
