// Drawings as files: what `limn contours` writes, and what it refuses.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <set>

#include "samples/experiment/job.h"
#include "samples/lines/write_drawing.h"
#include "samples/scenes/scenes.h"
#include "sdf/segment.h"
#include "tests/samples/run_program.h"

namespace limn {
namespace {

constexpr int kWidth = 640, kHeight = 360;

ViewGraph graph_of(const std::string& name) {
  const Scene scene = find_scene(name)->make();
  CameraSettings settings = scene.camera;
  settings.width_px = kWidth;
  settings.height_px = kHeight;
  return solve_lines(scene, camera_of_view(settings, {bounds(scene), {}}, {}, 0, 1), {}, {});
}

LineDrawing drawing_of(const ViewGraph& graph, CurveForm form, bool hidden) {
  DrawingSettings settings{.form = form, .style = built_in_style("technical")};
  if (hidden) settings.highest_invisibility = 1000;
  return make_drawing(graph, kWidth, kHeight, settings);
}

size_t count_of(const std::string& text, const std::string& what) {
  size_t count = 0;
  for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

/// Places along a path, close together.
std::vector<glm::dvec2> places_of(const Stroke& stroke) {
  std::vector<glm::dvec2> places{stroke.start};
  for (const PathStep& step : stroke.steps) {
    const glm::dvec2 from = places.back();
    for (int k = 1; k <= 40; ++k) {
      const double t = k / 40.0, s = 1.0 - t;
      if (const auto* line = std::get_if<LineTo>(&step)) {
        places.push_back(glm::mix(from, line->to, t));
      } else if (const auto* cubic = std::get_if<CubicTo>(&step)) {
        places.push_back(s * s * s * from + 3.0 * s * s * t * cubic->control1 + 3.0 * s * t * t * cubic->control2 + t * t * t * cubic->to);
      } else {
        const auto& arc = std::get<ArcTo>(step);
        const glm::dvec2 r = from - arc.center;
        const double c = std::cos(t * arc.sweep), sine = std::sin(t * arc.sweep);
        places.push_back(arc.center + glm::dvec2(c * r.x - sine * r.y, sine * r.x + c * r.y));
      }
    }
  }
  return places;
}

double farthest(const std::vector<glm::dvec2>& places, const std::vector<glm::dvec2>& line) {
  double most = 0.0;
  for (const glm::dvec2& p : places) {
    double least = 1e9;
    for (size_t i = 0; i + 1 < line.size(); ++i) least = std::min(least, distance_to_segment(p, line[i], line[i + 1]));
    most = std::max(most, least);
  }
  return most;
}

TEST(Contours, FittedCurvesKeepToTheLineAndEndWhereItEnds) {
  for (const char* const name : {"machined_part", "gyroid", "teacup"}) {
    const ViewGraph graph = graph_of(name);
    const LineDrawing plain = drawing_of(graph, CurveForm::polyline, true);
    for (const CurveForm form : {CurveForm::bezier, CurveForm::arc}) {
      const LineDrawing fitted = drawing_of(graph, form, true);
      ASSERT_EQ(fitted.strokes.size(), plain.strokes.size());
      size_t steps = 0, lines = 0;
      for (size_t i = 0; i < fitted.strokes.size(); ++i) {
        std::vector<glm::dvec2> line = places_of(plain.strokes[i]), places = places_of(fitted.strokes[i]);
        if (plain.strokes[i].closed) line.push_back(line.front());
        // The tolerance, and what is between the points at which it was looked at.
        EXPECT_LE(farthest(places, line), 0.065) << name << " chain " << fitted.strokes[i].chain;
        EXPECT_LE(farthest(line, places), 0.065) << name << " chain " << fitted.strokes[i].chain;
        EXPECT_LE(glm::distance(places.back(), plain.strokes[i].closed ? line.front() : line.back()), 1e-6);
        steps += fitted.strokes[i].steps.size();
        lines += plain.strokes[i].steps.size();
      }
      EXPECT_LT(3 * steps, 2 * lines) << name;
    }
  }
}

TEST(Contours, SvgHasALayerForEachClassAndVisibilityHiddenOnesFirst) {
  const ViewGraph graph = graph_of("machined_part");
  const std::string svg = svg_text(drawing_of(graph, CurveForm::polyline, true), "a <part> & more");
  EXPECT_NE(svg.find("<title>a &lt;part&gt; &amp; more</title>"), std::string::npos);
  EXPECT_EQ(count_of(svg, "<path "), graph.chains.size());
  EXPECT_EQ(count_of(svg, "inkscape:groupmode=\"layer\""), 4u);
  std::vector<std::string> labels;
  const std::regex label("inkscape:label=\"([^\"]*)\"");
  for (std::sregex_iterator at(svg.begin(), svg.end(), label), end; at != end; ++at) labels.push_back((*at)[1]);
  EXPECT_EQ(labels, (std::vector<std::string>{"1 crease hidden", "2 contour hidden", "3 crease visible", "4 contour visible"}));
  size_t hidden = 0;
  for (const LineChain& chain : graph.chains) hidden += chain.invisibility > 0;
  EXPECT_EQ(count_of(svg, "data-qi=\"0\""), graph.chains.size() - hidden);
  // A drawing of visible lines alone has no hidden layer.
  EXPECT_EQ(svg_text(drawing_of(graph, CurveForm::polyline, false), "part").find("hidden"), std::string::npos);
}

TEST(Contours, AClosedSilhouetteIsAClosedPath) {
  const std::string svg = svg_text(drawing_of(graph_of("ellipsoid"), CurveForm::polyline, false), "ellipsoid");
  EXPECT_EQ(count_of(svg, "<path "), 1u);
  EXPECT_EQ(count_of(svg, "Z\"/>"), 1u);
}

TEST(Contours, AFileOfEveryKindIsWrittenInOneCall) {
  const TemporaryFolder folder;
  const RunResult result = run_limn({"contours", "tilted_torus", "--size", "320x240", "--hidden", "--curves", "arc", "--page", "100x80mm",
                                     "-o", "t.svg", "-o", "t.pdf", "-o", "t.dxf", "-o", "t.json", "--json"},
                                    folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json document = result.json();
  EXPECT_EQ(document["files"].size(), 4u);
  EXPECT_TRUE(document["views"][0]["conflicts"].empty());
  EXPECT_NE(read_bytes(folder.path() / "t.svg").find("width=\"100mm\" height=\"80mm\""), std::string::npos);
  EXPECT_EQ(read_bytes(folder.path() / "t.pdf").substr(0, 5), "%PDF-");
  const std::string dxf = read_bytes(folder.path() / "t.dxf");
  EXPECT_EQ(dxf.substr(dxf.size() - 6), "0\nEOF\n");
  const nlohmann::json graph = nlohmann::json::parse(read_bytes(folder.path() / "t.json"));
  const auto vertices = static_cast<int>(graph["vertices"].size());
  std::multiset<int> used;
  for (const auto& chain : graph["chains"]) {
    for (const auto& link : chain["edges"]) used.insert(link["edge"].get<int>());
  }
  EXPECT_EQ(used.size(), graph["edges"].size());
  for (const auto& edge : graph["edges"]) {
    EXPECT_LT(edge["begin"].get<int>(), vertices);
    EXPECT_EQ(edge["px"].size(), edge["position"].size());
  }
}

TEST(Contours, EqualCallsWriteEqualBytesWhateverTheThreads) {
  const TemporaryFolder folder;
  for (const char* const threads : {"1", "2"}) {
    const RunResult result = run_limn({"contours", "machined_part", "--size", "320x180", "--hidden", "--threads", threads, "-o",
                                       fmt::format("{}.svg", threads), "-o", fmt::format("{}.pdf", threads), "-q"},
                                      folder.path());
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  EXPECT_EQ(read_bytes(folder.path() / "1.svg"), read_bytes(folder.path() / "2.svg"));
}

TEST(Contours, TheCameraOfAViewGivenBackDrawsThatViewAlone) {
  const TemporaryFolder folder;
  const RunResult all = run_limn({"contours", "rook", "-q", "--json", "--views", "3", "--size", "320x200", "-o", folder.file("all.svg")});
  ASSERT_EQ(all.exit_code, 0) << all.err;
  const nlohmann::json view = all.json().at("views").at(2), camera = view.at("camera");
  const auto vector = [&](const char* key) {
    const nlohmann::json& v = camera.at(key);
    return v.at(0).dump() + "," + v.at(1).dump() + "," + v.at(2).dump();
  };
  const RunResult one = run_limn({"contours", "rook", "-q", "--json", "--size", "320x200", "--eye", vector("eye"), "--target",
                                  vector("target"), "--up", vector("up"), "--fov", camera.at("fov").dump(), "-o", folder.file("one.svg")});
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_EQ(one.json().at("views").at(0).at("chains"), view.at("chains"));
  EXPECT_EQ(one.json().at("views").at(0).at("vertices"), view.at("vertices"));
}

TEST(Contours, StyleSheetsAreReadAndTheirFaultsNamed) {
  const TemporaryFolder folder;
  folder.write("good.css",
               "/* thick */ .contour { stroke: #ff0000; stroke-width: 3px }\n.crease.visible, .hidden path { stroke-dasharray: 4 2 1 }\n");
  const RunResult good = run_limn({"contours", "machined_part", "--size", "320x180", "--style", "good.css", "-o", "a.svg"}, folder.path());
  ASSERT_EQ(good.exit_code, 0) << good.err;
  const std::string svg = read_bytes(folder.path() / "a.svg");
  EXPECT_NE(svg.find(".contour.visible path{stroke:#ff0000;stroke-width:3}"), std::string::npos);
  EXPECT_NE(svg.find("stroke-dasharray:4,2,1,4,2,1"), std::string::npos);
  const std::vector<std::pair<std::string, std::string>> faults = {{".contur { stroke: red }", "contour"},
                                                                   {".contour { stroke: reddish }", "not a colour"},
                                                                   {"\n.contour { width: 3 }", "bad.css:2"},
                                                                   {".contour { stroke-width: -1 }", "not a length"},
                                                                   {".contour { stroke: red", "does not end"},
                                                                   {"contour { stroke: red }", "not a selector"},
                                                                   {"/* .contour", "does not end"}};
  for (const auto& [text, says] : faults) {
    folder.write("bad.css", text);
    const RunResult bad = run_limn({"contours", "ellipsoid", "--style", "bad.css", "-o", "b.svg"}, folder.path());
    EXPECT_EQ(bad.exit_code, 2) << text;
    EXPECT_EQ(bad.err_lines(), 1) << bad.err;
    EXPECT_NE(bad.err.find(says), std::string::npos) << bad.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "b.svg"));
  }
}

TEST(Contours, WrongOptionsAreRefusedInOneLine) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::vector<std::string>, std::string>> faults = {{{"--lines", "contuor"}, "contour"},
                                                                                {{"--qi", "3..1"}, "0..2"},
                                                                                {{"--page", "210x297"}, "mm"},
                                                                                {{"--curves", "spline"}, "bezier"},
                                                                                {{"--fit", "0"}, "above 0"},
                                                                                {{"--style", "oil"}, "ink"},
                                                                                {{"--threshold", "1"}, "below 1"},
                                                                                {{"--crease-angle", "180"}, "below 180"},
                                                                                {{"--suggestive-angle", "90"}, "below 90"},
                                                                                {{"--suggestive-slope", "-1"}, "from 0 up"},
                                                                                {{"--ridge-strength", "0"}, "above 0"},
                                                                                {{"--surface", "analytic"}, "mesh"},
                                                                                {{"-o", "a.bmp"}, ".svg"}};
  for (const auto& [options, says] : faults) {
    std::vector<std::string> call = {"contours", "ellipsoid", "--size", "64x64"};
    call.insert(call.end(), options.begin(), options.end());
    const RunResult bad = run_limn(call, folder.path());
    EXPECT_EQ(bad.exit_code, 2) << options[0];
    EXPECT_EQ(bad.err_lines(), 1) << bad.err;
    EXPECT_NE(bad.err.find(says), std::string::npos) << bad.err;
  }
}

TEST(Contours, SuggestiveContoursRidgesAndValleysHaveLayersOfTheirOwn) {
  const TemporaryFolder folder;
  const auto draw = [&](const std::vector<std::string>& more) {
    std::vector<std::string> call = {"contours", "teacup", "--size", "320x180", "-q", "-o", "a.svg", "-o", "a.dxf", "-o", "a.json"};
    call.insert(call.end(), more.begin(), more.end());
    const RunResult result = run_limn(call, folder.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return std::array<std::string, 3>{read_bytes(folder.path() / "a.svg"), read_bytes(folder.path() / "a.dxf"),
                                      read_bytes(folder.path() / "a.json")};
  };
  const std::vector<std::string> names = {"suggestive", "ridge", "valley"};
  const auto with = draw({"--lines", "contour,suggestive,ridge,valley", "--style", "technical"}), without = draw({});
  for (const std::string& name : names) {
    std::string layer = name + "_VISIBLE";
    std::transform(layer.begin(), layer.end() - 8, layer.begin(), [](char c) { return static_cast<char>(std::toupper(c)); });
    EXPECT_NE(with[0].find("class=\"" + name + " visible\""), std::string::npos) << name;
    EXPECT_NE(with[1].find(layer), std::string::npos) << name;
    EXPECT_NE(with[2].find("\"" + name + "\""), std::string::npos) << name;
    for (const std::string& drawing : without) EXPECT_EQ(drawing.find(name), std::string::npos) << name << " by default";
  }
  // Cut-offs that nothing passes leave nothing.
  const auto none = draw({"--lines", "suggestive,ridge,valley", "--suggestive-slope", "1e9", "--ridge-strength", "1e9"});
  EXPECT_EQ(count_of(none[0], "<path "), 0u);
}

TEST(Contours, EveryRepresentationIsDrawn) {
  const TemporaryFolder folder;
  const std::vector<std::vector<std::string>> calls = {{"teacup"},
                                                       {"tilted_torus", "--surface", "level_set", "--voxels", "64"},
                                                       {"bracket", "--surface", "mesh", "--level", "2"},
                                                       {"passing_tori", "--lines", "all", "--threshold", "0.3"},
                                                       {"pipe_junction", "--ortho", "3", "--views", "2"}};
  for (const auto& arguments : calls) {
    std::vector<std::string> call = {"contours"};
    call.insert(call.end(), arguments.begin(), arguments.end());
    call.insert(call.end(), {"--size", "320x180", "-o", "a.svg"});
    const RunResult result = run_limn(call, folder.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.err.find("chain"), std::string::npos) << result.err;
  }
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "a_v0.svg"));
  EXPECT_GT(count_of(read_bytes(folder.path() / "a_v1.svg"), "<path "), 2u);
}

}  // namespace
}  // namespace limn
