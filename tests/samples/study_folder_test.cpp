// Rows on the disk: nothing half-written survives, parts make the whole.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>

#include "run_program.h"
#include "samples/output/folder_lock.h"
#include "samples/study/folder.h"
#include "sdf/error.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

/// A study of `count` cells that nobody ran.
StudyRecord some_record(int count, const std::string& id = "id") {
  StudyRecord record;
  record.head.id = id;
  record.head.input = record.head.scene = "egg";
  record.head.call = "limn study egg --size 64x48 --views 1 --levels 0,1,2";
  record.version = "1";
  record.input_hash = "hash";
  for (int i = 0; i < count; ++i) record.cells.push_back({"cell" + std::to_string(i), "mesh, level " + std::to_string(i)});
  record.head.cells = count;
  return record;
}

std::vector<StudyRow> some_cell(int index, double build_ms = 1.0) {
  std::vector<StudyRow> rows;
  for (const char* metric : {"border_shift", "overlap", "normal_error_mean"}) {
    StudyRow row;
    row.key = "cell" + std::to_string(index);
    row.scene = "egg";
    row.surface = "mesh";
    row.surface_parameters = {{"level", std::to_string(index)}, {"normals", "vertex"}};
    row.method = "rim";
    row.metric = metric;
    row.value = 1.0 / (index + 3.0);
    row.unit = "px";
    row.build = timing_of({build_ms});
    rows.push_back(row);
  }
  return rows;
}

std::vector<StudyRow> failed_cell(int index) {
  StudyRow row = some_cell(index).front();
  row.metric.clear();
  row.value = std::numeric_limits<double>::quiet_NaN();
  row.failed = "it would not fit";
  return {row};
}

void write_thumbnail(const fs::path& folder, const std::string& key) {
  fs::create_directories(folder / "cells");
  std::ofstream(thumbnail_file(folder, key)) << "picture of " << key;
}

void add_cell(const fs::path& folder, const std::vector<StudyRow>& rows) {
  StudyJournal(folder, {}).append(rows);
  if (!failed(rows)) write_thumbnail(folder, rows.front().key);
}

fs::path make_part(const fs::path& folder, const StudyRecord& record, const std::vector<std::vector<StudyRow>>& cells) {
  fs::create_directories(folder);
  write_record(record, folder);
  for (const auto& cell : cells) add_cell(folder, cell);
  return folder;
}

std::string text_of(const std::vector<StudyRow>& rows) {
  std::string text;
  for (const StudyRow& row : rows) text += json_line(row) + "\n";
  return text;
}

std::string contents(const fs::path& folder) {
  std::string text;
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) text += fs::relative(file, folder).string() + "\n" + read_bytes(file) + "\n";
  return text;
}

TEST(StudyFolder, WhatWasAppendedIsReadBack) {
  const TemporaryFolder folder;
  add_cell(folder.path(), some_cell(0));
  add_cell(folder.path(), failed_cell(1));
  add_cell(folder.path(), some_cell(2));
  const CellRows cells = read_cells(folder.path());
  ASSERT_EQ(cells.size(), 3u);
  EXPECT_EQ(text_of(cells.at("cell0")), text_of(some_cell(0)));
  EXPECT_TRUE(failed(cells.at("cell1")));
  EXPECT_EQ(text_of(cells.at("cell2")), text_of(some_cell(2)));
}

// As if the program had died while it wrote the last cell, whose thumbnail comes after its rows.
TEST(StudyFolder, AJournalTornAnywhereGivesWholeCellsAndNoOthers) {
  const TemporaryFolder folder;
  const std::string kept = text_of(some_cell(0)) + text_of(failed_cell(1)), torn = text_of(some_cell(2));
  write_thumbnail(folder.path(), "cell0");
  for (size_t bytes = 0; bytes <= torn.size(); ++bytes) {
    const bool at_line_end = bytes == 0 || torn[bytes - 1] == '\n' || torn[std::min(bytes, torn.size() - 1)] == '\n';
    if (!at_line_end && bytes % 13 != 0) continue;
    folder.write("rows.jsonl", kept + torn.substr(0, bytes));
    const CellRows cells = read_cells(folder.path());
    ASSERT_EQ(cells.size(), 2u) << "torn after " << bytes << " of " << torn.size() << " bytes";
    ASSERT_EQ(cells.at("cell0").size(), 3u);
  }
  write_thumbnail(folder.path(), "cell2");
  EXPECT_EQ(read_cells(folder.path()).size(), 3u);
}

