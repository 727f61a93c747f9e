#pragma once
// The parts of report.html.

#include <filesystem>

#include "samples/study/charts.h"

namespace limn {

/// The picture of a model's typical view under a drawing.
struct ReportThumbnail {
  size_t model = 0, drawing = 0;
  int view = 0;
  double error = 0.0;
  int width = 0, height = 0;
  std::string png{};  ///< Bytes.
};
struct ReportThumbnails {
  std::vector<ReportThumbnail> pictures{};
  size_t left_out = 0;  ///< For the page's size.
};
/// One for each model and drawing, of the view whose error is the median, those of the main drawing first, until they are `most_bytes`
/// together. A picture that is missing or no PNG is passed over.
ReportThumbnails read_thumbnails(const ReportData& data, const std::filesystem::path& folder, size_t most_bytes = 6'000'000);

std::string thumbnails_html(const ReportData& data, const ReportThumbnails& thumbnails);
/// All models in a table that sorts.
std::string study_table_html(const ReportData& data);
std::string failed_html(const ReportData& data);
/// What the page's scripts draw from, as the text of a <script type="application/json">.
std::string study_data_json(const ReportData& data);
std::string study_page(const StudyHead& head, const ReportData& data, const std::vector<StudyChart>& charts,
                       const ReportThumbnails& thumbnails);

}  // namespace limn
