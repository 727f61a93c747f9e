// The corpus of stability cases, and the engine that runs it: each outcome can come about, and equal seeds give equal records.

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <set>

#include "raymarch/border.h"
#include "run_program.h"
#include "samples/stability/run_stability.h"
#include "sdf/error.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

/// The catalogue's rows; each must have a case.
const std::vector<std::string>& rows() {
  static const std::vector<std::string> all{
      "cube, flat faces",
      "cylinder seen down its axis",
      "hard corners, extrusion",
      "crease",
      "Schwarz lantern, slivers",
      "extraordinary vertex",
      "degenerate parametrisation (poles, collapsed quads), zero-area and duplicate faces",
      "cusp",
      "medial axis, centre of a sphere, axis of a torus",
      "CSG, smooth blends, non-uniform scale",
      "gradient of a box or a max at an edge",
      "trilinear field",
      "grazing ray, chord inside one step or voxel",
      "narrow band too thin for the gradient stencil",
      "sheet thinner than two voxels, gap below one",
      "open, non-manifold, nested, self-intersecting mesh",
      "inverted orientation",
      "object at 1e6 from the origin",
      "everything scaled by 1e-3 and 1e3",
      "sub-pixel camera motion",
      "plane at any tilt, depth edges",
      "camera inside the object, empty model, object behind the camera, field of view 0 or 180, image 1x1, 16384 wide",
      "threads 1..N, any tile size, SIMD on or off",
      "objects touching, coplanar faces",
      "objects overlapping, one outline or one each",
      "object cut by the frame",
      "orthographic beside perspective",
      "mirrored transform",
      "multisampling",
      "the same picture at other sizes",
      "concave corners",
      "grazing curved surfaces",
      "extrude at boundaries and non-manifold edges",
  };
  return all;
}

std::string words_of(const StabilityCell& cell) {
  return fmt::format("{} on {}{}: {}; again: limn stability --case {} --seed {} --draws {}", cell.case_name, cell.surface,
                     cell.method.empty() ? "" : " by " + cell.method, cell.message, cell.case_name, cell.seed, cell.draw + 1);
}

TEST(StabilityCorpus, HasACaseForEveryRowOfTheCatalogue) {
  std::set<std::string> found, names;
  for (const StabilityCase& one : stability_corpus()) {
    found.insert(one.text.row);
    EXPECT_TRUE(names.insert(one.text.name).second) << one.text.name;
    EXPECT_TRUE(std::find(rows().begin(), rows().end(), one.text.row) != rows().end()) << one.text.name << ": " << one.text.row;
  }
  for (const std::string& row : rows()) EXPECT_TRUE(found.contains(row)) << row;
}

/// Seeds whose contours went back and forth between the two arms beside a cusp, twenty times in the first, or came back there at all.
TEST(StabilityCorpus, ContoursThatWentToAndFroBesideTheirCuspsAreRight) {
  const std::vector<StabilityCase> corpus = stability_corpus();
  const auto torus =
      std::find_if(corpus.begin(), corpus.end(), [](const StabilityCase& one) { return one.text.name == "cusps_of_a_torus"; });
  ASSERT_NE(torus, corpus.end());
  for (const unsigned seed : {96u, 342u, 373u, 422u, 430u, 609u, 652u}) {
    StabilityRunSettings settings;
    settings.seed = seed;
    settings.draws = 1;
    const StabilityResults run = run_stability({*torus}, settings);
    ASSERT_EQ(run.cells.size(), 1u);
    EXPECT_EQ(run.cells[0].outcome, StabilityOutcome::held) << "seed " << seed << ": " << words_of(run.cells[0]);
  }
}

