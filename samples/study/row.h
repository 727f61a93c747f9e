#pragma once
// One measurement of a study: a line of rows.csv and of rows.jsonl, and what every chart is drawn from.

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "samples/experiment/observe.h"
#include "samples/output/output.h"

namespace limn {

/// What displacements in a row were measured against.
struct RowTruth {
  double threshold = std::numeric_limits<double>::quiet_NaN();  ///< N.V where the ink ends; NaN: the method has no border that truth knows.
  std::string from{};                                           ///< BorderTruth::from; empty where there is no truth.
  bool exact = false;                                           ///< BorderTruth::exact.
  double bound_px = std::numeric_limits<double>::quiet_NaN();   ///< BorderTruth::bound_px.
};

/// One metric of one cell. A cell is one model, seen from one view, drawn by one method. A cell that failed is one row without a metric,
/// its reason in `failed`.
struct StudyRow {
  std::string key{};      ///< Of the cell: a hash of all that determines it, the program's version included. Rows of one cell share it.
  std::string scene{};    ///< SceneInput::name.
  int view = 0;           ///< From 0.
  int width_px = 0,       ///< Of the picture.
      height_px = 0;      ///< Of the picture.
  std::string surface{};  ///< "mesh", "level_set", …
  std::map<std::string, std::string>
      surface_parameters{};  ///< {"level", "3"}, {"normals", "vertex"}; {"voxels", "128"}, {"gradient", "cubic"}.
  std::string method{};      ///< A name in border_methods().
  std::map<std::string, std::string> method_parameters{};        ///< {"threshold", "0.4"}.
  std::string metric{};                                          ///< MetricValue::name; empty in a cell that failed.
  double value = std::numeric_limits<double>::quiet_NaN();       ///< MetricValue::value.
  std::string unit{};                                            ///< MetricValue::unit.
  double floor = std::numeric_limits<double>::quiet_NaN();       ///< What the reference itself scores; NaN: the metric compares with it.
  RowTruth truth{};                                              ///< What it was measured against.
  double resolution = std::numeric_limits<double>::quiet_NaN();  ///< Mean edge or voxel, as a share of the scene's longest side.
  Timing build{},                                                ///< Of the model.
      trace{};                                                   ///< Of one picture.
  double border_ms = 0.0;                                        ///< Of the method.
  std::int64_t bytes = 0;                                        ///< Of the model.
  std::string failed{};                                          ///< Why there is no value; empty where there is one.
  /// What charts show as the time of a cell.
  double time_ms() const { return build.median_ms + trace.median_ms + border_ms; }
  /// The least that it took.
  double time_low_ms() const { return build.low_ms + trace.low_ms + border_ms; }
  /// The largest.
  double time_high_ms() const { return build.high_ms + trace.high_ms + border_ms; }
};

/// A name as words: "rim width" of "rim_width".
std::string spaced(std::string name);
/// "mesh, vertex normals": the model without its resolution, the same for all rows of one line in a chart.
std::string series_of(const StudyRow& row);
/// "level 3", "128 voxels".
std::string resolution_text(const StudyRow& row);

/// The header of rows.csv, without the line's end: the columns of all studies, then `parameters` (StudyHead::parameters).
std::string csv_header(const std::vector<std::string>& parameters);
/// A row as a line of rows.csv, without the line's end. Numbers are written so that they read back the same.
std::string csv_line(const StudyRow& row, const std::vector<std::string>& parameters);
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
  /// Columns of rows.csv for what the methods take: "rim.threshold", a method's parameters together.
  std::vector<std::string> parameters{};
  std::string machine{};  ///< What times were measured on: "AMD EPYC 7B13, 2 threads, load 0.4 when it began".
};

/// A small picture of one cell: the border on white, wrong ink red, missing ink blue. PNG bytes, at most 320 px wide.
/// In the study's folder as cells/KEY.png.
std::filesystem::path thumbnail_file(const std::filesystem::path& folder, const std::string& key);

/// Writes report.html and the charts (.svg and .png) into the study's folder, from its rows alone, in any order; the same files for the
/// same rows. Returns what it wrote.
std::vector<std::filesystem::path> write_study_report(const StudyHead& head, const std::vector<StudyRow>& rows,
                                                      const std::filesystem::path& folder);

}  // namespace limn
