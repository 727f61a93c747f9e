#include "sdf/guard.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <random>

#include "sdf/error.h"
#include "sdf/output_file.h"
#include "tests/random_seed.h"
#include "tests/temporary_folder.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

void write_text(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

std::string read_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Helper programs of the test's own making, found through $LIMN_HELPERS.
class Guard : public testing::Test {
 protected:
  void SetUp() override { ::setenv("LIMN_HELPERS", folder_.path().c_str(), 1); }
  void TearDown() override { ::unsetenv("LIMN_HELPERS"); }

  void helper(const std::string& script) {
    write_text(folder_.path() / "helper", "#!/bin/sh\n" + script + "\n");
    fs::permissions(folder_.path() / "helper", fs::perms::owner_all);
  }
  std::string answer(const GuardLimits& limits = {}, const std::vector<std::string>& arguments = {}) {
    const MappedBytes bytes = run_guarded("helper", arguments, "model.abc", limits);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  std::string refusal(const GuardLimits& limits = {}) {
    try {
      answer(limits);
    } catch (const InputError& error) {
      EXPECT_EQ(error.fault().file, "model.abc");
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    ADD_FAILURE() << "no refusal";
    return {};
  }
  TemporaryFolder folder_;
};

TEST_F(Guard, TheAnswerIsWhatTheHelperWroteToItAndNothingElse) {
  helper("echo noise; echo noise >&2; printf 'a%s%s' \"$1\" \"$2\" >&3");
  EXPECT_EQ(answer({}, {"b c", "$HOME"}), "ab c$HOME");
}

TEST_F(Guard, ALongAnswerComesWhole) {
  helper("head -c 3000000 /dev/zero >&3");
  EXPECT_EQ(answer(), std::string(3000000, '\0'));
}

TEST_F(Guard, ARefusalIsTheHelpersOwnLine) {
  helper("printf 'face 3 names vertex 99' >&3; exit 2");
  EXPECT_EQ(refusal(), "model.abc: face 3 names vertex 99");
}

TEST_F(Guard, CrashTimeMemorySizeAndExitCodeAreToldApart) {
  helper("kill -SEGV $$");
  EXPECT_NE(refusal().find("crashed on it (Segmentation fault)"), std::string::npos) << refusal();
  helper("exit 3");
  EXPECT_NE(refusal().find("of memory"), std::string::npos) << refusal();
  helper("exit 77");
  EXPECT_NE(refusal().find("exit code 77"), std::string::npos) << refusal();
  helper("cat /dev/zero >&3");
  EXPECT_NE(refusal({.answer_bytes = 1 << 20}).find("more than 1 MB"), std::string::npos);
  helper("sleep 600");
  EXPECT_NE(refusal({.time = std::chrono::milliseconds(1000)}).find("longer than 1 s"), std::string::npos);
  helper("kill -XCPU $$");
  EXPECT_NE(refusal().find("processor time"), std::string::npos) << refusal();
}

TEST_F(Guard, AnAnswerThatGrowsWithoutEndIsCutOffWhoeverWritesIt) {
  // What the helper starts at once may have no limit of its own yet; it goes on while the helper waits.
  for (int k = 0; k < 20; ++k) {
    helper("head -c 400000000 /dev/zero >&3 & sleep 600");
    EXPECT_NE(refusal({.answer_bytes = 1 << 20}).find("more than 1 MB"), std::string::npos);
  }
}

TEST_F(Guard, NothingThatTheHelperStartedOutlivesIt) {
  // The helper's own child holds the answer open and would sleep for long after the helper is gone.
  helper("sleep 600 & echo $! > '" + (folder_.path() / "pid").string() + "'; printf done >&3");
  EXPECT_EQ(answer(), "done");
  const int pid = std::stoi(read_text(folder_.path() / "pid"));
  for (int i = 0; i < 500 && ::kill(pid, 0) == 0; ++i) {
    // A killed process whose parent is gone stays a zombie until the system's first process reaps it.
    if (read_text("/proc/" + std::to_string(pid) + "/stat").find(") Z ") != std::string::npos) break;
    ::usleep(10'000);
  }
  const std::string state = read_text("/proc/" + std::to_string(pid) + "/stat");
  EXPECT_TRUE(state.empty() || state.find(") Z ") != std::string::npos) << state;
}

TEST_F(Guard, WhatOutlivesTheHelperCannotChangeItsAnswer) {
  // A session of its own: not in the helper's group, and not ended with it.
  write_text(folder_.path() / "rest", "cd '" + folder_.path().string() + "'\n: > started\nuntil [ -e now ]; do sleep 0.01; done\n" +
                                          "printf MORE 1<> /proc/self/fd/3\n: > tried\n");
  helper("cd '" + folder_.path().string() + "'; setsid sh ./rest & until [ -e '" + (folder_.path() / "started").string() +
         "' ]; do sleep 0.01; done; printf done >&3");
  const MappedBytes bytes = run_guarded("helper", {}, "model.abc");
  const auto text = [&] { return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()); };
  EXPECT_EQ(text(), "done");
  write_text(folder_.path() / "now", "");
  for (int i = 0; i < 3000 && !fs::exists(folder_.path() / "tried"); ++i) ::usleep(10'000);
  EXPECT_TRUE(fs::exists(folder_.path() / "tried"));
  EXPECT_EQ(text(), "done");
}

TEST_F(Guard, NoZombieIsLeft) {
  helper("kill -SEGV $$");
  refusal();
  helper("sleep 600");
  refusal({.time = std::chrono::milliseconds(50)});
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a child is still there";
  EXPECT_EQ(errno, ECHILD);
}

TEST_F(Guard, TheHelperInheritsNoOpenFile) {
  const int handle = ::dup(STDERR_FILENO);
  helper("ls /proc/self/fd | tr '\\n' ' ' >&3");
  // 0-2 are the null device, 3 the answer; ls opens the folder itself as the next one.
  EXPECT_EQ(answer(), "0 1 2 3 4 ");
  ::close(handle);
}

TEST_F(Guard, AMissingHelperIsTheMachinesFault) {
  const auto run = [] { run_guarded("limn-no-such-helper", {}, "model.abc"); };
  EXPECT_THROW(run(), MachineError);
}

TEST(GuardBytes, WhatIsWrittenIsReadAndAnAnswerCutAnywhereIsRefused) {
  ByteWriter writer;
  writer.put(std::int32_t{-7});
  writer.put_text("torus");
  writer.put_span(std::span<const double>(std::vector<double>{1.5, 2.5}));
  const auto read = [](std::span<const std::byte> bytes) {
    ByteReader reader(bytes, "model.abc");
    EXPECT_EQ(reader.get<std::int32_t>(), -7);
    EXPECT_EQ(reader.get_text(), "torus");
    EXPECT_EQ(reader.get_vector<double>(), (std::vector<double>{1.5, 2.5}));
    EXPECT_TRUE(reader.done());
  };
  read(writer.bytes());
  for (size_t size = 0; size < writer.size(); ++size)
    EXPECT_THROW(
        {
          ByteReader reader(std::span(writer.bytes()).first(size), "model.abc");
          reader.get<std::int32_t>();
          reader.get_text();
          reader.get_vector<double>();
        },
        InputError)
        << size;
  // A count that would overflow when multiplied by the size of its items.
  ByteWriter huge;
  huge.put(std::uint64_t{1} << 61);
  EXPECT_THROW(ByteReader(huge.bytes(), "model.abc").get_vector<double>(), InputError);
}

/// A file in memory, as helpers have it.
class MemoryFile {
 public:
  MemoryFile() : handle_(::memfd_create("limn-test", MFD_CLOEXEC)) {}
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { ::close(handle_); }
  int handle() const { return handle_; }

 private:
  int handle_;
};

struct Triple {
  std::int32_t a, b, c;
  bool operator==(const Triple&) const = default;
};

/// Texts, numbers, elements in place and parts within parts, some of them taken back again: as much as a few pages or many.
void put_many(ByteWriter& writer, std::mt19937& random, int depth) {
  for (int k = 0; k < 12; ++k) {
    const std::size_t count = random() % (k % 4 == 0 ? 20'000 : 20);
    const std::size_t before = writer.size();
    switch (random() % 4) {
      case 0:
        writer.put_text(std::string(count, static_cast<char>('a' + k)));
        break;
      case 1:
        writer.put(static_cast<std::uint8_t>(count));
        break;
      case 2: {
        const std::span<Triple> room = writer.put_room<Triple>(count);
        for (std::size_t i = 0; i < count; ++i) room[i] = {k, static_cast<std::int32_t>(i), static_cast<std::int32_t>(count)};
        break;
      }
      default: {
        if (depth == 0) break;
        const std::size_t begun = writer.begin_part();
        put_many(writer, random, depth - 1);
        writer.end_part(begun);
      }
    }
    if (random() % 5 == 0) {
      writer.shrink(before);
      writer.put_text("taken back");
    }
  }
}

void read_many(ByteReader& reader, std::mt19937& random, int depth) {
  // The same draws tell what was put; what was taken back is drawn, too, but not there.
  for (int k = 0; k < 12; ++k) {
    const std::size_t count = random() % (k % 4 == 0 ? 20'000 : 20);
    const auto what = random() % 4;
    const bool nested = what == 3 && depth > 0;
    std::mt19937 within = random;
    if (nested) {
      ByteWriter skipped;
      put_many(skipped, random, depth - 1);
    }
    if (random() % 5 == 0) {
      ASSERT_EQ(reader.get_text(), "taken back");
    } else if (what == 0) {
      ASSERT_EQ(reader.get_text(), std::string(count, static_cast<char>('a' + k)));
    } else if (what == 1) {
      ASSERT_EQ(reader.get<std::uint8_t>(), static_cast<std::uint8_t>(count));
    } else if (what == 2) {
      const std::span<const Triple> found = reader.get_in_place<Triple>();
      ASSERT_EQ(found.size(), count);
      for (std::size_t i = 0; i < count; ++i)
        ASSERT_EQ(found[i], (Triple{k, static_cast<std::int32_t>(i), static_cast<std::int32_t>(count)}));
    } else if (nested) {
      ByteReader part(reader.get_bytes(), "model.abc");
      read_many(part, within, depth - 1);
      ASSERT_TRUE(part.done());
    }
  }
}

TEST(GuardBytes, WhatIsPutInMemoryAndIntoAFilesPagesIsFoundThere) {
  const unsigned seed = random_seed();
  for (unsigned round = 0; round < 20; ++round) {
    const MemoryFile file;
    ByteWriter in_memory, in_file(file.handle());
    for (ByteWriter* const writer : {&in_memory, &in_file}) {
      std::mt19937 random(seed + round);
      put_many(*writer, random, 2);
    }
    ASSERT_TRUE(in_file.finish());
    const MappedBytes mapped(file.handle());
    ASSERT_EQ(mapped.size(), in_memory.size());
    for (const std::span<const std::byte> bytes : {in_memory.bytes(), std::span<const std::byte>(mapped)}) {
      std::mt19937 random(seed + round);
      ByteReader reader(bytes, "model.abc");
      read_many(reader, random, 2);
      ASSERT_TRUE(reader.done()) << "round " << round;
    }
  }
}

TEST(GuardBytes, ACopyStaysAsItWasWhenTheFileChanges) {
  const MemoryFile file;
  const std::string before(300'000, 'a'), after(300'000, 'b');
  ASSERT_EQ(::write(file.handle(), before.data(), before.size()), static_cast<ssize_t>(before.size()));
  const MappedBytes copy = MappedBytes::copied(file.handle());
  ASSERT_EQ(::pwrite(file.handle(), after.data(), after.size(), 0), static_cast<ssize_t>(after.size()));
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(copy.data()), copy.size()), before);
}

TEST(GuardBytes, ElementsInPlaceThatBreakOffAreRefused) {
  ByteWriter writer;
  writer.put_text("x");
  const std::span<double> room = writer.put_room<double>(3);
  std::fill(room.begin(), room.end(), 2.5);
  const std::size_t begun = writer.begin_part();
  writer.put_text("within");
  writer.end_part(begun);
  const auto read = [](std::span<const std::byte> bytes) {
    ByteReader reader(bytes, "model.abc");
    reader.get_text();
    const std::span<const double> found = reader.get_in_place<double>();
    const std::string within = ByteReader(reader.get_bytes(), "model.abc").get_text();
    return within == "within" && found.size() == 3 && found[2] == 2.5 && reader.done();
  };
  EXPECT_TRUE(read(writer.bytes()));
  for (std::size_t size = 0; size < writer.size(); ++size) EXPECT_THROW(read(writer.bytes().first(size)), InputError) << size;
}

TEST(GuardBytes, AFileThatCannotBeMappedIsWrittenToInTheEnd) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ByteWriter writer(ends[1]);
  writer.put_text("through a pipe");
  EXPECT_TRUE(writer.finish());
  ::close(ends[1]);
  std::vector<std::byte> found(100);
  const ssize_t count = ::read(ends[0], found.data(), found.size());
  ::close(ends[0]);
  ASSERT_EQ(count, static_cast<ssize_t>(writer.size()));
  EXPECT_EQ(ByteReader(std::span(found).first(writer.size()), "model.abc").get_text(), "through a pipe");
}

TEST(Readable, MissingFoldersEmptyAndSpecialFilesAreRefusedByName) {
  const TemporaryFolder folder;
  write_text(folder.path() / "empty.vdb", "");
  write_text(folder.path() / "good.vdb", "x");
  EXPECT_NO_THROW(check_readable(folder.path() / "good.vdb", "a volume (.vdb)"));
  const auto problem = [&](const fs::path& file) -> std::string {
    try {
      check_readable(file, "a volume (.vdb)");
    } catch (const InputError& error) {
      EXPECT_EQ(error.fault().expected, "a volume (.vdb)");
      return error.fault().problem;
    }
    return "accepted";
  };
  EXPECT_EQ(problem(folder.path() / "none.vdb"), "no such file");
  EXPECT_EQ(problem(folder.path() / "good.vdb/inner.vdb"), "no such file");
  EXPECT_EQ(problem(folder.path()), "is a directory");
  EXPECT_EQ(problem(folder.path() / "empty.vdb"), "is empty");
  EXPECT_EQ(problem("/dev/null"), "is not a regular file");
}

size_t files_in(const fs::path& folder) {
  return static_cast<size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator{}));
}

TEST(OutputFile, AWriterThatThrowsLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  const fs::path target = folder.path() / "out.txt";
  write_whole(target, "old");
  const auto write = [&](const fs::path& path) {
    EXPECT_EQ(path.parent_path(), folder.path());
    EXPECT_EQ(path.extension(), ".txt");
    EXPECT_EQ(path.filename().string().rfind(".limn-", 0), 0u);
    write_text(path, "half of the new");
    EXPECT_EQ(read_text(target), "old") << "touched before the new one was whole";
    throw std::runtime_error("interrupted");
  };
  EXPECT_THROW(write_whole(target, write), std::runtime_error);
  EXPECT_EQ(read_text(target), "old");
  EXPECT_EQ(files_in(folder.path()), 1u);
}

TEST(OutputFile, ReplacesWholeMakesFoldersAndFollowsLinks) {
  const TemporaryFolder folder;
  const fs::path target = folder.path() / "a/b/out.txt";
  write_whole(target, "one");
  EXPECT_EQ(read_text(target), "one");
  fs::create_symlink(target, folder.path() / "link.txt");
  fs::permissions(target, fs::perms::owner_read | fs::perms::owner_write);
  write_whole(folder.path() / "link.txt", "two");
  EXPECT_EQ(read_text(target), "two");
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link.txt"));
  EXPECT_EQ(fs::status(target).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(files_in(target.parent_path()), 1u);
}

TEST(OutputFile, TargetsThatCannotBeFilesAreRefused) {
  const TemporaryFolder folder;
  write_text(folder.path() / "file", "x");
  EXPECT_THROW(write_whole(folder.path(), "x"), InputError);
  EXPECT_THROW(write_whole(folder.path() / "file/below.txt", "x"), InputError);
  EXPECT_THROW(write_whole("/dev/null", "x"), InputError);
  EXPECT_THROW(write_whole("", "x"), InputError);
  EXPECT_EQ(read_text(folder.path() / "file"), "x");
}

TEST(OutputFile, ASignalHandlerRemovesWhatIsOpenAndOnlyThat) {
  const TemporaryFolder folder;
  write_whole(folder.path() / "kept.txt", "kept");
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGTERM, [](int) {
      remove_temporary_files();
      ::_exit(42);
    });
    write_whole(folder.path() / "new.txt", [](const fs::path& path) {
      write_text(path, "half");
      ::raise(SIGTERM);
      // Not reached, but under the thread sanitizer, which hands signals on at the next atomic.
      write_whole(path.parent_path() / "late.txt", "late");
    });
    ::_exit(1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 42);
  EXPECT_EQ(files_in(folder.path()), 1u);
  EXPECT_EQ(read_text(folder.path() / "kept.txt"), "kept");
}

}  // namespace
}  // namespace limn