/// Draws of which single pixels of a hull's folds stood beside the fold, in the picture of a mesh, a field or a level set.
TEST(StabilityCorpus, FoldsOfExtrudeInConcaveCornersAreOnePiece) {
  const std::vector<StabilityCase> corpus = stability_corpus();
  const auto corners =
      std::find_if(corpus.begin(), corpus.end(), [](const StabilityCase& one) { return one.text.name == "concave_corners"; });
  ASSERT_NE(corners, corpus.end());
  StabilityRunSettings settings;
  settings.seed = 1000;
  settings.draws = 53;
  settings.surfaces = {"analytic", "level_set", "mesh"};
  settings.methods = {"extrude"};
  const StabilityResults run = run_stability({*corners}, settings);
  EXPECT_EQ(run.cells.size(), 2u * 3u * 53u);
  for (const StabilityCell& cell : run.cells) EXPECT_EQ(cell.outcome, StabilityOutcome::held) << words_of(cell);
}

/// LIMN_ALL=1: everything the corpus holds, several draws; else one case of each check, drawn at random.
TEST(StabilityCorpus, NothingIsWrongWhateverTheSeed) {
  const bool all = std::getenv("LIMN_ALL") != nullptr;
  const std::vector<StabilityCase> corpus = stability_corpus();
  std::mt19937 random(random_seed());
  const auto start = static_cast<std::uint64_t>(random() % 1'000'000'000);
  fmt::print("draws from {}\n", start);
  if (all) {
    StabilityRunSettings settings;
    settings.seed = start;
    settings.draws = 4;
    for (const StabilityCell& cell : run_stability(corpus, settings).cells)
      EXPECT_NE(cell.outcome, StabilityOutcome::wrong) << words_of(cell);
    return;
  }
  std::vector<size_t> order(corpus.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), random);
  // One case of each check.
  std::set<std::string> checks;
  for (size_t i = 0; i < order.size(); ++i) {
    const StabilityCase& one = corpus[order[i]];
    if (!checks.insert(one.text.check).second) continue;
    StabilityRunSettings settings;
    settings.seed = start + i;
    settings.draws = 1;
    settings.surfaces = {one.surfaces[random() % one.surfaces.size()]};
    for (const StabilityCell& cell : run_stability({one}, settings).cells)
      EXPECT_NE(cell.outcome, StabilityOutcome::wrong) << words_of(cell);
  }
}

TEST(StabilityCorpus, ContoursThatCloseBetweenTwoCrossingsDoNotTurnBackThere) {
  StabilityRunSettings settings;
  settings.seed = 287912518;  // the last crossing lay 0.004 px beyond the first
  settings.draws = 1;
  for (const StabilityCase& one : stability_corpus()) {
    if (one.text.name != "cusps_of_a_torus") continue;
    const std::vector<StabilityCell> cells = run_stability({one}, settings).cells;
    ASSERT_EQ(cells.size(), 1u);
    EXPECT_EQ(cells[0].outcome, StabilityOutcome::held) << words_of(cells[0]);
    return;
  }
  FAIL() << "no such case";
}

TEST(StabilityCorpus, DrawnParametersLieInTheirRangesAndHangOnTheSeedAlone) {
  const std::vector<StabilityCase> corpus = stability_corpus();
  EXPECT_TRUE(rc::check([&corpus](std::uint64_t seed) {
    for (const StabilityCase& one : corpus) {
      for (const int draw : {0, 3}) {
        const auto values = drawn_parameters(one, seed, draw);
        RC_ASSERT(values == drawn_parameters(one, seed, draw));
        for (const auto& [name, range] : one.random) {
          RC_ASSERT(values.at(name) >= range.low && values.at(name) <= range.high);
          RC_ASSERT(!range.whole || values.at(name) == std::floor(values.at(name)));
        }
      }
    }
  }));
}

/// A case about a cube seen in parallel, of which `head` and `rest` say the particulars.
std::string cube_case(const std::string& check, const std::string& head, const std::string& rest = "") {
  return "[case]\nrow = \"r\"\nbreaks = \"b\"\nholds = \"h\"\ncheck = \"" + check + "\"\nsizes = [[40, 30]]\n" + head + "\n" + rest +
         "\n[camera]\neye = [3, 2, 4]\northo = 4\n[surface]\nvoxels = 16\nlevel = 1\n[[object]]\nshape = \"box\"\n";
}

