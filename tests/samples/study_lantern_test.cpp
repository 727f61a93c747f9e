// What a study says of models that do not converge, and of a truth that is not known well enough to say so.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cctype>

#include "run_program.h"
#include "samples/stability/mesh_makers.h"
#include "samples/study/charts.h"
#include "samples/study/record.h"
#include "samples/study/report_words.h"
#include "tests/samples/study_rows.h"

namespace limn {
namespace {

using nlohmann::json;
using test::synthetic_study;
using test::SyntheticStudy;

constexpr const char* kFalls = "The error falls with the resolution to the power of: ";
constexpr const char* kRight = "right to 0.5 px (RMS, median of the views)";

std::string all_words(const SyntheticStudy& study) {
  std::string text;
  for (const std::string& sentence : study_sentences(study.head, collect_report(study.head, study.rows))) text += sentence + "\n";
  return text;
}

/// The line of `text` that starts with `words`; empty where there is none.
std::string line_of(const std::string& text, const std::string& words) {
  const size_t at = text.find(words);
  return at == std::string::npos ? "" : text.substr(at, text.find('\n', at) - at);
}

/// A cylinder of radius and half height 1 whose triangles lie across it.
std::string lantern_obj(double around, double along) {
  const MeshMaker& maker = find_mesh_maker("schwarz_lantern");
  const Mesh mesh = maker.make(resolve(maker.parameters, {{"around", {{around}}}, {"along", {{along}}}}));
  std::string text;
  for (const glm::dvec3& p : mesh.positions) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
  size_t corner = 0;
  for (const std::int32_t size : mesh.face_sizes) {
    text += "f";
    for (std::int32_t i = 0; i < size; ++i) text += fmt::format(" {}", mesh.corner_vertices[corner++] + 1);
    text += "\n";
  }
  return text;
}

TEST(StudyWords, AnErrorThatStaysIsNotCalledFalling) {
  SyntheticStudy study = synthetic_study({});
  for (StudyRow& row : study.rows) {
    if (row.surface_parameters.contains("normals") && row.surface_parameters["normals"] == "flat" && row.unit == "px") row.value = 3.0;
  }
  const std::string words = all_words(study), falls = line_of(words, kFalls);
  EXPECT_NE(falls.find("mesh, limit normals 2."), std::string::npos) << words;
  EXPECT_EQ(falls.find("flat"), std::string::npos) << falls;
  EXPECT_NE(line_of(words, "The error does not converge to 0").find("mesh, flat facets"), std::string::npos) << words;
  const ReportData data = collect_report(study.head, study.rows);
  bool looked = false;
  for (const StudyChart& chart : study_charts(data)) {
    if (chart.stem != "chart_order") continue;
    looked = true;
    EXPECT_NE(chart.words.find("0.00: does not converge"), std::string::npos) << chart.words;
    EXPECT_NE(chart.words.find("mesh, limit normals: order 2."), std::string::npos) << chart.words;
    EXPECT_EQ(chart.words.find("mesh, limit normals: order 2.00: does"), std::string::npos) << chart.words;
  }
  EXPECT_TRUE(looked);
}

TEST(StudyWords, NothingIsCalledRightThatTruthCannotTell) {
  SyntheticStudy study = synthetic_study({.scatter = 0.0});
  ASSERT_NE(all_words(study).find(kRight), std::string::npos);
  study.head.exact = false;
  study.head.truth_within_px = 13.0;
  const std::string words = all_words(study);
  EXPECT_NE(words.find("No model can be called right to 0.5 px, and none wrong by less than 13 px"), std::string::npos) << words;
  for (const char* claim : {kRight, kFalls, "Never within", "ask for different resolutions"})
    EXPECT_EQ(words.find(claim), std::string::npos) << words;
}

TEST(StudyWords, TheTruthsBoundAndTheAuditsWarningsAreReadBackFromTheRecord) {
  const TemporaryFolder folder;
  StudyRecord record;
  record.head.warnings = {"lantern: 7 faces"};
  add_truths({{0, 0.4, "the mesh", false, 2.5, {}, ""}, {1, 0.4, "the mesh", false, 7.25, {}, ""}}, record);
  EXPECT_EQ(record.head.truth_within_px, 7.25);
  write_record(record, folder.path());
  const std::optional<StudyRecord> back = read_record(folder.path());
  ASSERT_TRUE(back);
  EXPECT_EQ(back->head.truth_within_px, 7.25);
  EXPECT_EQ(back->head.warnings, record.head.warnings);
  StudyRecord exact;
  add_truths({{0, 0.4, "the field", true, 0.004, {}, ""}}, exact);
  EXPECT_EQ(exact.head.truth_within_px, 0.0);
}

/// What of a study's files and words concerns a lantern, whatever way it is read.
void expect_warned(const RunResult& result, const std::filesystem::path& folder) {
  const std::string page = read_bytes(folder / "report.html");
  EXPECT_NE(result.err.find("as on Schwarz's lantern"), std::string::npos) << result.err;
  EXPECT_NE(page.find("lie by up to 1"), std::string::npos) << "the page keeps the warning's number to itself";
  const json warnings = json::parse(read_bytes(folder / "study.json")).at("warnings");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].get<std::string>().find("finer faces of that kind bring positions nearer, not normals"), std::string::npos);
}

TEST(StudyLantern, AsItIsNothingIsCalledRightOrConverging) {
  const TemporaryFolder folder;
  const std::string lantern = folder.write("lantern.obj", lantern_obj(8, 64));
  const RunResult result = run_limn({"study", lantern, "--reference", "smooth", "--size", "80x60", "--views", "1", "--voxels", "8,16,32",
                                     "--gradients", "central", "-o", folder.file("out")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  expect_warned(result, folder.path() / "out");
  const std::string page = read_bytes(folder.path() / "out/report.html");
  for (const std::string& text : {result.out, page}) {
    EXPECT_NE(text.find("No model can be called right to 0.5 px"), std::string::npos);
    EXPECT_EQ(text.find(kRight), std::string::npos);
    EXPECT_EQ(text.find(kFalls), std::string::npos);
  }
}

TEST(StudyLantern, RefinedIntoItselfItsFacetsAreNotCalledConverging) {
  const TemporaryFolder folder;
  const std::string lantern = folder.write("lantern.obj", lantern_obj(8, 64));
  const RunResult result = run_limn({"study", lantern, "--scheme", "bilinear", "--levels", "0..2", "--surface", "mesh", "--normals", "flat",
                                     "--size", "80x60", "--views", "1", "-o", folder.file("out")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  expect_warned(result, folder.path() / "out");
  const std::string page = read_bytes(folder.path() / "out/report.html");
  EXPECT_EQ(result.out.find(kFalls), std::string::npos) << result.out;
  EXPECT_EQ(page.find(kFalls), std::string::npos);
  EXPECT_NE(result.out.find("does not converge to 0"), std::string::npos) << result.out;
}

}  // namespace
}  // namespace limn
