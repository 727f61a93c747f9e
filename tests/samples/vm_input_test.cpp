// Formulas (.vm) as inputs and in scene files, through the program itself.

#include <gtest/gtest.h>

#include "run_program.h"

namespace limn {
namespace {

const char* const kTangle =
    "x var-x\ny var-y\nz var-z\na square x\nb square y\nc square z\nd mul a a\ne mul b b\nf square c\ng add d e\nh add g f\nfive const 5\n"
    "l add a b\nm add l c\nn mul m five\no sub h n\np const 11.8\nq add o p\n";
/// A disc of radius 0.5 in the plane, without end along z.
const char* const kDisc = "x var-x\ny var-y\na square x\nb square y\nc add a b\nd sqrt c\ne const 0.5\nout sub d e\n";

TEST(VmInput, IsDrawnAndInfoSaysThatItIsAField) {
  const TemporaryFolder folder;
  const std::string file = folder.write("tangle.vm", kTangle);
  const RunResult drawn = run_limn({"render", file, "--size", "160x120", "--json", "-q", "-o", folder.file("t.png")});
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_GT(drawn.json().at("hits").get<int>(), 4000) << drawn.out;
  EXPECT_TRUE(std::filesystem::exists(folder.file("t.png")));
  const RunResult info = run_limn({"info", file, "--json"});
  ASSERT_EQ(info.exit_code, 0) << info.err;
  EXPECT_EQ(info.json().at("kind"), "field") << info.out;
}

TEST(VmInput, WithoutEndIsRefusedWithTheRemedyThatThenWorks) {
  const TemporaryFolder folder;
  const std::string file = folder.write("disc.vm", kDisc);
  const RunResult refused = run_limn({"render", file, "-o", folder.file("d.png")});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(refused.err_lines(), 1) << refused.err;
  EXPECT_NE(refused.err.find("no end along z (which the file does not use)"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("csg = \"intersection\""), std::string::npos) << refused.err;
  const std::string scene = folder.write("disc.toml",
                                         "[[object]]\ncsg = \"intersection\"\n"
                                         "of = [ { vm = \"disc.vm\" }, { shape = \"box\", half = [2, 2, 0.1] } ]\n");
  const RunResult drawn = run_limn({"render", scene, "--size", "160x120", "--json", "-q", "-o", folder.file("d.png")});
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_GT(drawn.json().at("hits").get<int>(), 2000) << drawn.out;
}

TEST(VmInput, FaultsInAFileThatASceneNamesAreThatFiles) {
  const TemporaryFolder folder;
  folder.write("bad.vm", "x var-x\ny floor x\n");
  const RunResult bad = run_limn({"info", folder.write("bad.toml", "[[object]]\nvm = \"bad.vm\"\n")});
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_NE(bad.err.find("bad.vm:2: an operation with jumps"), std::string::npos) << bad.err;
  const RunResult missing = run_limn({"info", folder.write("missing.toml", "[[object]]\nvm = \"none.vm\"\n")});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_NE(missing.err.find("no such file"), std::string::npos) << missing.err;
  const RunResult both = run_limn({"info", folder.write("both.toml", "[[object]]\nvm = \"bad.vm\"\nshape = \"box\"\n")});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_NE(both.err.find("more than one of shape, csg, vm"), std::string::npos) << both.err;
}

TEST(VmInput, IsComparedWithItsModelsAndExported) {
  const TemporaryFolder folder;
  const std::string file = folder.write("tangle.vm", kTangle);
  const RunResult compared = run_limn({"compare", file, "--size", "96x72", "--voxels", "64", "--level", "2", "-q", "-o", folder.file("c")});
  EXPECT_EQ(compared.exit_code, 0) << compared.err;
  const RunResult exported = run_limn({"export", file, "--surface", "mesh", "--level", "2", "-q", "-o", folder.file("t.ply")});
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  const RunResult again = run_limn({"render", folder.file("t.ply"), "--size", "160x120", "--json", "-q", "-o", folder.file("p.png")});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_GT(again.json().at("hits").get<int>(), 4000);
}

}  // namespace
}  // namespace limn