StabilityCell only_cell(const std::string& text) {
  const StabilityResults results = run_stability({parse_case(text, "test.toml")}, {});
  if (results.cells.size() != 1) throw std::runtime_error(fmt::format("{} cells", results.cells.size()));
  return results.cells[0];
}

const std::string kRim = "surfaces = [\"analytic\"]\nmethods = [\"rim\"]\n";

TEST(StabilityJudge, EveryOutcomeCanComeAbout) {
  const std::string ink = "no_false_lines";  // A cube in the middle of the picture has some.
  const auto outcome = [&](const std::string& head, const std::string& rest = "") { return only_cell(cube_case(ink, kRim + head, rest)); };
  const double pixels = outcome("bound = 1e9").number;
  ASSERT_GT(pixels, 10.0);
  EXPECT_EQ(outcome("bound = 1e9").outcome, StabilityOutcome::held);
  EXPECT_EQ(outcome("bound = 1\nouter = 1e9").outcome, StabilityOutcome::degraded);
  EXPECT_EQ(outcome("bound = 1\nouter = 2").outcome, StabilityOutcome::wrong);
  const std::string says = "says = \"undefined (zero curvature)\"";
  EXPECT_EQ(outcome("", "[[expect]]\nfails = [1, 1e9]\n" + says).outcome, StabilityOutcome::fails_as_expected);
  EXPECT_EQ(outcome("", "[[expect]]\nfails = [1, 1e9]\nsays = \"nothing of the kind\"").outcome, StabilityOutcome::wrong);
  EXPECT_EQ(outcome("", "[[expect]]\nfails = [1e8, 1e9]\n" + says).outcome, StabilityOutcome::wrong);
  EXPECT_EQ(outcome("bound = 1e9", "[[expect]]\nfails = [1, 1e9]\n" + says).outcome, StabilityOutcome::held) << "better than expected";
  EXPECT_EQ(outcome("bound = 1e9\n" + says).outcome, StabilityOutcome::held);
  EXPECT_EQ(outcome("bound = 1e9\nsays = \"nothing of the kind\"").outcome, StabilityOutcome::wrong);
  EXPECT_EQ(outcome("bound = 1e9", "[[expect]]\nrefused = \"cannot\"").outcome, StabilityOutcome::wrong) << "not refused";
  EXPECT_EQ(outcome("", "[[expect]]\nmethods = [\"sobel\"]\nbound = 1e9").outcome, StabilityOutcome::wrong) << "of another method";
  EXPECT_EQ(outcome("", "[[expect]]\nmethods = [\"rim\"]\nsurfaces = [\"analytic\"]\nbound = 1e9").outcome, StabilityOutcome::held);
}

TEST(StabilityJudge, RefusalsHaveToBeExpectedInTheirWords) {
  const auto refused = [](const std::string& words) {
    return only_cell(cube_case("finite_field", "surfaces = [\"analytic\"]", words.empty() ? "" : "[[expect]]\nrefused = \"" + words + "\""))
        .outcome;
  };
  EXPECT_EQ(refused(""), StabilityOutcome::wrong);
  EXPECT_EQ(refused("no points"), StabilityOutcome::held);
  EXPECT_EQ(refused("no lines"), StabilityOutcome::wrong);
}

TEST(StabilityJudge, WhatCannotRunIsSkippedWithItsReason) {
  const StabilityCell cell = only_cell(cube_case("finite_outputs", "surfaces = [\"analytic\"]\nmethods = [\"edge_quads\"]"));
  EXPECT_EQ(cell.outcome, StabilityOutcome::skipped);
  EXPECT_FALSE(cell.message.empty());
}

