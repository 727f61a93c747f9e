// Names in any bytes: JSON stays JSON, pages stay pages.

#include <gtest/gtest.h>

#include <random>

#include "run_program.h"
#include "samples/page/html.h"
#include "samples/spec/utf8.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

constexpr const char* kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// Every name that a file may have and a careless writer falls over.
std::vector<std::string> odd_names() {
  return {"bytes \xff\xfe\xc3(",    "quote \" and 'apostrophe'",   "line\nbreak", "<script>alert(1)<", "back\\slash", "&amp; \x01\x1b[31m",
          "\xed\xa0\x80 surrogate", "\xf0\x9f\xab\x96 caf\xc3\xa9"};
}

/// True where the JSON library, which knows UTF-8 by tables of its own, writes the text without complaint.
bool is_utf8(const std::string& text) {
  try {
    nlohmann::json(text).dump();
    return true;
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

TEST(ValidUtf8, KeepsWhatIsValidAndReplacesTheRest) {
  EXPECT_EQ(valid_utf8("plain caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\xab\x96"), "plain caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\xab\x96");
  EXPECT_EQ(valid_utf8("a\xff"
                       "b"),
            "a\xef\xbf\xbd"
            "b");
  EXPECT_EQ(valid_utf8("\xc3"), "\xef\xbf\xbd") << "cut short";
  EXPECT_EQ(valid_utf8("\xc0\xaf"), "\xef\xbf\xbd\xef\xbf\xbd") << "longer than it need be";
  EXPECT_EQ(valid_utf8("\xf4\x90\x80\x80").find('\xf4'), std::string::npos) << "beyond Unicode";
}

TEST(ValidUtf8, RandomBytesBecomeWhatJsonTakes) {
  const unsigned seed = random_seed();
  std::mt19937 random(seed);
  // Few values, so that sequences that begin well are frequent.
  const std::string bytes(
      "\x00"
      "a\x7f\x80\x90\x9f\xa0\xbf\xc1\xc2\xdf\xe0\xe1\xed\xef\xf0\xf1\xf4\xf5\xff",
      20);
  int invalid = 0;
  for (int k = 0; k < 20'000; ++k) {
    std::string text;
    for (size_t i = random() % 8; i-- > 0;) text += bytes[random() % bytes.size()];
    const bool valid = is_utf8(text);
    invalid += valid ? 0 : 1;
    ASSERT_EQ(valid_utf8(text) == text, valid) << "seed " << seed << " round " << k;
    ASSERT_TRUE(is_utf8(valid_utf8(text))) << "seed " << seed << " round " << k;
  }
  EXPECT_GT(invalid, 5'000);
}

TEST(Escaped, LeavesNothingThatEndsATextOrAnAttribute) {
  for (const std::string& name : odd_names()) {
    const std::string text = escaped(name);
    EXPECT_EQ(text.find_first_of("<>\"'\x01\x1b"), std::string::npos) << text;
    EXPECT_TRUE(is_utf8(text)) << text;
  }
  EXPECT_EQ(escaped("a < b & 'c'"), "a &lt; b &amp; &#39;c&#39;");
}

void expect_page(const std::filesystem::path& file) {
  const std::string page = read_bytes(file);
  ASSERT_FALSE(page.empty()) << file;
  EXPECT_TRUE(is_utf8(page)) << file;
  EXPECT_EQ(page.find("<script>alert"), std::string::npos) << file;
}

TEST(OddNames, EveryCommandWritesJsonAndPages) {
  const TemporaryFolder folder;
  const std::vector<std::string> names = odd_names();
  for (size_t k = 0; k < names.size(); ++k) {
    const std::string input = folder.write(names[k] + ".obj", kTetrahedron), out = folder.file("out-" + names[k]);
    const RunResult drawn = run_limn({"render", input, "--size", "24x18", "-o", out + ".exr", "-o", out + ".png", "--json"});
    ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
    EXPECT_EQ(drawn.json().at("files").size(), 2u);
    EXPECT_TRUE(std::filesystem::exists(out + ".png")) << "the file has the name that was given";
    EXPECT_EQ(run_limn({"info", input, "--json"}).json().at("kind"), "mesh");
    const RunResult seen = run_limn({"info", out + ".exr", "--json"});
    EXPECT_EQ(seen.exit_code, 0) << seen.err;
    EXPECT_FALSE(seen.json().empty());
    // The slower commands take every other name.
    if (k % 2 == 1) continue;
    const RunResult compared = run_limn({"compare", input, "--size", "24x18", "--voxels", "12", "-o", out + "-c", "--json"});
    ASSERT_EQ(compared.exit_code, 0) << compared.err;
    EXPECT_FALSE(compared.json().at("files").empty());
    EXPECT_FALSE(nlohmann::json::parse(read_bytes(out + "-c/rows.json")).empty());
    expect_page(out + "-c/report.html");
  }
}

TEST(OddNames, AStudyGoesOnInItsFolder) {
  const TemporaryFolder folder;
  const std::string input = folder.write("odd \xff\n\"<script>alert(1)<.obj", kTetrahedron), out = folder.file("study \xfe");
  const std::vector<std::string> call = {"study",       input,      "--size", "24x18",      "--views",
                                         "1",           "--voxels", "8,12",   "--surfaces", "mesh_level_set",
                                         "--gradients", "cell",     "-o",     out,          "--json"};
  const RunResult first = run_limn(call);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(first.json().at("cells"), 2);
  const std::string rows = read_bytes(out + "/rows.jsonl");
  EXPECT_TRUE(is_utf8(rows));
  EXPECT_TRUE(is_utf8(read_bytes(out + "/rows.csv")));
  expect_page(out + "/report.html");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(out)) {
    if (entry.path().extension() == ".svg") expect_page(entry.path());
  }
  // The same call again finds its own study, though JSON could not hold the name as it is.
  const RunResult again = run_limn(call);
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(read_bytes(out + "/rows.jsonl"), rows) << "nothing was measured anew";
}

}  // namespace
}  // namespace limn
