// Nothing writes over what it reads, two do not write into one folder, and what is unfinished is marked.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>

#include "run_program.h"
#include "samples/output/folder_lock.h"
#include "samples/output/output.h"
#include "samples/output/progress.h"
#include "samples/study/journal.h"
#include "sdf/error.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// Refused with one line that says why, and not a byte of the input is changed.
testing::AssertionResult is_input_kept(const std::vector<std::string>& call, const TemporaryFolder& folder, const std::string& input) {
  const std::string before = read_bytes(folder.path() / input);
  const RunResult result = run_limn(call, folder.path());
  const bool is_refused = result.exit_code == 2 && result.err_lines() == 1 && result.err.find("is the input") != std::string::npos;
  const bool same = read_bytes(folder.path() / input) == before;
  return (is_refused && same ? testing::AssertionSuccess() : testing::AssertionFailure())
         << call.front() << " to " << call.back() << " ended with " << result.exit_code << (same ? "" : ", the input is changed") << ": "
         << result.err;
}

TEST(OutputSafety, TheInputIsNeverWrittenOver) {
  const TemporaryFolder folder;
  folder.write("cage.obj", kTetrahedron);
  fs::create_directory(folder.path() / "below");
  fs::create_symlink("../cage.obj", folder.path() / "below/soft.obj");
  fs::create_hard_link(folder.path() / "cage.obj", folder.path() / "hard.obj");
  for (const std::string& name : {std::string("cage.obj"), std::string("./below/../cage.obj"), folder.file("cage.obj"),
                                  std::string("below/soft.obj"), std::string("hard.obj")}) {
    EXPECT_TRUE(is_input_kept({"export", "cage.obj", "--level", "1", "-o", name}, folder, "cage.obj"));
    EXPECT_TRUE(is_input_kept({"export", name, "--level", "1", "-o", "cage.obj"}, folder, "cage.obj"));
  }
  // Another file beside it is fine.
  EXPECT_EQ(run_limn({"export", "cage.obj", "--level", "1", "-o", "new.obj", "-q"}, folder.path()).exit_code, 0);
}

TEST(OutputSafety, NorAreTheFilesThatASceneNames) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_limn({"export", "ellipsoid", "--voxels", "16", "-o", folder.file("ball.vdb"), "-q"}).exit_code, 0);
  folder.write("part.obj", kTetrahedron);
  folder.write("scene.toml", "[[object]]\nmesh = \"part.obj\"\n");
  EXPECT_TRUE(is_input_kept({"export", "scene.toml", "-o", "part.obj"}, folder, "part.obj"));
  folder.write("volume.toml", "[[object]]\nvdb = \"ball.vdb\"\n");
  EXPECT_TRUE(is_input_kept({"export", "volume.toml", "-o", "ball.vdb"}, folder, "ball.vdb"));
  EXPECT_TRUE(is_input_kept({"export", "ball.vdb", "-o", "ball.vdb"}, folder, "ball.vdb"));
}

TEST(OutputSafety, NorByTheFilesOfAFolder) {
  const TemporaryFolder folder;
  folder.write("mesh.obj", kTetrahedron);
  fs::create_directory(folder.path() / "out");
  fs::create_symlink("../mesh.obj", folder.path() / "out/rows.json");
  fs::create_symlink("../mesh.obj", folder.path() / "out/rows.csv");
  fs::create_symlink("mesh.obj", folder.path() / "picture.png");
  EXPECT_TRUE(is_input_kept({"compare", "mesh.obj", "--size", "16x12", "-o", "out"}, folder, "mesh.obj"));
  EXPECT_TRUE(is_input_kept({"study", "mesh.obj", "--size", "16x12", "-o", "out"}, folder, "mesh.obj"));
  EXPECT_TRUE(is_input_kept({"render", "mesh.obj", "--size", "16x12", "-o", "picture.png"}, folder, "mesh.obj"));
}

TEST(OutputSafety, StartingAStudyOverTakesNoInputAway) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "study/cells");
  folder.write("study/cells/mesh.obj", kTetrahedron);
  const RunResult result = run_limn({"study", folder.file("study/cells/mesh.obj"), "--fresh", "-o", folder.file("study")});
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_NE(result.err.find("--fresh"), std::string::npos) << result.err;
  EXPECT_EQ(read_bytes(folder.path() / "study/cells/mesh.obj"), kTetrahedron);
}