TEST(StabilityChecks, InkWidthIsThatOfARingOfInk) {
  for (const int asked : {2, 4, 8}) {
    const StabilityCell cell =
        only_cell(fmt::format("[case]\nrow = \"r\"\nbreaks = \"b\"\nholds = \"h\"\ncheck = \"ink_width\"\nsurfaces = [\"analytic\"]\nbound "
                              "= 1e9\n[with]\nwidth = "
                              "0\n[[border]]\nmethod = \"rim_width\"\nwidth = {}.0\n[[object]]\nshape = \"sphere\"\n",
                              asked));
    // A disc among pixels is off by up to one on either side.
    EXPECT_NEAR(cell.number, asked, 1.5) << cell.message;
  }
}

/// A torus seen nearly from the side: above its near rim a strip of the far one, whose border touches the near one's.
TEST(StabilityChecks, InkWidthIsOfOneBorderWhereTwoTouch) {
  const StabilityCell cell = only_cell(
      "[case]\nrow = \"r\"\nbreaks = \"b\"\nholds = \"h\"\ncheck = \"ink_width\"\nsurfaces = [\"analytic\"]\nsizes = [[160, 120]]\nbound "
      "= 1e9\n[with]\nwidth = 0\n[[border]]\nmethod = \"rim_width\"\nwidth = 3.0\n[camera]\neye = [0.0, 0.7, 8.0]\ntarget = [0.0, 0.0, "
      "0.0]\nfov = 25\n[[object]]\nshape = \"torus\"\nmajor = 1.0\nminor = 0.35\n");
  EXPECT_NEAR(cell.number, 3.0, 0.5) << cell.message;
}

TEST(StabilityRun, IsTheSameForEqualSeedsAndAnyThreads) {
  const std::vector<StabilityCase> cases{find_stability_case("cube_faces"), find_stability_case("nested_and_crossing")};
  const auto text = [&](std::uint64_t seed, int threads) {
    StabilityRunSettings settings;
    settings.seed = seed;
    settings.how.threads = threads;
    settings.longest_side_px = 40;
    return stability_json(run_stability(cases, settings)).dump();
  };
  EXPECT_EQ(text(5, 1), text(5, 2));
  EXPECT_NE(text(5, 1), text(6, 1));
}

/// "all" by the list of methods, less `without`, then the [[border]]s; of these the methods asked for.
TEST(StabilityRun, RunsAllMethodsButThoseLeftOutAndThenTheBordersOfTheScene) {
  const auto methods = [](const std::string& head, const std::vector<std::string>& wanted) {
    StabilityRunSettings settings;
    settings.methods = wanted;
    settings.longest_side_px = 20;
    std::vector<std::string> names;
    const std::string text =
        cube_case("finite_outputs", "surfaces = [\"analytic\"]\n" + head, "[[border]]\nmethod = \"rim\"\nthreshold = 0.3\n");
    for (const StabilityCell& cell : run_stability({parse_case(text, "test.toml")}, settings).cells) names.push_back(cell.method);
    return names;
  };
  const std::vector<std::string> all = methods("methods = \"all\"\nwithout = [\"sobel\", \"blur\"]", {});
  ASSERT_EQ(all.size(), border_methods().size() - 2 + 1);
  EXPECT_EQ(all.front(), "rim threshold=0.4");
  EXPECT_EQ(all.back(), "rim threshold=0.3");
  for (const std::string& name : all) EXPECT_FALSE(name.starts_with("sobel") || name.starts_with("blur")) << name;
  EXPECT_EQ(methods("", {}), std::vector<std::string>{"rim threshold=0.3"});
  EXPECT_EQ(methods("methods = \"all\"", {"rim"}), (std::vector<std::string>{"rim threshold=0.4", "rim threshold=0.3"}));
  EXPECT_TRUE(methods("methods = [\"sobel\"]", {"blur"}).empty());
}

