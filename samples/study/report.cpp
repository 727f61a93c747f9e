// report.html of a study: one file with everything in it, that asks for nothing and no one.

#include <fmt/format.h>

#include <map>

#include "samples/compare/compare_words.h"
#include "samples/page/html.h"
#include "samples/page/page_assets.h"
#include "samples/study/report_page.h"
#include "samples/study/report_words.h"
#include "sdf/output_file.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

// vega works its expressions out with an interpreter that it brings, so that no script may be made from text either.
constexpr const char* kHead =
    "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, "
    "initial-scale=1\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src "
    "'unsafe-inline'; script-src 'unsafe-inline'\">\n";

constexpr const char* kControls = R"html(<section class="filters" aria-labelledby="filters-title" hidden>
<h2 id="filters-title">Charts</h2>
<div class="controls">
<label>Method <select name="method"></select></label>
<label>Drawn with <select name="parameters"></select></label>
<label>View <select name="view"></select></label>
<label>Error <select name="metric"></select></label>
</div>
<fieldset class="shown"><legend>Models</legend></fieldset>
<p class="status" role="status"></p>
</section>
)html";

constexpr const char* kLegend =
    "<p class=\"legend\">Differences: <span><i style=\"background:#aaaaaa\"></i>border in both</span><span><i "
    "style=\"background:#2759ed\"></i>missing: only truth has it</span><span><i style=\"background:#ed3027\"></i>wrong: truth does not "
    "have it</span></p>\n";

std::string sentences_html(const StudyHead& head, const ReportData& data) {
  const std::vector<std::string> sentences = study_sentences(head, data);
  const size_t lead = std::min<size_t>(sentences.size(), data.drawings.size() > 1 ? 3 : 2);
  std::string html = "<p class=\"lead\">";
  for (size_t i = 0; i < lead; ++i) html.append(i == 0 ? "" : " ").append(escaped(sentences[i]));
  html += "</p>\n";
  if (lead == sentences.size()) return html;
  html += "<ul class=\"results\">\n";
  for (size_t i = lead; i < sentences.size(); ++i) html += "<li>" + escaped(sentences[i]) + "</li>\n";
  return html + "</ul>\n";
}

std::string charts_html(const std::vector<StudyChart>& charts) {
  if (charts.empty()) return "";
  std::string html = kControls;
  html +=
      "<noscript><p>The charts below need scripts; the same ones are beside this page as .svg and .png.</p></noscript>\n<div "
      "class=\"charts\">\n";
  for (const StudyChart& chart : charts) {
    html += fmt::format(
        "<figure class=\"chart\" id=\"{0}\"><h3>{1}</h3><p class=\"caption\"></p><div class=\"plot\"></div><p class=\"note\"></p>"
        "<details><summary>In words</summary><p class=\"words\">{2}</p></details></figure>\n",
        chart.stem, escaped(chart.title), escaped(chart.words));
  }
  return html + "</div>\n";
}

std::string scripts_html(const ReportData& data) {
  std::string html = "<script type=\"application/json\" id=\"study\">" + study_data_json(data) + "</script>\n";
  for (const std::string_view script :
       {kVegaScript, kVegaLiteScript, kVegaEmbedScript, kPageScript, kStudyNumbers, kStudyCharts, kStudyScript})
    html.append("<script>\n").append(script).append("</script>\n");
  return html;
}

}  // namespace

std::string study_page(const StudyHead& head, const ReportData& data, const std::vector<StudyChart>& charts,
                       const ReportThumbnails& thumbnails) {
  const std::string name = heading(head.scene.empty() ? head.input : head.scene);
  std::string html = kHead;
  html += "<title>limn study: " + escaped(name) + "</title>\n<style>\n";
  html.append(kPageStyle).append(kStudyStyle).append("</style>\n</head>\n<body>\n<main>\n");
  html += "<h1>" + escaped(name) + ": how far the border depends on the model</h1>\n" + sentences_html(head, data);
  html += charts_html(charts);
  if (!data.cells.empty()) {
    html += std::string("<h2>Pictures</h2>\n") + kLegend + thumbnails_html(data, thumbnails);
    html += "<h2>All models</h2>\n" + study_table_html(data) + failed_html(data);
  }
  html += "<details><summary>How this was made</summary>\n<p><code>" + escaped(head.call) + "</code></p>\n";
  html +=
      "<p>The charts are drawn with vega, vega-lite and vega-embed; their licences stand in this page's source.</p></details>\n</main>\n";
  if (!data.cells.empty()) html += scripts_html(data);
  return html + "</body>\n</html>\n";
}

std::vector<std::filesystem::path> write_study_report(const StudyHead& head, const std::vector<StudyRow>& rows,
                                                      const std::filesystem::path& folder) {
  const ReportData data = collect_report(head, rows);
  const std::vector<StudyChart> charts = study_charts(data);
  std::vector<std::filesystem::path> files = {folder / "report.html"};
  std::vector<std::vector<std::filesystem::path>> written(charts.size());
  // Side by side: a chart takes as long as the page.
  parallel_each(charts.size() + 1, [&](size_t k) {
    if (k == charts.size()) return write_whole(files.front(), study_page(head, data, charts, read_thumbnails(data, folder)));
    const StudyChart& chart = charts[k];
    written[k] = write_chart(folder / chart.stem, kChartWidth, chart.height, chart.title, chart.words, chart.draw);
  });
  for (const auto& of_chart : written) files.insert(files.end(), of_chart.begin(), of_chart.end());
  return files;
}

}  // namespace limn
