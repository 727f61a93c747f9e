#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "raymarch/image_io.h"
#include "raymarch/metric.h"
#include "run_program.h"
#include "samples/page/panels.h"

namespace limn {
namespace {

using nlohmann::json;

json compare(const TemporaryFolder& folder, const std::string& input, const std::vector<std::string>& more = {},
             const std::vector<std::string>& resolution = {"--voxels", "40", "--level", "2"}) {
  std::vector<std::string> arguments = {"compare", input, "--size", "160x120", "-o", folder.file("out"), "--json"};
  arguments.insert(arguments.end(), resolution.begin(), resolution.end());
  arguments.insert(arguments.end(), more.begin(), more.end());
  const RunResult result = run_limn(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.json();
}

const json& cell(const json& document, const std::string& name) {
  for (const json& one : document.at("cells")) {
    if (one.at("name") == name) return one;
  }
  throw std::runtime_error("no cell " + name);
}

// What a browser could follow. The name of SVG's namespace and the home page in a licence are text.
void expect_no_loads(std::string page) {
  for (const std::string text :
       {"xmlns=\"http://www.w3.org/2000/svg\"", "img-comparison-slider 8.0.7, https://img-comparison-slider.sneas.io"}) {
    if (const size_t at = page.find(text); at != std::string::npos) page.erase(at, text.size());
  }
  for (const char* foreign : {"http:", "https:", "src=\"//", "url(", "<link", "@import", "fetch(", "XMLHttp", "sourceMappingURL"})
    EXPECT_EQ(page.find(foreign), std::string::npos) << foreign;
}

TEST(Compare, AFieldIsHeldAgainstItsFormulaInEveryOtherRepresentation) {
  const TemporaryFolder folder;
  const json document = compare(folder, "ellipsoid");
  EXPECT_EQ(document.at("reference").at("surface"), "analytic");
  for (const char* name : {"level_set", "mesh", "mesh_level_set"}) {
    const json& metrics = cell(document, name).at("metrics");
    EXPECT_GT(metrics.at("overlap"), 0.9) << name;
    EXPECT_LT(metrics.at("normal_error_mean"), 1.0) << name;
    EXPECT_GE(metrics.at("pixels_differ"), 0.0) << name;
    EXPECT_GT(cell(document, name).at("bytes"), 0) << name;
  }
  EXPECT_EQ(folder.files(), (std::vector<std::string>{"out/level_set.exr", "out/mesh.exr", "out/mesh_level_set.exr",
                                                      "out/reference_analytic.exr", "out/report.html", "out/rows.json", "out/sheet.png"}));
  EXPECT_EQ(document.at("files").size(), 7u);
}

TEST(Compare, DisplacementsFromTheTruthAreThoseOfAStudy) {
  const TemporaryFolder folder;
  const std::vector<std::string> view = {"--eye", "2,1,4", "--target", "0,0,0"};
  const json document = compare(folder, "ellipsoid", view, {"--voxels", "24", "--level", "1"});
  const json& truth = document.at("truth").at(0);
  EXPECT_EQ(document.at("truth").size(), 1u);
  EXPECT_TRUE(truth.at("exact"));
  EXPECT_LT(truth.at("bound_px"), 0.01);
  // The formula itself is right to what the truth is known to.
  EXPECT_LT(document.at("reference").at("metrics").at("silhouette_displacement_max"), 0.02);
  EXPECT_LT(document.at("reference").at("metrics").at("inner_displacement_max"), 0.05);
  EXPECT_NE(document.at("summary").dump().find(" of the truth (silhouette "), std::string::npos);
  std::vector<std::string> call = {"study",   "ellipsoid",          "--views", "1",         "--size",
                                   "160x120", "--voxels",           "24",      "--surface", "level_set",
                                   "-o",      folder.file("study"), "-q"};
  call.insert(call.end(), view.begin(), view.end());
  const RunResult study = run_limn(call);
  ASSERT_EQ(study.exit_code, 0) << study.err;
  std::ifstream rows(folder.file("study/rows.jsonl"));
  int compared = 0;
  for (std::string line; std::getline(rows, line);) {
    const json row = json::parse(line);
    const std::string metric = row.at("metric");
    if (row.at("surface") != "level_set" || row.at("surface_parameters").at("gradient") != "central" ||
        (!metric.starts_with("silhouette_displacement") && !metric.starts_with("inner_displacement")))
      continue;
    EXPECT_EQ(row.at("value"), cell(document, "level_set").at("metrics").at(metric)) << metric;
    ++compared;
  }
  EXPECT_GE(compared, 10);
}

TEST(Compare, MethodsWithoutAThresholdAreMeasuredByTheSilhouetteAlone) {
  const TemporaryFolder folder;
  const json document = compare(folder, "ellipsoid", {"--methods", "rim,distance"});
  EXPECT_EQ(document.at("truth").size(), 1u);  // one serves both
  EXPECT_TRUE(cell(document, "mesh-rim").at("metrics").contains("inner_displacement_rms"));
  const json& distance = cell(document, "mesh-distance").at("metrics");
  EXPECT_FALSE(distance.contains("inner_displacement_rms"));
  EXPECT_EQ(distance.at("silhouette_displacement_rms"), cell(document, "mesh-rim").at("metrics").at("silhouette_displacement_rms"));
  EXPECT_NE(document.at("summary").dump().find("Mesh (level 2): 95 % of its border is within "), std::string::npos);
}

TEST(Compare, ACageIsHeldAgainstItsLimitSurfaceAndSkipsSayWhy) {
  const TemporaryFolder folder;
  const json document = compare(folder, "rook");
  EXPECT_EQ(document.at("reference").at("surface"), "mesh");
  EXPECT_NE(document.at("reference_words").get<std::string>().find("limit surface"), std::string::npos);
  EXPECT_GT(document.at("reference").at("triangles"), 4 * cell(document, "mesh").at("triangles").get<std::int64_t>());
  EXPECT_GT(cell(document, "mesh").at("metrics").at("overlap"), 0.5);
  EXPECT_FALSE(cell(document, "analytic").at("skipped").get<std::string>().empty());
}

TEST(Compare, AVolumeIsHeldAgainstItselfAcrossGradients) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_limn({"export", "ellipsoid", "--voxels", "40", "--half-width", "5", "-o", folder.file("egg.vdb"), "-q"}).exit_code, 0);
  const json document = compare(folder, folder.file("egg.vdb"), {}, {});
  EXPECT_EQ(document.at("reference").at("surface"), "level_set");
  EXPECT_EQ(document.at("reference").at("parameters").at("gradient"), "cubic");
  EXPECT_LT(cell(document, "level_set_central").at("metrics").at("normal_error_mean"),
            cell(document, "level_set_cell").at("metrics").at("normal_error_mean"));
}

TEST(Compare, OnlyTheRepresentationsAskedForAreDrawn) {
  const TemporaryFolder folder;
  const json document = compare(folder, "ellipsoid", {"--surface", "mesh"}, {"--level", "2"});
  EXPECT_EQ(document.at("cells").size(), 1u);
}

TEST(Compare, ThePageHoldsAllItShowsAndLoadsNothing) {
  const TemporaryFolder folder;
  compare(folder, "machined_part");
  const std::string page = read_bytes(folder.path() / "out/report.html");
  expect_no_loads(page);
  for (const char* needed : {"<!DOCTYPE html>", "lang=\"en\"", "name=\"viewport\"", "prefers-color-scheme: dark", "data:image/png;base64,",
                             "<table>", "border pixels differ"}) {
    EXPECT_NE(page.find(needed), std::string::npos) << needed;
  }
  // Every picture has words for those who cannot see it.
  size_t pictures = 0;
  for (size_t at = page.find("<img "); at != std::string::npos; at = page.find("<img ", at + 1)) {
    const std::string tag = page.substr(at, page.find('>', at) - at);
    if (tag.find("src=") == std::string::npos) continue;  // the viewer's, filled by its script
    ++pictures;
    const size_t alternative = tag.find("alt=\"");
    ASSERT_NE(alternative, std::string::npos);
    EXPECT_NE(tag[alternative + 5], '"') << tag;
  }
  EXPECT_EQ(pictures, 2u + 3u * 3u);
  for (const char* nothing : {">nan<", "\"nan\"", ">inf<", "\"inf\""}) EXPECT_EQ(page.find(nothing), std::string::npos) << nothing;
}

TEST(Compare, TheSheetIsAPictureWithEveryCellInIt) {
  const TemporaryFolder folder;
  compare(folder, "superellipsoid");
  const Image<float> sheet = read_channel(folder.path() / "out/sheet.png", "R");
  EXPECT_GT(sheet.width, 4 * 400);
  EXPECT_GT(sheet.height, 3 * 300);
}

TEST(Compare, RowsAreOnePerCellAndMeasurement) {
  const TemporaryFolder folder;
  const json document = compare(folder, "ellipsoid");
  const json rows = json::parse(read_bytes(folder.path() / "out/rows.json"));
  size_t expected = 1 + document.at("reference").at("metrics").size();  // the reference's ink and displacements
  for (const json& one : document.at("cells")) expected += one.contains("skipped") ? 1 : 1 + one.at("metrics").size();
  EXPECT_EQ(rows.size(), expected);
  for (const json& row : rows) {
    if (row.contains("skipped")) continue;
    for (const char* key : {"scene", "view", "surface", "surface_parameters", "method", "metric", "value", "unit", "time_ms", "bytes"})
      EXPECT_TRUE(row.contains(key)) << key;
  }
}

std::vector<std::string> names_of_methods() {
  std::vector<std::string> names;
  for (const json& method : run_limn({"list", "methods", "--json"}).json()) names.push_back(method.at("name"));
  return names;
}

TEST(CompareMatrix, EveryMethodMeetsEveryModelAndASkipSaysWhy) {
  const TemporaryFolder folder;
  const json document = compare(folder, "machined_part", {"--methods", "all"});
  const std::vector<std::string> methods = names_of_methods();
  ASSERT_GT(methods.size(), 8u);
  const json rows = json::parse(read_bytes(folder.path() / "out/rows.json"));
  const std::string page = read_bytes(folder.path() / "out/report.html");
  for (const std::string& method : methods) {
    EXPECT_NE(page.find("<h3>" + method), std::string::npos) << method;
    for (const char* model : {"level_set", "mesh", "mesh_level_set"}) {
      const json& one = cell(document, std::string(model) + "-" + method);
      const bool skipped = one.contains("skipped");
      EXPECT_EQ(skipped, method == "edge_quads" && one.at("surface") != "mesh") << one.at("name");
      if (skipped) {
        EXPECT_NE(one.at("skipped").get<std::string>().find("polygons"), std::string::npos);
      }
      const auto of_cell = std::count_if(rows.begin(), rows.end(), [&](const json& row) { return row.at("cell") == one.at("name"); });
      EXPECT_EQ(of_cell, skipped ? 1 : static_cast<std::ptrdiff_t>(1 + one.at("metrics").size())) << one.at("name");
      if (!skipped && method != "edge_quads") {
        // How good a coarse model is, is not this test's question; but a border in the right place overlaps.
        EXPECT_GT(one.at("metrics").at("overlap"), 0.1) << one.at("name");
        EXPECT_LE(one.at("metrics").at("overlap"), 1.0) << one.at("name");
        EXPECT_GT(one.at("border_px"), 0.0) << one.at("name");
      }
    }
  }
  EXPECT_EQ(document.at("cells").size(), 3 * methods.size());
  EXPECT_EQ(document.at("reference_cells").size(), methods.size());
  expect_no_loads(page);
}

TEST(CompareMatrix, WhatFailedIsSaidInTheMethodsOwnNumbers) {
  const TemporaryFolder folder;
  const json document = compare(folder, "machined_part", {"--methods", "rim,jump_flood", "--surfaces", "mesh"}, {"--level", "2"});
  ASSERT_EQ(document.at("cells").size(), 2u);
  const std::string page = read_bytes(folder.path() / "out/report.html");
  for (const json& note : cell(document, "mesh-rim").at("notes")) EXPECT_NE(page.find(note.get<std::string>()), std::string::npos) << note;
  EXPECT_FALSE(cell(document, "mesh-rim").at("notes").empty()) << "the rim flips whole flat faces";
  size_t of_rim = 0;
  for (const json& row : json::parse(read_bytes(folder.path() / "out/rows.json"))) {
    const std::string name = row.at("cell");
    const json& cells = document.at(name.starts_with("reference_") ? "reference_cells" : "cells");
    const auto own = std::find_if(cells.begin(), cells.end(), [&](const json& one) { return one.at("name") == name; });
    ASSERT_NE(own, cells.end()) << name;
    if (own->contains("skipped")) {
      EXPECT_FALSE(row.contains("notes")) << name;
      continue;
    }
    EXPECT_EQ(row.at("notes"), own->at("notes")) << name;
    if (name != "mesh-rim") continue;
    ++of_rim;
    EXPECT_TRUE(std::any_of(row.at("notes").begin(), row.at("notes").end(), [](const json& note) {
      return note.get<std::string>().find("flipped whole") != std::string::npos;
    })) << row.at("notes");
  }
  EXPECT_GT(of_rim, 1u);
}

TEST(CompareMatrix, AModelIsTracedOnceAndDrawnAsIfAlone) {
  const TemporaryFolder together, alone;
  const json both = compare(together, "ellipsoid", {"--methods", "fresnel,sobel", "--samples", "3"});
  const json one = compare(alone, "ellipsoid", {"--method", "sobel", "--samples", "3"});
  EXPECT_EQ(cell(both, "mesh-sobel").at("trace_ms"), cell(both, "mesh-fresnel").at("trace_ms"));
  EXPECT_EQ(cell(both, "mesh-sobel").at("metrics"), cell(one, "mesh").at("metrics"));
  const Image<float> ink = read_channel(together.path() / "out/mesh.exr", "sobel.Y");
  EXPECT_EQ(ink.pixels, read_channel(alone.path() / "out/mesh.exr", "border.Y").pixels);
  EXPECT_EQ(read_channel(together.path() / "out/mesh.exr", "sobel.R").pixels, read_channel(alone.path() / "out/mesh.exr", "R").pixels);
}

TEST(CompareMatrix, WrongNamesAndValuesAreAnsweredWithTheNearestRightOnes) {
  struct Slip {
    std::vector<std::string> arguments;
    const char* answer;
  };
  const Slip slips[] = {
      {{"--methods", "rim,sobell"}, "'sobel'"},
      {{"--methods", "rim,"}, "one of"},
      {{"--surfaces", "mesh,levelset"}, "'level_set'"},
      {{"--methods", "rim,sobel", "--set", "treshold=0.4"}, "'threshold'"},
      {{"--methods", "rim,blur", "--set", "blur.radius=1000"}, "256"},
      {{"--methods", "rim", "--method", "blur"}, "--method"},
  };
  const TemporaryFolder folder;
  for (const Slip& slip : slips) {
    std::vector<std::string> arguments = {"compare", "ellipsoid", "--size", "64x48", "-o", folder.file("out")};
    arguments.insert(arguments.end(), slip.arguments.begin(), slip.arguments.end());
    const RunResult result = run_limn(arguments);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_EQ(result.err_lines(), 1) << result.err;
    EXPECT_NE(result.err.find(slip.answer), std::string::npos) << result.err;
  }
  EXPECT_TRUE(folder.files().empty());
}

TEST(CompareMatrix, TheSheetHasARowForEachMethod) {
  const TemporaryFolder folder;
  compare(folder, "ellipsoid", {"--methods", "rim,fresnel"});
  const int two = read_channel(folder.path() / "out/sheet.png", "R").height;
  compare(folder, "ellipsoid", {"--methods", "rim,fresnel,sobel,blur"});
  EXPECT_GT(read_channel(folder.path() / "out/sheet.png", "R").height, two + 2 * 200);
}

TEST(Panels, TheWorstWindowIsWhereABruteForceSearchFindsIt) {
  Image<float> a(40, 30, 0.0f), b(40, 30, 0.0f);
  unsigned state = 12345;
  for (float& value : a.pixels) {
    state = state * 1664525u + 1013904223u;
    value = (state >> 24) < 12 ? 1.0f : 0.0f;
  }
  const Window window = worst_window(a, b, 9, 7);
  double best = 0.0;
  for (int y = 0; y + 7 <= 30; ++y) {
    for (int x = 0; x + 9 <= 40; ++x) {
      double sum = 0.0;
      for (int j = 0; j < 7; ++j) {
        for (int i = 0; i < 9; ++i) sum += a.at(x + i, y + j);
      }
      best = std::max(best, sum);
      if (x == window.x && y == window.y) {
        EXPECT_DOUBLE_EQ(sum, window.wrong_px);
      }
    }
  }
  EXPECT_DOUBLE_EQ(window.wrong_px, best);
  EXPECT_GT(best, 1.0);
}

TEST(Panels, ASingleWrongPixelShowsInASmallDifferencePicture) {
  Image<float> border(64, 48, 0.0f), reference(64, 48, 0.0f);
  border.at(33, 21) = 1.0f;
  const auto difference = difference_picture(border, reference);
  const auto small = fitted_difference(difference, border, reference, 8, 6);
  ASSERT_EQ(small.width, 8);
  const glm::vec4 color = small.at(33 / 8, 21 / 8);
  EXPECT_GT(color.r, 2.0f * color.b) << "false ink is red";
  EXPECT_LT(fitted(difference, 8, 6).at(33 / 8, 21 / 8).r - fitted(difference, 8, 6).at(33 / 8, 21 / 8).b, 0.05f)
      << "the mean would hide it";
}

TEST(Panels, PicturesKeepTheirShapeAndGrowByWholeFactorsOnly) {
  const Image<glm::vec4> wide(300, 100, glm::vec4(0.5f));
  EXPECT_EQ(fitted(wide, 150, 150).width, 150);
  EXPECT_EQ(fitted(wide, 150, 150).height, 50);
  EXPECT_EQ(fitted(wide, 800, 800).width, 600);
  for (const glm::vec4& color : fitted(wide, 70, 70).pixels) EXPECT_NEAR(color.r, 0.5f, 1e-6f);
}

}  // namespace
}  // namespace limn