TEST(StudyFolder, ALineThatIsNoRowIsNamedByFileAndLine) {
  const TemporaryFolder folder;
  folder.write("rows.jsonl", text_of(failed_cell(0)) + "nonsense\n");
  try {
    read_cells(folder.path());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("rows.jsonl:2"), std::string::npos) << error.what();
  }
}

TEST(StudyFolder, IsReopenedWithWholeCellsAndFailedOnesAreToBeTriedAgain) {
  const TemporaryFolder folder;
  const StudyRecord record = some_record(4);
  make_part(folder.path(), record, {some_cell(0), failed_cell(1)});
  StudyJournal(folder.path(), {}).append(some_cell(2));
  std::ofstream(folder.path() / "rows.jsonl", std::ios::app) << "{\"key\": \"cell3\", ";
  const StudyFolder held = open_folder(folder.path(), record, false);
  EXPECT_EQ(held.rows.size(), 1u);
  EXPECT_TRUE(held.rows.contains("cell0"));
  EXPECT_EQ(read_bytes(folder.path() / "rows.jsonl"), text_of(some_cell(0)));
  EXPECT_EQ(missing_cells(held).size(), 3u);
  EXPECT_EQ(open_folder(folder.path(), record, true).rows.size(), 0u) << "--fresh";
}

