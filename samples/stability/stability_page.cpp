// report.html of `limn stability`: one file with everything in it, that asks for nothing and no one.

#include "samples/stability/stability_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "samples/page/html.h"
#include "samples/page/page_assets.h"
#include "samples/spec/flags.h"
#include "samples/stability/stability_page_parts.h"

namespace limn {
namespace {

// What a browser still opens at once.
constexpr size_t kMostPictureBytes = 24'000'000;

constexpr const char* kHead =
    "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, "
    "initial-scale=1\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src "
    "'unsafe-inline'; script-src 'unsafe-inline'\">\n<title>limn study: stability</title>\n<style>\n";

constexpr const char* kPanel = R"html(<aside class="panel" id="panel" aria-labelledby="panel-title" hidden>
<button type="button" class="close" aria-label="Close">&#215;</button>
<h3 id="panel-title" tabindex="-1"></h3>
<div class="inside"></div>
</aside>
)html";

std::string counts_html(const StabilityResults& results) {
  std::string html = "<fieldset class=\"counts\"><legend>Outcomes</legend>\n";
  constexpr std::array<const char*, 5> meaning = {"within its bound", "beyond its bound, within the outer one",
                                                  "must fail here, and says so", "beyond every bound, or silent about it",
                                                  "cannot run here"};
  for (size_t i = 0; i < kStabilityOutcomes.size(); ++i) {
    const StabilityOutcome outcome = kStabilityOutcomes[i];
    html += fmt::format(
        "<label class=\"count {0}\"><input type=\"checkbox\" name=\"outcome\" value=\"{0}\" checked><span class=\"mark {0}\"><b>{1}</b>"
        "</span><span><strong>{2}</strong> {3}<small>{4}</small></span></label>\n",
        class_of(outcome), glyph_of(outcome), count(results, outcome), name_of(outcome), meaning[i]);
  }
  return html + "</fieldset>\n";
}

std::string surfaces_html(const StabilityResults& results) {
  std::vector<std::string> surfaces;
  for (const StabilityCell& cell : results.cells) {
    if (std::find(surfaces.begin(), surfaces.end(), cell.surface) == surfaces.end()) surfaces.push_back(cell.surface);
  }
  std::string html = "<label>Representation <select name=\"surface\"><option value=\"\">all</option>";
  for (const std::string& surface : surfaces) html += "<option>" + escaped(surface) + "</option>";
  return html +
         "</select></label>\n<p class=\"details\">In the marks: A analytic, L level set, M mesh, ML mesh turned into a level set; the "
         "number "
         "is the worst place of all views and draws, where the property does not hold.</p>\n";
}

/// The results, which mark holds which cells, and the pictures, heaviest outcomes first.
std::string data_json(const StabilityResults& results, const std::vector<StabilityMark>& marks, const std::filesystem::path& folder) {
  Json document = stability_json(results);
  document["marks"] = Json::array();
  for (const StabilityMark& mark : marks) document["marks"].push_back({{"cells", mark.cells}, {"worst", mark.worst}});
  for (size_t i = 0; i < results.cells.size(); ++i) document["cells"][i]["command"] = command_of(results.cells[i]);
  std::vector<size_t> order(results.cells.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return weight_of(results.cells[a].outcome) > weight_of(results.cells[b].outcome); });
  Json pictures = Json::object();
  size_t room = kMostPictureBytes;
  for (const size_t i : order) {
    const std::string& name = results.cells[i].picture;
    if (name.empty() || pictures.contains(name)) continue;
    std::ifstream file(folder / name, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    if (bytes.empty() || bytes.size() > room) continue;
    room -= bytes.size();
    pictures[name] = base64(bytes);
  }
  document["pictures"] = std::move(pictures);
  // Text of others must not end the script it stands in.
  const std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char letter : text) safe += letter == '<' ? std::string("\\u003c") : std::string(1, letter);
  return safe;
}

}  // namespace

std::string stability_page(const StabilityResults& results, const std::filesystem::path& folder) {
  const std::vector<StabilityMark> marks = stability_marks(results);
  std::string html = kHead;
  html.append(kPageStyle).append(kStabilityStyle).append("</style>\n</head>\n<body>\n<main>\n");
  html += "<h1>Stability: where methods fail, and what must hold there</h1>\n<p class=\"lead\">";
  for (const std::string& sentence : stability_sentences(results)) html += escaped(sentence) + " ";
  html += "</p>\n<form class=\"filters\" aria-label=\"What is shown\">\n" + counts_html(results) + surfaces_html(results);
  html +=
      "<p class=\"status\" role=\"status\"></p>\n</form>\n<noscript><p>Without scripts marks cannot be opened; what did not hold is told "
      "below.</p></noscript>\n";
  html += "<h2 id=\"matrix-title\">Cases and methods</h2>\n" + stability_matrix_html(results, marks);
  html += "<h2>What did not hold</h2>\n" + stability_list_html(results, marks);
  CallText call("stability", "");
  call.add("seed", std::to_string(results.seed));
  html += fmt::format(
      "<details><summary>How this was made</summary><p><code>{}</code>, limn {}. Random parameters are drawn "
      "from the seed; each case's own stands with its marks.</p></details>\n</main>\n",
      call.text(), stability_json(results)["version"].get<std::string>());
  html += kPanel;
  html += "<script type=\"application/json\" id=\"stability\">" + data_json(results, marks, folder) + "</script>\n<script>\n";
  html.append(kStabilityScript).append("</script>\n</body>\n</html>\n");
  return html;
}

}  // namespace limn
