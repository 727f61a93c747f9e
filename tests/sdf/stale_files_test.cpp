// What killed processes leave, and what living ones are at work on.
#include "sdf/stale_files.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <string>
#include <vector>

#include "sdf/output_file.h"
#include "tests/temporary_folder.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

void write_text(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

/// A process in the middle of write_whole(target); it waits there until it is killed. Returns once the temporary file is there.
pid_t process_writing(const fs::path& target) {
  int ends[2];
  if (::pipe(ends) != 0) return -1;
  const pid_t child = ::fork();
  if (child == 0) {
    write_whole(target, [&](const fs::path& path) {
      write_text(path, "half");
      if (::write(ends[1], "x", 1) != 1) ::_exit(1);
      ::pause();
    });
    ::_exit(1);
  }
  char byte = 0;
  const bool there = ::read(ends[0], &byte, 1) == 1;
  ::close(ends[0]);
  ::close(ends[1]);
  return there ? child : -1;
}

void kill_and_reap(pid_t child) {
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
}

TEST(StaleFiles, WhatAKilledProcessLeftGoesAtTheNextWriteIntoTheFolder) {
  const TemporaryFolder folder;
  write_text(folder.path() / "out.txt", "old");
  const pid_t child = process_writing(folder.path() / "out.txt");
  ASSERT_GT(child, 0);
  EXPECT_EQ(names_in(folder.path()).size(), 2u) << "the child has no temporary file, so this proves nothing";
  kill_and_reap(child);
  EXPECT_EQ(names_in(folder.path()).size(), 2u);
  write_whole(folder.path() / "other.txt", "new");
  EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"other.txt", "out.txt"}));
}

TEST(StaleFiles, WhatALivingProcessWritesStays) {
  const TemporaryFolder folder;
  const pid_t child = process_writing(folder.path() / "out.txt");
  ASSERT_GT(child, 0);
  write_whole(folder.path() / "other.txt", "new");
  const std::vector<std::string> names = names_in(folder.path());
  kill_and_reap(child);
  ASSERT_EQ(names.size(), 2u);
  EXPECT_EQ(names.front().rfind(".limn-", 0), 0u) << names.front();
  EXPECT_EQ(names.back(), "other.txt");
}

TEST(StaleFiles, AnotherHostsFileStaysForADay) {
  const TemporaryFolder folder;
  const fs::path fresh = folder.path() / ".limn-nohost-1-0.txt", old = folder.path() / ".limn-nohost-2-0.txt";
  write_text(fresh, "x");
  write_text(old, "x");
  fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::hours(25));
  remove_stale_files(folder.path());
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{fresh.filename().string()});
}

TEST(StaleFiles, OnlyPlainFilesOfThatNameAreTouched) {
  const TemporaryFolder folder;
  const TemporaryFolder elsewhere;
  const fs::path kept = elsewhere.path() / "kept.txt";
  write_text(kept, "x");
  const std::string own = temporary_beside(folder.path() / "a.txt").filename().string();
  fs::create_symlink(kept, folder.path() / own);
  fs::create_directory(folder.path() / temporary_beside(folder.path() / "a.txt").filename());
  write_text(folder.path() / ".limnrc", "x");
  write_text(folder.path() / "a.limn-1-0", "x");
  const std::vector<std::string> before = names_in(folder.path());
  remove_stale_files(folder.path());
  EXPECT_EQ(names_in(folder.path()), before);
  EXPECT_TRUE(fs::exists(kept));
}

TEST(StaleFiles, AFileWithoutALockOnItIsTaken) {
  const TemporaryFolder folder;
  const fs::path own = temporary_beside(folder.path() / "a.txt");
  write_text(own, "x");
  const int handle = make_locked_file(temporary_beside(folder.path() / "b.txt"), 0666);
  ASSERT_GE(handle, 0);
  remove_stale_files(folder.path());
  EXPECT_EQ(names_in(folder.path()).size(), 1u) << "the locked one stays, the other one goes";
  EXPECT_FALSE(fs::exists(own));
  ::close(handle);
}

}  // namespace
}  // namespace limn
