#pragma once
// One measurement of a study: a line of rows.csv and of rows.jsonl, and what every chart is drawn from.

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "samples/output/output.h"

namespace limn {

/// One metric of one cell. A cell is one model, seen from one view, drawn by one method. A cell that failed is one row without a metric,
/// its reason in `failed`.
struct StudyRow {
  std::string key{};      ///< Of the cell: a hash of all that determines it, the program's version included. Rows of one cell share it.
  std::string scene{};    ///< SceneInput::name.
  int view = 0;           ///< From 0.
  std::string surface{};  ///< "mesh", "level_set", …
  std::map<std::string, std::string>
      surface_parameters{};  ///< {"level", "3"}, {"normals", "vertex"}; {"voxels", "128"}, {"gradient", "cubic"}.
  std::string method{};      ///< A name in border_methods().
  std::map<std::string, std::string> method_parameters{};        ///< {"threshold", "0.4"}.
  std::string metric{};                                          ///< MetricValue::name; empty in a cell that failed.
  double value = std::numeric_limits<double>::quiet_NaN();       ///< MetricValue::value.
  std::string unit{};                                            ///< MetricValue::unit.
  double resolution = std::numeric_limits<double>::quiet_NaN();  ///< Mean edge or voxel, as a share of the scene's longest side.
  double build_ms = 0.0,                                         ///< Of the model.
      trace_ms = 0.0,                                            ///< Of one picture.
      border_ms = 0.0;                                           ///< Of the method.
  std::int64_t bytes = 0;                                        ///< Of the model.
  std::string failed{};                                          ///< Why there is no value; empty where there is one.
  /// What charts show as the time of a cell.
  double time_ms() const { return build_ms + trace_ms + border_ms; }
};

/// "mesh, vertex normals": the model without its resolution, the same for all rows of one line in a chart.
std::string series_of(const StudyRow& row);
/// "level 3", "128 voxels".
std::string resolution_text(const StudyRow& row);

/// The header of rows.csv, without the line's end.
std::string csv_header();
/// A row as a line of rows.csv, without the line's end. Numbers are written so that they read back the same.
std::string csv_line(const StudyRow& row);
/// A row as a line of rows.jsonl, without the line's end. Numbers are written so that they read back the same.
std::string json_line(const StudyRow& row);
/// Throws InputError with file and line.
StudyRow row_from_json(const std::string& line, const std::filesystem::path& file, int line_number);

/// What a study is about, in its folder as study.json: what shards must agree on, and what the report says about it.
struct StudyHead {
  std::string id{};                     ///< Hash of all that determines the study's cells.
  std::string input{};                  ///< As given.
  std::string scene{};                  ///< SceneInput::name.
  std::string call{};                   ///< The resolved call.
  std::string truth{};                  ///< "the field itself, within 0.005 px".
  bool exact = true;                    ///< False where a proxy stands in for the truth of any view.
  double truth_within_px = 0.0;         ///< How far off truth itself may be in the worst view; 0 where it is exact.
  std::vector<std::string> warnings{};  ///< What the audit says of the input.
  int views = 1;                        ///< Of each model.
  std::vector<std::string> surfaces{};  ///< Series in order.
  std::int64_t cells = 0;               ///< Of the whole study.
};

/// A small picture of one cell: the border on white, wrong ink red, missing ink blue. PNG bytes, at most 320 px wide.
/// In the study's folder as cells/KEY.png.
std::filesystem::path thumbnail_file(const std::filesystem::path& folder, const std::string& key);

/// Writes report.html and the charts (.svg and .png) into the study's folder, from its rows alone, in any order; the same files for the
/// same rows. Returns what it wrote.
std::vector<std::filesystem::path> write_study_report(const StudyHead& head, const std::vector<StudyRow>& rows,
                                                      const std::filesystem::path& folder);

}  // namespace limn
