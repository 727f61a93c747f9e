// The stability page and its Markdown table, from results written down by hand.

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <regex>

#include "samples/stability/stability_page.h"
#include "tests/samples/run_program.h"

namespace limn {
namespace {

StabilityCell cell_of(const std::string& case_name, const std::string& surface, const std::string& method, StabilityOutcome outcome,
                      double number, int draw = 0) {
  StabilityCell cell;
  cell.case_name = case_name;
  cell.surface = surface;
  cell.method = method;
  cell.outcome = outcome;
  cell.number = number;
  cell.draw = draw;
  cell.unit = "px";
  cell.seed = 5;
  return cell;
}

StabilityResults results_of() {
  StabilityResults results;
  results.seed = 5;
  results.cases = {{"cube_faces", "cube | flat faces", "a face flips", "all in or all out", "faces", "share of a face"},
                   {"cube_turned", "cube | flat faces", "a face flips", "all in or all out", "faces", "share of a face"},
                   {"thin_sheet", "sheet </script>", "vanishes", "never \"inverted\" & seen", "sign", "points"}};
  results.cells = {cell_of("cube_faces", "analytic", "rim", StabilityOutcome::held, 0.0),
                   cell_of("cube_faces", "analytic", "rim", StabilityOutcome::degraded, 0.25, 1),
                   cell_of("cube_faces", "mesh", "rim", StabilityOutcome::held, 0.0),
                   cell_of("cube_turned", "mesh", "extrude direction=vertex_normal", StabilityOutcome::fails_as_expected, 4.0),
                   cell_of("thin_sheet", "level_set", "", StabilityOutcome::wrong, 3.0),
                   cell_of("thin_sheet", "mesh_level_set", "", StabilityOutcome::skipped, std::numeric_limits<double>::quiet_NaN())};
  results.cells[4].message = "<img src=x onerror=alert(1)> </script>";
  results.cells[4].said = {"a warning with 2 < 3"};
  return results;
}

size_t count_of(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

TEST(StabilityMarkdown, CountsOutcomesForEachRowOfTheCatalogueAndAddsThemUp) {
  EXPECT_EQ(stability_markdown(results_of()),
            "| case | held | degraded | fails as expected | wrong | skipped |\n"
            "|---|---:|---:|---:|---:|---:|\n"
            "| cube \\| flat faces | 2 | 1 | 1 |  |  |\n"
            "| sheet </script> |  |  |  | 1 | 1 |\n"
            "| **all** | 2 | 1 | 1 | 1 | 1 |\n");
}

TEST(StabilityPage, HasAMarkForEachCaseSurfaceAndMethodThatShowsTheWorstDraw) {
  const std::string page = stability_page(results_of(), ".");
  EXPECT_EQ(count_of(page, "<button type=\"button\" class=\"mark "), 5u);
  EXPECT_EQ(count_of(page, "aria-label=\"degraded: rim on analytic, cube_faces, 0.25 px, bound 0, worst of 2 draws\""), 1u);
  EXPECT_EQ(count_of(page, "aria-label=\"wrong: the surface itself on level set, thin_sheet, 3 px, bound 0\""), 1u);
  EXPECT_EQ(count_of(page, "aria-label=\"skipped: the surface itself on mesh level set, thin_sheet\""), 1u);
}

TEST(StabilityPage, LetsNoTextOutOfItsPlace) {
  const std::string page = stability_page(results_of(), ".");
  EXPECT_EQ(count_of(page, "<script"), count_of(page, "</script>"));
  EXPECT_EQ(count_of(page, "<script"), 2u);
  EXPECT_EQ(page.find("<img src=x"), std::string::npos);
  EXPECT_NE(page.find("&lt;img src=x"), std::string::npos);
  EXPECT_NE(page.find("never &quot;inverted&quot; &amp; seen"), std::string::npos);
}

TEST(StabilityPage, AsksForNothingFromAnywhere) {
  const std::string page = stability_page(results_of(), ".");
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  const std::regex request("(src|href)=\"(?!data:)|@import|url\\(|fetch\\(|https?://", std::regex::ECMAScript);
  std::smatch found;
  EXPECT_FALSE(std::regex_search(page, found, request)) << found.str();
}

TEST(StabilityPage, HoldsThePicturesThatAreThereAndNamesThoseThatAreNot) {
  const TemporaryFolder folder;
  folder.write("seen.png", "not looked into");
  StabilityResults results = results_of();
  results.cells[4].picture = "seen.png";
  results.cells[3].picture = "gone.png";
  const std::string page = stability_page(results, folder.path());
  EXPECT_EQ(count_of(page, "\"seen.png\":\"bm90IGxvb2tlZCBpbnRv\""), 1u);
  EXPECT_EQ(count_of(page, "\"gone.png\":\""), 0u);
  EXPECT_EQ(count_of(page, "\"picture\":\"gone.png\""), 1u);
}

TEST(StabilityPage, IsTheSameForTheSameResults) { EXPECT_EQ(stability_page(results_of(), "."), stability_page(results_of(), ".")); }

TEST(StabilityPage, SaysSoWhereEverythingHeld) {
  StabilityResults results = results_of();
  results.cells = {results.cells.front()};
  const std::string page = stability_page(results, ".");
  EXPECT_NE(page.find("None is wrong."), std::string::npos);
  EXPECT_NE(page.find("Everything held that could run."), std::string::npos);
}

}  // namespace
}  // namespace limn
