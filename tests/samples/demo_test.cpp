// limn demo: a page, every file it leads to, and the calls that it shows.

#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "raymarch/border.h"
#include "samples/scenes/scenes.h"
#include "tests/samples/run_program.h"

namespace limn {
namespace {

std::vector<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; ++it) found.push_back((*it)[1]);
  return found;
}

TEST(Demo, PageLeadsToFilesThatAreThereAndShowsCallsThatMakeThem) {
  const TemporaryFolder folder;
  const RunResult run = run_limn({"demo", "--size", "64x48", "-o", folder.file("demo"), "--no-timings"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const std::filesystem::path demo = folder.file("demo");
  const std::string page = read_bytes(demo / "index.html");
  for (const char* attribute : {"src=\"([^\"]*)\"", "href=\"([^\"]*)\""}) {
    const std::vector<std::string> files = matches(page, attribute);
    EXPECT_GE(files.size(), 4u) << attribute;
    for (const std::string& file : files) EXPECT_TRUE(std::filesystem::is_regular_file(demo / file)) << file;
  }
  for (const SceneDescriptor& scene : scenes()) EXPECT_NE(page.find(scene.about.name + ".png"), std::string::npos) << scene.about.name;
  for (const std::string& method : border_methods().names())
    EXPECT_NE(page.find("methods/" + method + ".png"), std::string::npos) << method;

  // Two of the calls, as they stand on the page, make the same bytes again.
  const std::vector<std::string> calls = matches(page, "<code>limn ([^<]*)</code>");
  ASSERT_EQ(calls.size(), 12 + scenes().names().size() + border_methods().names().size() + 4);
  for (const std::string& call : {calls.front(), calls[calls.size() - 2]}) {
    std::istringstream words(call);
    std::vector<std::string> arguments;
    for (std::string word; words >> word;) arguments.push_back(word);
    const RunResult again = run_limn(arguments, folder.file(""));
    ASSERT_EQ(again.exit_code, 0) << call << "\n" << again.err;
    EXPECT_EQ(read_bytes(folder.file("") / std::filesystem::path(arguments.back())), read_bytes(demo / arguments.back())) << call;
  }
}

TEST(Demo, RefusesAFolderThatIsAFileBeforeAnythingIsDrawn) {
  const TemporaryFolder folder;
  const std::string file = folder.write("taken", "text");
  const RunResult run = run_limn({"demo", "-o", file});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("is a file"), std::string::npos) << run.err;
  EXPECT_EQ(read_bytes(file), "text");
}

}  // namespace
}  // namespace limn