TEST(StudyFolder, HoldsOneStudyAndSaysWhatDiffersFromAnother) {
  const TemporaryFolder folder;
  StudyRecord record = some_record(2);
  make_part(folder.path(), record, {some_cell(0)});
  const auto complaint = [&](const std::function<void(StudyRecord&)>& change) {
    StudyRecord other = some_record(2, "other");
    change(other);
    try {
      open_folder(folder.path(), other, false);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("opened");
  };
  const std::string call = record.head.call;
  EXPECT_NE(complaint([](StudyRecord& r) { r.head.call += ",3"; }).find("--levels 0,1,2 there, 0,1,2,3 here"), std::string::npos);
  EXPECT_NE(complaint([](StudyRecord& r) { r.head.call += " --flicker"; }).find("--flicker"), std::string::npos);
  EXPECT_NE(complaint([](StudyRecord& r) { r.head.scene = "rook"; }).find("the scene is egg there, rook here"), std::string::npos);
  EXPECT_NE(complaint([](StudyRecord& r) { r.input_hash = "x"; }).find("content"), std::string::npos);
  EXPECT_NE(complaint([](StudyRecord& r) { r.version = "2"; }).find("limn 1"), std::string::npos);
  EXPECT_EQ(read_cells(folder.path()).size(), 1u) << "nothing was touched";
}

TEST(StudyFolder, TwoProcessesDoNotWorkInOneFolder) {
  const TemporaryFolder folder;
  const FolderLock lock(folder.path());
  EXPECT_THROW(FolderLock{folder.path()}, InputError);
}

TEST(StudyMerge, PartsInAnyOrderAndTwiceOverGiveTheSameFolder) {
  const TemporaryFolder folder;
  const StudyRecord record = some_record(6);
  const std::vector<fs::path> parts = {make_part(folder.path() / "part-1-of-3", record, {some_cell(0), some_cell(3)}),
                                       make_part(folder.path() / "part-2-of-3", record, {some_cell(4), some_cell(1), some_cell(0, 2.0)}),
                                       make_part(folder.path() / "part-3-of-3", record, {failed_cell(3), some_cell(2), failed_cell(5)})};
  std::vector<size_t> order = {0, 1, 2};
  std::string first;
  do {
    const fs::path out = folder.path() / "out";
    fs::remove_all(out);
    std::vector<fs::path> given;
    for (const size_t i : order) given.push_back(parts[i]);
    given.push_back(parts[order[0]]);
    const StudyFolder merged = merge_parts(given, out);
    EXPECT_EQ(merged.rows.size(), 6u);
    EXPECT_EQ(failed_cells(merged), 1) << "a cell that came out somewhere has not failed";
    EXPECT_TRUE(missing_cells(merged).empty());
    finish_folder(out, merged, false);
    const std::string once = contents(out);
    if (first.empty()) first = once;
    EXPECT_EQ(once, first);
    finish_folder(out, merge_parts({out, parts[order[1]]}, out), false);
    EXPECT_EQ(contents(out), first) << "merged again into itself";
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(StudyMerge, SaysWhatIsMissing) {
  const TemporaryFolder folder;
  const fs::path part = make_part(folder.path() / "part-2-of-3", some_record(3), {some_cell(1)});
  const std::vector<PlannedCell> missing = missing_cells(merge_parts({part}, folder.path() / "out"));
  ASSERT_EQ(missing.size(), 2u);
  EXPECT_EQ(missing[0].text, "mesh, level 0");
  EXPECT_EQ(missing[1].text, "mesh, level 2");
}

TEST(StudyMerge, RefusesPartsOfDifferentStudies) {
  const TemporaryFolder folder;
  StudyRecord other = some_record(3, "other");
  other.head.call = "limn study egg --size 64x48 --views 1 --levels 0,1";
  const fs::path a = make_part(folder.path() / "part-1-of-2", some_record(3), {some_cell(1)});
  const fs::path b = make_part(folder.path() / "part-2-of-2", other, {some_cell(1)});
  try {
    merge_parts({a, b}, folder.path() / "out");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("--levels 0,1,2 there, 0,1 here"), std::string::npos) << error.what();
  }
  EXPECT_FALSE(fs::exists(folder.path() / "out"));
}

TEST(StudyMerge, APartThatCannotBeReadLeavesNothingOfTheOthers) {
  const TemporaryFolder folder;
  const fs::path good = make_part(folder.path() / "part-1-of-2", some_record(3), {some_cell(1)});
  const fs::path bad = make_part(folder.path() / "part-2-of-2", some_record(3), {some_cell(2)});
  std::ofstream(bad / "rows.jsonl", std::ios::app) << "{\"key\"\n";
  EXPECT_THROW(merge_parts({good, bad}, folder.path() / "out"), InputError);
  EXPECT_FALSE(fs::exists(folder.path() / "out"));
}

TEST(StudyMerge, FindsFinishedPartsAndLeavesOutTheOthers) {
  const TemporaryFolder folder;
  EXPECT_THROW(parts_in(folder.path()), InputError);
  EXPECT_THROW(parts_in(folder.path() / "nowhere"), InputError);
  const fs::path part = make_part(folder.path() / "part-1-of-2", some_record(1), {some_cell(0)});
  make_part(unfinished(folder.path() / "part-2-of-2"), some_record(1), {some_cell(0)});
  make_part(folder.path() / "something", some_record(1), {some_cell(0)});
  EXPECT_EQ(parts_in(folder.path()), std::vector<fs::path>{part});
  EXPECT_EQ(parts_in(part), std::vector<fs::path>{part});
}

TEST(StudyMerge, APartDoesNotChooseWhereTheWholeIsWritten) {
  const TemporaryFolder folder;
  for (const std::string name : {"../cell0", "a/b", "..", "", "a.b"}) {
    StudyRecord record = some_record(1);
    record.cells.front().key = name;
    const fs::path part = folder.path() / "part";
    make_part(part, record, {});
    EXPECT_THROW(merge_parts({part}, folder.path() / "whole"), InputError) << "key '" << name << "'";
  }
  for (const std::string name : {"../egg", "/tmp/egg", ".."}) {
    StudyRecord record = some_record(1);
    record.head.scene = name;
    EXPECT_THROW(read_record(make_part(folder.path() / "part", record, {})), InputError) << "scene '" << name << "'";
  }
  EXPECT_FALSE(fs::exists(folder.path() / "whole"));
}

TEST(StudyMerge, TruthsOfPartsAreJoinedAndTheWorstIsSaid) {
  StudyRecord record = some_record(1);
  record.pictures = "the analytic surface itself";
  add_truths({{1, 0.4, "the field", true, 0.004, {}, ""}, {0, 0.4, "the field", true, 0.002, {}, ""}}, record);
  EXPECT_TRUE(record.head.exact);
  EXPECT_EQ(record.head.truth, "the field, within 0.004 px; pictures against the analytic surface itself");
  add_truths({{1, 0.4, "the field", true, 0.004, {}, ""}, {2, 0.4, "a mesh of level 6", false, 0.1, {}, ""}}, record);
  ASSERT_EQ(record.truths.size(), 3u);
  EXPECT_EQ(record.truths[1].view, 1);
  EXPECT_FALSE(record.head.exact);
  EXPECT_NE(record.head.truth.find("a mesh of level 6, within 0.1 px"), std::string::npos) << record.head.truth;
}

}  // namespace
}  // namespace limn