TEST(StabilityCase, FaultsInItsFileAreToldWithTheirPlace) {
  const auto fault = [](const std::string& text) -> std::string {
    try {
      parse_case(text, "test.toml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_NE(fault(cube_case("finite_output", "")).find("'finite_outputs'"), std::string::npos);
  EXPECT_NE(fault(cube_case("finite_outputs", "bond = 1")).find("'bound'"), std::string::npos);
  EXPECT_NE(fault(cube_case("finite_outputs", "methods = [\"rimm\"]")).find("'rim'"), std::string::npos);
  EXPECT_NE(fault(cube_case("finite_outputs", "methods = \"all\"\nwithout = [\"rimm\"]")).find("'rim'"), std::string::npos);
  EXPECT_NE(fault(cube_case("finite_outputs", "methods = [\"rim\"]\nwithout = [\"rim\"]")).find("without"), std::string::npos);
  EXPECT_NE(fault(cube_case("finite_outputs", "", "[[expect]]\nfails = [1, 2]")).find("says"), std::string::npos);
  EXPECT_NE(fault(cube_case("finite_outputs", "") + "radius = 3\n").find("test.toml:"), std::string::npos) << "a box has none";
  EXPECT_NE(fault("[[object]]\nshape = \"box\"\n").find("[case]"), std::string::npos);
}

TEST(StabilityCommand, FailsWhereACellIsWrongAndWritesItsRecords) {
  const TemporaryFolder folder;
  const std::string good = folder.write("good.toml", cube_case("no_false_lines", kRim + "bound = 1e9"));
  const std::string bad = folder.write("bad.toml", cube_case("no_false_lines", kRim + "bound = 1"));
  const RunResult fine = run_limn({"stability", "--case", good, "-o", folder.file("out"), "--json"});
  EXPECT_EQ(fine.exit_code, 0) << fine.err;
  EXPECT_EQ(fine.json().at("counts").at("held"), 1);
  const RunResult wrong = run_limn({"stability", "--case", good, "--case", bad, "-o", folder.file("out"), "--seed", "7"});
  EXPECT_EQ(wrong.exit_code, 1) << wrong.err;
  EXPECT_NE(wrong.out.find("wrong: bad, analytic, rim"), std::string::npos) << wrong.out;
  EXPECT_NE(wrong.out.find("--seed 7"), std::string::npos) << wrong.out;
  const auto written = nlohmann::json::parse(read_bytes(folder.path() / "out" / "results.json"));
  ASSERT_EQ(written.at("cells").size(), 2u);
  for (const auto& cell : written.at("cells")) {
    for (const char* key : {"case", "row", "draw", "surface", "method", "outcome", "number", "unit", "bound", "outer", "message", "said",
                            "picture", "seed", "parameters"})
      EXPECT_TRUE(cell.contains(key)) << key;
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "out" / std::string(cell.at("picture")))) << cell.at("picture");
  }
  EXPECT_EQ(run_limn({"stability", "--case", good, "-o", folder.file("out"), "-q"}).out, "");
}

TEST(StabilityCommand, IsStillTakenAsAStudyWithAHint) {
  const TemporaryFolder folder;
  const std::string good = folder.write("good.toml", cube_case("no_false_lines", kRim + "bound = 1e9"));
  const RunResult old = run_limn({"study", "stability", "--case", good, "-o", folder.file("out")});
  EXPECT_EQ(old.exit_code, 0) << old.err;
  EXPECT_NE(old.err.find("is now limn stability"), std::string::npos) << old.err;
}

TEST(StabilityCommand, RefusesWhatDoesNotBelongToIt) {
  EXPECT_EQ(run_limn({"stability", "--levels", "2"}).exit_code, 2);
  EXPECT_EQ(run_limn({"study", "stability", "--levels", "2"}).exit_code, 2);
  EXPECT_EQ(run_limn({"study", "ellipsoid", "--case", "cube_faces"}).exit_code, 2);
  const RunResult unknown = run_limn({"stability", "--case", "cube_face"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("'cube_faces'"), std::string::npos) << unknown.err;
}

}  // namespace
}  // namespace limn