TEST(OutputSafety, APartIsNotMergedIntoItself) {
  const TemporaryFolder folder;
  for (const char* shard : {"1/2", "2/2"})
    ASSERT_EQ(run_limn({"study", "ellipsoid", "--size", "16x12", "--views", "1", "--surfaces", "level_set", "--voxels", "8,12",
                        "--gradients", "cell", "--shard", shard, "-o", folder.file("s"), "-q"})
                  .exit_code,
              0);
  const std::string part = folder.file("s/part-1-of-2");
  const std::string before = read_bytes(part + "/rows.jsonl");
  const RunResult result = run_limn({"merge", folder.file("s"), "-o", part});
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_NE(result.err.find("part 1 of 2"), std::string::npos) << result.err;
  EXPECT_EQ(read_bytes(part + "/rows.jsonl"), before);
  EXPECT_EQ(run_limn({"merge", folder.file("s"), "-o", folder.file("s"), "-q"}).exit_code, 0) << "beside its parts it may stand";
}

const std::vector<std::string> kCompare = {"compare", "ellipsoid", "--size", "32x24", "--voxels", "16", "--no-timings", "-q", "-o"};

std::vector<std::string> compare_into(const std::string& folder) {
  std::vector<std::string> call = kCompare;
  call.push_back(folder);
  return call;
}

TEST(OutputSafety, AComparisonLocksItsFolder) {
  const TemporaryFolder folder;
  {
    fs::create_directory(folder.path() / "out");
    const FolderLock lock(folder.path() / "out");
    const RunResult result = run_limn(compare_into(folder.file("out")));
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_NE(result.err.find("locked by another limn process"), std::string::npos) << result.err;
    EXPECT_TRUE(folder.files().empty());
  }
  EXPECT_EQ(run_limn(compare_into(folder.file("out"))).exit_code, 0);
  EXPECT_FALSE(fs::exists(folder.path() / "out/compare.unfinished"));
}

TEST(OutputSafety, AComparisonThatIsKilledLeavesTheOldOneWholeAndIsMarked) {
  const TemporaryFolder folder;
  const std::string out = folder.file("out");
  ASSERT_EQ(run_limn(compare_into(out)).exit_code, 0);
  std::map<std::string, std::string> old;
  for (const std::string& name : folder.files()) old[name] = read_bytes(folder.path() / name);
  ASSERT_EQ(old.size(), 7u) << "four models, a sheet, rows and a page";
  // Killed as soon as it says that it is at work, however fast the machine is.
  const std::string program = LIMN_PROGRAM;
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl(program.c_str(), program.c_str(), "compare", "ellipsoid", "--size", "640x480", "--voxels", "300", "-q", "-o", out.c_str(),
            nullptr);
    ::_exit(97);
  }
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  const auto is_marked = [&] { return fs::exists(fs::path(out) / "compare.unfinished"); };
  while (!is_marked() && std::chrono::steady_clock::now() < until) ::usleep(500);
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(is_marked());
  for (const auto& [name, bytes] : old) EXPECT_EQ(read_bytes(folder.path() / name), bytes) << name;
  // The next one finishes, and takes the mark away.
  ASSERT_EQ(run_limn(compare_into(out)).exit_code, 0);
  EXPECT_FALSE(fs::exists(fs::path(out) / "compare.unfinished"));
  for (const auto& [name, bytes] : old) EXPECT_EQ(read_bytes(folder.path() / name), bytes) << name;
}

TEST(OutputSafety, WhatSomebodyElseKeepsInTheUnfinishedFolderStays) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "out/compare.unfinished");
  folder.write("out/compare.unfinished/notes.txt", "mine");
  ASSERT_EQ(run_limn(compare_into(folder.file("out"))).exit_code, 0);
  EXPECT_EQ(read_bytes(folder.path() / "out/compare.unfinished/notes.txt"), "mine");
}

