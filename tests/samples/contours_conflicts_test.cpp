// Views whose lines had conflicts, or were found twice: what went wrong in each is told by its name.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>

#include "tests/samples/run_program.h"

namespace limn {
namespace {

struct HardView {
  const char* name;
  std::vector<std::string> arguments;
};
void PrintTo(const HardView& view, std::ostream* to) { *to << view.name; }

std::vector<std::string> seen_from(const std::string& scene, const std::string& surface, const std::string& eye, const std::string& target,
                                   const std::string& up, const std::string& size) {
  std::vector<std::string> arguments{scene, "--eye", eye, "--target", target, "--up", up, "--fov", "35", "--size", size};
  if (!surface.empty()) arguments.insert(arguments.end(), {"--surface", surface, "--voxels", "256"});
  return arguments;
}

class ContoursConflicts : public testing::TestWithParam<HardView> {};

TEST_P(ContoursConflicts, AreNoneAndNoLineIsDrawnTwice) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments{"contours"};
  arguments.insert(arguments.end(), GetParam().arguments.begin(), GetParam().arguments.end());
  const std::string graph = folder.file("lines.json");
  arguments.insert(arguments.end(), {"--strict", "--hidden", "-q", "-o", graph});
  const RunResult run = run_limn(arguments);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto lines = nlohmann::json::parse(read_bytes(graph));
  EXPECT_TRUE(lines.at("certificate").at("conflicts").empty());
  EXPECT_EQ(lines.at("certificate").at("bound_px").get<double>(), 0.005);
  // The lengths of closed curves: of two as long as each other one is the other, found again.
  std::map<int, double> length_of;
  for (const auto& edge : lines.at("edges")) {
    const auto& px = edge.at("px");
    double& sum = length_of[edge.at("curve").get<int>()];
    for (size_t i = 1; i < px.size(); ++i)
      sum += std::hypot(px[i][0].get<double>() - px[i - 1][0].get<double>(), px[i][1].get<double>() - px[i - 1][1].get<double>());
  }
  std::vector<double> lengths;
  for (const auto& [curve, length] : length_of) {
    if (length > 500.0) lengths.push_back(length);
  }
  std::sort(lengths.begin(), lengths.end());
  for (size_t i = 1; i < lengths.size(); ++i) EXPECT_GT(lengths[i] - lengths[i - 1], 0.1);
}

INSTANTIATE_TEST_SUITE_P(
    Views, ContoursConflicts,
    testing::Values(
        HardView{"ACurveOfMoreThanFiftyThousandPoints", {"gyroid", "--surface", "level_set", "--voxels", "256"}},
        HardView{"AFoldWithinOneStep", seen_from("gyroid", "level_set", "2.845104737848607,2.494869423163239,-4.8380045227101816", "0,0,0",
                                                 "-0.2059056622947335,0.9137876681024716,0.3501356249495529", "640x360")},
        HardView{"AContourSmallerThanACell", {"honeycomb", "--surface", "level_set", "--voxels", "256", "--size", "640x360"}},
        HardView{"TwoContoursSmallerThanACell",
                 seen_from("machined_part", "level_set", "-3.0037228430398275,-0.15330776836988824,3.52629615264958",
                           "0.00829745277696814,0.13078260643615786,-0.009741003858599218",
                           "-0.03958551034802946,0.9981349120659809,0.0464724077870175", "640x360")},
        HardView{"ASwallowtailWhereAClosedCurveStarts",
                 seen_from("bracket", "mesh_level_set", "2.6745249490170133,-0.015376602377351722,-7.149387501270998",
                           "-0.031143861633045944,0.7285631906933743,-1.0295571023282122",
                           "0.044681608782776015,0.9938761288861995,-0.10106331810684718", "640x360")},
        HardView{"ALensBesideACusp", seen_from("bracket", "mesh_level_set", "0.924225685160501,7.969434908139674,-2.205149624932816",
                                               "0.03463239377564331,0.991649325939246,-1.1414119382378258",
                                               "-0.6292173479586339,0.19491777735188676,0.7523912473574528", "1280x720")},
        HardView{"APointBehindTheNextBesideAJumpOfCurvature",
                 seen_from("machined_part", "", "3.3930996177067896,4.9115568985135205,1.9559020821740571",
                           "0.08918658566876081,0.25568176063382086,0.051410288015480754",
                           "-0.6702381218063944,0.6336524485498741,-0.3863488508125604", "1280x720")},
        HardView{"APathInCircles", seen_from("rook", "mesh_level_set", "4.219344732665942,-0.393189059218081,-3.23410610983325",
                                             "-0.0096092039541249,0.9831273229787177,0.007365405575436412",
                                             "0.1984917817623476,0.9682218446335646,-0.15214293328046988", "640x360")},
        HardView{"ACornerWhereTheCurvatureJumps", seen_from("machined_part", "", "-3.943486030524869,2.9635125021601785,0.881680610195101",
                                                            "-0.09633780187611807,0.1992215881921804,0.021539108110314564",
                                                            "0.5602979774932415,0.818763329394423,-0.1252708539762651", "640x360")},
        HardView{"ACuspWhoseArmsLieOnTheirChord",
                 seen_from("machined_part", "", "1.3871030477239903,-6.0300241009710005,-2.0242396341286164",
                           "-0.04081113570762285,0.3112392957822836,0.05955687181909397",
                           "0.5251329572961345,0.3700753090522109,-0.7663417271631022", "640x360")},
        HardView{"TwoPassagesAtOnce", seen_from("machined_part", "", "0.5955674408802728,2.3249372037386795,3.8579745807209824",
                                                "0.0136873374467682,0.1804440708471784,0.08866401405243662",
                                                "-0.07477438562871055,0.8716594167580377,-0.48437449605742716", "1280x720")}),
    [](const testing::TestParamInfo<HardView>& view) { return std::string(view.param.name); });

}  // namespace
}  // namespace limn
