// Files that belong together: all new or all old, whatever fails.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "sdf/error.h"
#include "sdf/output_together.h"
#include "tests/temporary_folder.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

OutputFile text_file(const fs::path& target, const std::string& text) {
  return {target, [text](const fs::path& path) { std::ofstream(path) << text; }};
}

TEST(OutputTogether, AllTakeTheirPlaces) {
  const TemporaryFolder folder;
  folder.write("b", "old");
  const std::vector<OutputFile> files = {text_file(folder.path() / "a", "new a"), text_file(folder.path() / "b", "new b"),
                                         text_file(folder.path() / "below" / "c", "new c")};
  write_together(files);
  EXPECT_EQ(bytes_of(folder.path() / "a"), "new a");
  EXPECT_EQ(bytes_of(folder.path() / "b"), "new b");
  EXPECT_EQ(bytes_of(folder.path() / "below/c"), "new c");
  EXPECT_EQ(folder.files(), (std::vector<std::string>{"a", "b", "below/c"})) << "nothing else is left";
}

TEST(OutputTogether, WhereOneCannotBeWrittenAllOldOnesStay) {
  for (size_t failing = 0; failing < 3; ++failing) {
    const TemporaryFolder folder;
    std::vector<OutputFile> files;
    for (const char* name : {"a", "b", "c"}) {
      folder.write(name, std::string("old ") + name);
      files.push_back(text_file(folder.path() / name, std::string("new ") + name));
    }
    files[failing].write = [](const fs::path& path) {
      std::ofstream(path) << "half";
      throw MachineError("the disk is full");
    };
    EXPECT_THROW(write_together(files), MachineError);
    for (const char* name : {"a", "b", "c"}) EXPECT_EQ(bytes_of(folder.path() / name), std::string("old ") + name);
    EXPECT_EQ(folder.files(), (std::vector<std::string>{"a", "b", "c"})) << "nothing else is left";
  }
}

/// A place that turns into a folder while the file is written refuses the rename, after the others have been put in theirs.
TEST(OutputTogether, WhereOneCannotTakeItsPlaceAllOldOnesComeBack) {
  for (size_t failing = 0; failing < 3; ++failing) {
    const TemporaryFolder folder;
    std::vector<OutputFile> files;
    const std::vector<std::string> names = {"a", "b", "c"};
    for (const std::string& name : names) {
      if (name != names[failing]) folder.write(name, "old " + name);
      files.push_back(text_file(folder.path() / name, "new " + name));
    }
    // The last that is written makes it, when all are complete.
    const fs::path place = folder.path() / names[failing];
    files[2].write = [place](const fs::path& path) {
      std::ofstream(path) << "new c";
      fs::create_directory(place);
      std::ofstream(place / "kept") << "kept";
    };
    EXPECT_THROW(write_together(files), InputError) << failing;
    for (const std::string& name : names) {
      if (name == names[failing]) continue;
      EXPECT_EQ(bytes_of(folder.path() / name), "old " + name) << failing;
    }
    EXPECT_EQ(bytes_of(place / "kept"), "kept");
    EXPECT_EQ(folder.files().size(), 3u) << "nothing else is left";
  }
}

TEST(OutputTogether, ALinkIsWrittenThrough) {
  const TemporaryFolder folder;
  folder.write("real", "old");
  fs::create_symlink("real", folder.path() / "link");
  const std::vector<OutputFile> files = {text_file(folder.path() / "a", "new"), text_file(folder.path() / "link", "new")};
  write_together(files);
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
  EXPECT_EQ(bytes_of(folder.path() / "real"), "new");
}

/// Killed by SIGKILL at any moment, the pair is the old one, the new one, or has a gap: never an old file beside a new one.
TEST(OutputTogether, AKilledProcessLeavesNoOldFileBesideANewOne) {
  const TemporaryFolder folder;
  int rounds = 0;
  for (useconds_t wait_us = 0; wait_us < 6000; wait_us += 150) {
    for (const char* name : {"a", "b"}) folder.write(name, "0");
    const pid_t child = ::fork();
    if (child == 0) {
      for (int k = 1; k < 1'000'000; ++k) {
        const std::vector<OutputFile> files = {text_file(folder.path() / "a", std::to_string(k)),
                                               text_file(folder.path() / "b", std::to_string(k))};
        write_together(files);
      }
      ::_exit(0);
    }
    ::usleep(1000 + wait_us);
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    const fs::path a = folder.path() / "a", b = folder.path() / "b";
    EXPECT_TRUE(fs::exists(a)) << "its place is never empty";
    if (fs::exists(a) && fs::exists(b)) {
      EXPECT_EQ(bytes_of(a), bytes_of(b)) << "round " << rounds;
    }
    ++rounds;
  }
  EXPECT_EQ(rounds, 40);
}

}  // namespace
}  // namespace limn