/// With stderr a terminal, as openpty makes one.
bool shows_progress(const char* terminal) {
  int master = -1, slave = -1;
  if (::openpty(&master, &slave, nullptr, nullptr, nullptr) != 0) throw std::runtime_error("no terminal to be had");
  const int kept = ::dup(STDERR_FILENO);
  ::dup2(slave, STDERR_FILENO);
  const char* const before = ::getenv("TERM");
  const std::string old = before ? before : "";
  terminal ? ::setenv("TERM", terminal, 1) : ::unsetenv("TERM");
  const bool shown = wants_progress(false, false);
  before ? ::setenv("TERM", old.c_str(), 1) : ::unsetenv("TERM");
  ::dup2(kept, STDERR_FILENO);
  for (const int handle : {kept, master, slave}) ::close(handle);
  return shown;
}

TEST(Progress, ADumbTerminalGetsNoEscapeCodes) {
  EXPECT_TRUE(shows_progress("xterm"));
  EXPECT_FALSE(shows_progress("dumb"));
  EXPECT_FALSE(shows_progress(""));
  EXPECT_FALSE(shows_progress(nullptr));
}

TEST(SceneFiles, AMissingFileIsToldWithItsLine) {
  const TemporaryFolder folder;
  const std::string scene = folder.write(
      "scene.toml", "[[object]]\nshape = \"sphere\"\n\n[[object]]\nname = \"two\"\nmesh = \"nothing.obj\"\nscheme = \"loop\"\n");
  const RunResult result = run_limn({"render", scene}, folder.path());
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("scene.toml:6:8:object[1].mesh: "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("nothing.obj: no such file"), std::string::npos) << result.err;
  const std::string volume = folder.write("volume.toml", "[[object]]\n  vdb = \"nothing.vdb\"\n");
  EXPECT_NE(run_limn({"render", volume}, folder.path()).err.find("volume.toml:2:9:object[0].vdb: "), std::string::npos);
  const std::string number = folder.write("number.toml", "[[object]]\nmesh = 3\n");
  EXPECT_NE(run_limn({"render", number}, folder.path()).err.find("number.toml:2:8:object[0].mesh: not text (got 3"), std::string::npos);
  // What is wrong within a file is told with that file's own line.
  folder.write("bad.obj", "v 0 0 0\nv 1 0 zero\n");
  const std::string bad = folder.write("bad.toml", "[[object]]\nmesh = \"bad.obj\"\n");
  EXPECT_NE(run_limn({"render", bad}, folder.path()).err.find("bad.obj:2"), std::string::npos);
}

TEST(Background, TakesColorsAndRefusesWhatIsBrighterThanWhite) {
  const TemporaryFolder folder;
  const auto picture = [&](const std::string& color) {
    const std::string file = folder.file("a.png");
    const RunResult result =
        run_limn({"render", "ellipsoid", "--size", "16x12", "--samples", "1", "--background", color, "-o", file, "-q"});
    return result.exit_code == 0 ? read_bytes(file) : "refused: " + result.err;
  };
  const std::string gray = picture("#808080");
  EXPECT_FALSE(gray.starts_with("refused")) << gray;
  EXPECT_EQ(picture("gray"), gray);
  EXPECT_EQ(picture("0.2158605,0.2158605,0.2158605"), gray);
  EXPECT_EQ(picture("#fff"), picture("1,1,1"));
  for (const char* wrong : {"255,255,255", "1,1,1.5", "-1,0,0", "linear:-1,0,0", "#12345", "reddish", "1,1", "nan,0,0", "linear:"}) {
    const std::string said = picture(wrong);
    EXPECT_TRUE(said.starts_with("refused: limn: --background: ")) << wrong << ": " << said;
    EXPECT_NE(said.find("#rrggbb"), std::string::npos) << said;
  }
  EXPECT_EQ(picture("linear:2,2,2"), picture("white")) << "a PNG ends at white";
  const std::string scene = folder.write("red.toml", "[[object]]\nshape = \"sphere\"\ncolor = \"#ff8000\"\n[border]\ncolor = \"navy\"\n");
  const std::string same =
      folder.write("same.toml", "[[object]]\nshape = \"sphere\"\ncolor = [1, 0.2158605, 0]\n[border]\ncolor = [0, 0, 0.2158605]\n");
  for (const std::string& one : {scene, same})
    ASSERT_EQ(run_limn({"render", one, "--size", "16x12", "-o", one + ".png", "-q"}).exit_code, 0);
  EXPECT_EQ(read_bytes(scene + ".png"), read_bytes(same + ".png"));
}

}  // namespace
}  // namespace limn
