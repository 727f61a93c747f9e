// Drawings that are judged, as they are read: shapes and colours of SVG, lines of ink in pictures, and what is refused.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "run_program.h"
#include "samples/judge/ink_picture.h"
#include "sdf/error.h"
#include "tests/random_seed.h"
#include "tests/samples/judge_case.h"

namespace limn {
namespace {

using namespace test;

std::string svg_with(const std::string& content, const std::string& attributes = "viewBox=\"0 0 640 360\"") {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" " + attributes + ">" + content + "</svg>";
}

double length_of_all(const DrawnLines& drawing) {
  double length = 0.0;
  for (const InkLine& line : drawing.lines) {
    length += length_of(line.points);
    if (line.closed) length += glm::distance(line.points.front(), line.points.back());
  }
  return length;
}

TEST(SvgDrawing, ShapesHaveTheirLengths) {
  const double pi = std::numbers::pi;
  const std::vector<std::pair<std::string, double>> shapes = {
      {"<line x1='10' y1='10' x2='40' y2='50' stroke='black'/>", 50.0},
      {"<circle cx='100' cy='100' r='50' stroke='black'/>", 100.0 * pi},
      {"<rect x='10' y='20' width='30' height='40' stroke='black'/>", 140.0},
      {"<rect x='10' y='20' width='30' height='40' rx='5' stroke='black'/>", 100.0 + 10.0 * pi},
      {"<polyline points='0,0 30,0 30,40' stroke='black'/>", 70.0},
      {"<polygon points='0,0 30,0 30,40' stroke='black'/>", 120.0},
      {"<path d='M10 10h30v40H10z' stroke='black'/>", 140.0},
      {"<path d='m10,10 30,0 0,40-30,0z' stroke='black'/>", 140.0},
      {"<path d='M100 150a50 50 0 1050-50' stroke='black'/>", 75.0 * pi},
      {"<path d='M0 0C10 0 20 0 30 0S50 0 60 0' stroke='black'/>", 60.0},
      {"<path d='M0 0Q15 0 30 0T60 0' stroke='black'/>", 60.0},
      {"<g transform='translate(100,50) rotate(30) scale(2)' stroke='black'><line x1='0' y1='0' x2='30' y2='40'/></g>", 100.0},
      {"<defs><path id='a' d='M0 0h40' stroke='black'/></defs><use href='#a' x='10' y='10'/><use href='#a' y='50'/>", 80.0},
      {"<path d='M10 10h100' stroke='black' stroke-dasharray='10 10'/>", 50.0},
      {"<style>path{fill:none} .seen path{stroke:#000}.not.seen > path{stroke:none}</style><g class='seen'><path d='M0 0h10'/></g>"
       "<g class='seen not'><path d='M0 0h30'/></g>",
       10.0},
      {"<path d='M0 0h10' style='stroke:red;stroke-width:3px'/><path d='M0 0h20' stroke='black' visibility='hidden'/>"
       "<g display='none'><path d='M0 0h40' stroke='black'/></g>",
       10.0},
  };
  for (const auto& [content, length] : shapes) EXPECT_NEAR(length_of_all(read_back(svg_with(content))), length, 0.01) << content;
}

TEST(SvgDrawing, ColoursChooseStrokes) {
  const TemporaryFolder folder;
  const std::string file = folder.write("a.svg", svg_with("<path d='M0 0h10' stroke='#f00'/><path d='M0 5h20' stroke='blue'/>"));
  EXPECT_NEAR(length_of_all(read_drawing(file, {.color = glm::dvec3(1.0, 0.0, 0.0)}, {640, 360})), 10.0, 1e-9);
  EXPECT_THROW(read_drawing(file, {.color = glm::dvec3(0.0, 1.0, 0.0)}, {640, 360}), InputError);
}

TEST(SvgDrawing, WithoutLinesMissesAll) {
  const Judgement judgement = judged(torus(), read_back(svg_with("")));
  EXPECT_EQ(judgement.drawn_px, 0.0);
  EXPECT_NEAR(judgement.all.missed_px, judgement.all.line_px, 1e-6);
  EXPECT_GT(judgement.all.missed_px, 1000.0);
}

TEST(SvgDrawing, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  const auto problem = [&](const std::string& content) -> std::string {
    try {
      read_drawing(folder.write("a.svg", content), {}, {640, 360});
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_NE(problem("").find("empty"), std::string::npos);
  EXPECT_NE(problem("no xml").find("XML"), std::string::npos) << problem("no xml");
  EXPECT_NE(problem("<html/>").find("<svg>"), std::string::npos) << problem("<html/>");
  EXPECT_NE(problem(svg_with("", "")).find("size"), std::string::npos);
  EXPECT_NE(problem(svg_with("<path d='M0 0h9' stroke='red'/>", "viewBox='0 0 320 180'")).find("viewBox"), std::string::npos);
  EXPECT_NE(problem(svg_with("<path d='M0 0h9' stroke='red'/>", "viewBox='0 0 640.5 360'")).find("whole"), std::string::npos);
  // A few lines that draw each other billions of times.
  std::string bomb = "<g id='a0'><path d='M0 0h1' stroke='red'/></g>";
  for (int i = 1; i < 30; ++i) {
    const std::string use = fmt::format("<use href='#a{}'/>", i - 1);
    bomb += fmt::format("<g id='a{}'>{}{}{}</g>", i, use, use, use);
  }
  EXPECT_NE(problem(svg_with("<defs>" + bomb + "</defs><use href='#a29'/>")).find("million"), std::string::npos);
  EXPECT_NE(problem(svg_with("<g id='a'><use href='#a'/></g>")).find("deep"), std::string::npos);
}

TEST(SvgDrawing, MutantsAreReadOrRefused) {
  std::mt19937 random(random_seed());
  const std::string whole = torus().svg;
  const TemporaryFolder folder;
  int read = 0;
  for (int i = 0; i < 200; ++i) {
    std::string mutant = whole;
    const size_t changes = 1 + random() % 8;
    for (size_t k = 0; k < changes && !mutant.empty(); ++k) {
      const size_t at = random() % mutant.size();
      switch (random() % 4) {
        case 0:
          mutant[at] = static_cast<char>(random());
          break;
        case 1:
          mutant.erase(at, 1 + random() % 200);
          break;
        case 2:
          mutant.insert(at, mutant.substr(random() % mutant.size(), random() % 100));
          break;
        default:
          mutant.insert(at, std::vector<std::string>{"1e308", "-", "NaN", "<g>", "A1 1 0 0 1 ", "99999999"}[random() % 6]);
          break;
      }
    }
    try {
      const Judgement judgement = judge_lines(torus().graph, read_drawing(folder.write("a.svg", mutant), {}, {640, 360}), {});
      EXPECT_TRUE(std::isfinite(judgement.all.missed_px + judgement.all.false_px + judgement.drawn_px));
      ++read;
    } catch (const InputError& error) {
      EXPECT_FALSE(std::string(error.what()).empty());
    }
  }
  EXPECT_GT(read, 0);
}

/// A disk's border as ink: the coverage of a ring about (x, y), each pixel by 64 samples.
Image<float> ring(const glm::dvec2& center, double radius, double width) {
  Image<float> coverage(200, 200);
  constexpr int kSamples = 8;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x)
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const int column = k % kSamples, row = k / kSamples;
        const glm::dvec2 p(x + (column + 0.5) / kSamples, y + (row + 0.5) / kSamples);
        if (std::fabs(glm::distance(p, center) - radius) < 0.5 * width) coverage.at(x, y) += 1.0f / (kSamples * kSamples);
      }
  return coverage;
}

TEST(InkPicture, CentreLinesOfThinRingsLieWhereTheyAre) {
  for (const double width : {1.0, 1.5, 2.0, 3.0}) {
    const DrawnLines drawing = lines_of_ink(ring({100.3, 99.6}, 60.0, width));
    ASSERT_EQ(drawing.lines.size(), 1u) << width;
    EXPECT_TRUE(drawing.lines[0].closed);
    EXPECT_NEAR(drawing.lines[0].width_px, width, 0.25);
    for (const glm::dvec2& p : drawing.lines[0].points) EXPECT_NEAR(glm::distance(p, glm::dvec2(100.3, 99.6)), 60.0, 0.12) << width;
  }
}

TEST(InkPicture, WideRingsHaveTwoEdges) {
  const DrawnLines drawing = lines_of_ink(ring({100.3, 99.6}, 60.0, 8.0));
  ASSERT_EQ(drawing.lines.size(), 2u);
  for (const InkLine& line : drawing.lines) {
    EXPECT_TRUE(line.closed);
    const double radius = glm::distance(line.points.front(), glm::dvec2(100.3, 99.6)) > 60.0 ? 64.0 : 56.0;
    for (const glm::dvec2& p : line.points) EXPECT_NEAR(glm::distance(p, glm::dvec2(100.3, 99.6)), radius, 0.15);
  }
}

TEST(InkPicture, LimnsOwnPictureOfTheLinesLiesWithinATenthOfAPixel) {
  const TemporaryFolder folder;
  const std::string file = folder.file("a.exr");
  const RunResult drawn = run_limn({"render", "machined_part", "--surface", "mesh", "--method", "edge_quads", "--samples", "4", "--size",
                                    "640x360", "--background", "white", "-o", file});
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  const RunResult result = run_limn({"judge", file, "--against", "machined_part", "--json", "--max-displaced", "0.1", "--max-missed", "0",
                                     "--max-false", "0", "--max-hidden", "0", "--max-doubled", "0"});
  ASSERT_EQ(result.exit_code, 0) << result.err << result.out;
  const auto json = result.json();
  EXPECT_LT(json["all"]["displacement_px"]["p95"].get<double>(), 0.1);
  EXPECT_LT(std::fabs(json["all"]["displacement_px"]["mean_outwards"].get<double>()), 0.05);
  EXPECT_FALSE(json["shift"]["significant"].get<bool>());
}

}  // namespace
}  // namespace limn
