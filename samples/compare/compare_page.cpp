// The report page: one HTML file with everything in it, readable without scripts, without a network and on a phone.

#include <fmt/format.h>

#include "samples/compare/compare_page_parts.h"
#include "samples/compare/compare_words.h"
#include "samples/compare/comparison.h"
#include "samples/page/html.h"
#include "samples/page/page_assets.h"

namespace limn {
namespace {

std::string list_section(const char* title, const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string html = fmt::format("<h2>{}</h2>\n<ul class=\"results\">\n", title);
  for (const std::string& line : lines) html += "<li>" + escaped(heading(line)) + "</li>\n";
  return html + "</ul>\n";
}

std::string results_html(const Comparison& comparison) {
  const std::vector<std::string> sentences = summary_sentences(comparison);
  std::string html = "<p class=\"lead\">" + escaped(sentences.front());
  size_t next = 1;
  const bool has_ranking = !comparison.is_matrix() && (sentences.size() == 2 || sentences.size() > 3);
  if (has_ranking) html.append(1, ' ').append(escaped(sentences[next++]));
  html += "</p>\n";
  if (next == sentences.size()) return html;
  html += "<ul class=\"results\">\n";
  for (; next < sentences.size(); ++next) html += "<li>" + escaped(sentences[next]) + "</li>\n";
  return html + "</ul>\n";
}

// Shown by the script, which it cannot do without.
constexpr const char* kViewer = R"html(<section class="viewer" aria-labelledby="viewer-title" hidden>
<h2 id="viewer-title">Any two, one over the other</h2>
<div class="controls">
<label>Left of the divider <select name="left"></select></label>
<label>Right of it <select name="right"></select></label>
<label>Size <select name="zoom"><option value="fit" selected>fit</option><option value="1">1 : 1</option><option value="2">2 x</option>
<option value="4">4 x</option><option value="8">8 x</option><option value="16">16 x</option></select></label>
<button type="button" class="worst">Worst place of the right one</button>
</div>
<div class="stage" role="region" tabindex="0" aria-label="The two pictures; scrolls when they are enlarged">
<img-comparison-slider value="50" role="slider" tabindex="0" aria-label="Divider between the two pictures; arrow keys move it"
 aria-valuemin="0" aria-valuemax="100" aria-valuenow="50"><img slot="first" alt="left picture"><img slot="second" alt="right picture">
</img-comparison-slider>
</div>
<div class="sides"><div class="first"><strong></strong><span></span></div><div class="second"><strong></strong><span></span></div></div>
</section>
)html";

constexpr const char* kLegend =
    "<p class=\"legend\">Differences: <span><i style=\"background:#aaaaaa\"></i>border in both</span><span><i "
    "style=\"background:#2759ed\"></i>missing: only the reference has it</span><span><i style=\"background:#ed3027\"></i>false: the "
    "reference does not have it</span></p>\n";

// Nothing is loaded, and the browser is told so.
std::string head_html(const Comparison& comparison) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src "
      "'unsafe-inline'; script-src 'unsafe-inline'\">\n";
  html += "<title>limn compare: " + escaped(comparison.input_name) + "</title>\n<style>\n";
  return html.append(kPageStyle) + "</style>\n</head>\n";
}

std::string title_of(const Comparison& comparison) {
  const std::string name = heading(comparison.input_name);
  if (!comparison.is_matrix()) return name + ": the border, drawn from different models of one surface";
  return fmt::format("{}: {} ways to draw its border", name, comparison.methods.size());
}

}  // namespace

std::string report_page(const Comparison& comparison) {
  std::string html = head_html(comparison);
  html += comparison.is_matrix() ? "<body class=\"several\">\n<main>\n" : "<body>\n<main>\n";
  html += "<h1>" + escaped(title_of(comparison)) + "</h1>\n" + results_html(comparison) + kViewer;
  html += "<h2>Pictures</h2>\n";
  html += kLegend;
  html += matrix_html(comparison);
  html += "<h2>Numbers</h2>\n" + table_html(comparison);
  html += list_section("Not compared", skipped_sentences(comparison));
  html += "<details><summary>How this was made</summary>\n<p><code>" + escaped(comparison.call) + "</code></p>\n</details>\n</main>\n";
  html.append("<script>\n").append(kSliderScript).append("</script>\n<script>\n").append(kPageScript);
  return html + "</script>\n</body>\n</html>\n";
}

}  // namespace limn
