// Every check of the stability corpus finds what is wrong where something is: a case that must not hold, for each.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <map>

#include "samples/stability/checks/check.h"
#include "samples/stability/run_stability.h"

namespace limn {
namespace {

struct Broken {
  std::string head;  ///< Of [case], after the check's name: surfaces and methods.
  std::string rest;  ///< [with], [[border]], [[variant]], [set].
  std::string objects = "[[object]]\nshape = \"sphere\"\n";
  double at_least = 1.0;  ///< What the check has to find.
};

const std::string kAnalytic = "surfaces = [\"analytic\"]\n", kRim = kAnalytic + "methods = [\"rim\"]\n";
const std::string kSmaller = "[[object]]\nshape = \"sphere\"\n[[reference]]\nshape = \"sphere\"\nradius = 0.7\n";
const std::string kLarger = "[[object]]\nshape = \"sphere\"\n[[reference]]\nshape = \"sphere\"\nradius = 1.2\n";
const std::string kChanging = "[[object]]\nshape = \"sphere\"\nradius = \"$r\"\n",
                  kChange = "[set]\nr = 1.0\n[[variant]]\nset = { r = 0.8 }\n";
const std::string kBox = "[[object]]\nshape = \"box\"\n", kCoarse = "[surface]\nvoxels = 6\nlevel = 0\nnormals = \"flat\"\n";

/// A ball twice, whose facets, as coarse as they are, cut through each other in many places.
const std::string kAlmostOne = "[[object]]\nshape = \"sphere\"\n[[object]]\nshape = \"sphere\"\nrotate = [1.0, 2.0, 3.0, 40.0]\n";

const std::multimap<std::string, Broken>& broken() {
  static const std::multimap<std::string, Broken> all{
      {"border_within", {kAnalytic, "", kSmaller, 3.0}},
      {"border_within", {kAnalytic, "[with]\nkind = \"silhouette\"\nstatistic = \"p95\"\n", kLarger, 2.0}},
      {"clean_seams", {"surfaces = [\"mesh\"]\nmethods = [\"distance\"]\n", "[with]\naway_px = 1\n" + kCoarse, kAlmostOne, 2.0}},
      {"continuous",
       {kRim, "[set]\nsweep = 0\n[with]\nfrom = 0\nto = 90\nsteps = 9\n",
        "[[object]]\nshape = \"box\"\nrotate = [0.0, 1.0, 0.0, \"$sweep\"]\n", 0.1}},
      {"even_cusps", {kAnalytic, "[camera]\neye = [0.2, 0.1, 0.0]\ntarget = [1.0, 0.0, 0.0]\n"}},
      {"faces_whole", {kRim, "", "[[object]]\nshape = \"sphere\"\n", 1.0}},
      {"finite_field",
       {kAnalytic, "[with]\npoints = [[0.8, 0.3, 0.2]]\nbeside = 0.3\n", "[[object]]\nshape = \"ellipsoid\"\nradii = [1.0, 0.6, 0.4]\n",
        0.1}},
      {"finite_outputs", {kRim, "[with]\nhits = 1\n"}},
      {"flicker_confined", {kAnalytic, "[[border]]\nmethod = \"rim\"\nthreshold = 0.7\n", "[[object]]\nshape = \"sphere\"\n", 0.2}},
      {"flips_beyond", {"surfaces = [\"level_set\"]\nmethods = [\"rim\"]\n", kCoarse, "[[object]]\nshape = \"sphere\"\n", 0.001}},
      {"frame_free", {kRim, ""}},
      {"ink_width",
       {kAnalytic, "[with]\nwidth = 0\n[[border]]\nmethod = \"rim\"\nthreshold = 0.9\n", "[[object]]\nshape = \"sphere\"\n", 3.0}},
      {"mirror_picture", {kRim, kChange, kChanging, 10.0}},
      {"no_false_lines", {kRim, "", kBox, 10.0}},
      {"no_holes", {kAnalytic, "", kLarger, 10.0}},
      {"no_holes", {kAnalytic, "", kSmaller, 10.0}},
      {"normals_within", {"surfaces = [\"mesh\"]\n", kCoarse, "[[object]]\nshape = \"sphere\"\n", 5.0}},
      {"one_closed_component", {kRim, "[with]\npieces = 4\n"}},
      {"same_picture", {kRim, kChange, kChanging, 10.0}},
      {"same_picture", {kRim, kChange + "[with]\nexact = true\n", kChanging, 10.0}},
      {"same_width",
       {kRim, "[with]\northographic = true\n[camera]\neye = [0, 0, 1.6]\nfov = 100\n", "[[object]]\nshape = \"sphere\"\n", 0.3}},
      {"samples_agree", {kAnalytic, "[with]\nlook = \"alpha\"\n[[border]]\nmethod = \"blur\"\nstrength = 0.3\n", kBox, 0.5}},
      {"sign_right", {"surfaces = [\"level_set\"]\n", "", kSmaller, 10.0}},
      {"unchanged_beyond", {kRim, kChange + "[with]\npath = [[5, 5, 5], [5, 5, 6]]\n", kChanging, 3.0}},
      {"width_within", {kAnalytic, "[with]\nwidth = 1\n[[border]]\nmethod = \"rim_width\"\nwidth = 6.0\n"}},
  };
  return all;
}

TEST(StabilityChecks, EveryOneFindsWhatIsWrong) {
  for (const auto& [check, one] : broken()) {
    const auto unless_given = [&rest = one.rest](const std::string& table, const std::string& text) {
      return rest.find(table) == std::string::npos ? table + text : "";
    };
    const std::string camera = unless_given("[camera]", "\neye = [3, 2, 4]\northo = 4\n"),
                      surface = unless_given("[surface]", "\nvoxels = 16\nlevel = 2\n");
    const std::string text =
        fmt::format("[case]\nrow = \"r\"\nbreaks = \"b\"\nholds = \"h\"\ncheck = \"{}\"\nsizes = [[60, 45]]\n{}{}{}{}{}", check, one.head,
                    one.rest, camera, surface, one.objects);
    for (const StabilityCell& cell : run_stability({parse_case(text, "broken.toml")}, {}).cells) {
      EXPECT_GE(cell.number, one.at_least) << check << ": " << cell.message;
      EXPECT_EQ(cell.outcome, StabilityOutcome::wrong) << check << ": " << cell.message;
      EXPECT_FALSE(cell.message.empty()) << check;
    }
  }
  for (const StabilityCheck& check : stability_checks()) EXPECT_TRUE(broken().contains(check.about.name)) << check.about.name;
}

}  // namespace
}  // namespace limn
