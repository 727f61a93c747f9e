// limn contours --frames: files, ids, events; and lines followed around built-in scenes.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <regex>
#include <set>

#include "raymarch/frames.h"
#include "raymarch/line_tracks.h"
#include "samples/experiment/job.h"
#include "samples/scenes/scenes.h"
#include "tests/samples/run_program.h"

namespace limn {
namespace {

std::vector<int> ids_in(const std::string& svg) {
  std::vector<int> ids;
  const std::regex id("data-id=\"([0-9]+)\"");
  for (std::sregex_iterator at(svg.begin(), svg.end(), id), end; at != end; ++at) ids.push_back(std::stoi((*at)[1]));
  return ids;
}

TEST(ContoursFrames, AreFilesWhosePathsKeepTheirIds) {
  const TemporaryFolder folder;
  const RunResult run = run_limn({"contours", "tilted_torus", "--size", "240x180", "--frames", "5", "--turn", "25", "--json", "-q", "-o",
                                  folder.file("film.svg"), "-o", folder.file("film.json")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json all = run.json();
  ASSERT_EQ(all.at("frames").size(), 5u);
  EXPECT_EQ(all.at("files").size(), 10u);
  EXPECT_EQ(all.at("tracks").at("unexplained"), 0) << all.at("tracks");
  std::set<int> seen;
  for (int k = 0; k < 5; ++k) {
    const nlohmann::json graph = nlohmann::json::parse(read_bytes(folder.file(fmt::format("film_f{}.json", k))));
    std::multiset<int> visible;
    for (size_t c = 0; c < graph.at("chains").size(); ++c) {
      EXPECT_EQ(graph.at("chains")[c].at("id"), all.at("frames")[static_cast<size_t>(k)].at("ids")[c]);
      if (graph.at("chains")[c].at("invisibility") == 0) visible.insert(graph.at("chains")[c].at("id").get<int>());
    }
    const std::vector<int> drawn = ids_in(read_bytes(folder.file(fmt::format("film_f{}.svg", k))));
    EXPECT_EQ(std::multiset<int>(drawn.begin(), drawn.end()), visible) << k;
    EXPECT_EQ(std::set<int>(drawn.begin(), drawn.end()).size(), drawn.size()) << "an id twice in frame " << k;
    seen.insert(drawn.begin(), drawn.end());
  }
  // Only births and splits bring ids beside those of the first frame.
  std::set<int> known;
  for (const int id : ids_in(read_bytes(folder.file("film_f0.svg")))) known.insert(id);
  for (const nlohmann::json& event : all.at("tracks").at("events")) {
    if (event.at("change") == "birth" || event.at("change") == "split") known.insert(event.at("id").get<int>());
  }
  for (const int id : seen) EXPECT_TRUE(known.count(id)) << id;
}

TEST(ContoursFrames, OfACameraThatWandersWithinAPixelKeepAllIds) {
  const TemporaryFolder folder;
  const RunResult run =
      run_limn({"contours", "ellipsoid", "--size", "240x180", "--frames", "4", "--json", "-q", "-o", folder.file("a.svg")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.json().at("tracks").at("ids"), 1);
  EXPECT_EQ(folder.files(), (std::vector<std::string>{"a_f0.svg", "a_f1.svg", "a_f2.svg", "a_f3.svg"}));
}

TEST(ContoursFrames, AnAnimationIsOneFileWithAGroupAFrame) {
  const TemporaryFolder folder;
  const RunResult run = run_limn(
      {"contours", "ellipsoid", "--size", "240x180", "--frames", "4", "--turn", "90", "--animate", "-q", "-o", folder.file("a.svg")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(folder.files(), std::vector<std::string>{"a.svg"});
  const std::string svg = read_bytes(folder.file("a.svg"));
  for (int k = 0; k < 4; ++k) EXPECT_NE(svg.find(fmt::format("id=\"frame-{}\"", k)), std::string::npos);
  EXPECT_EQ(ids_in(svg), (std::vector<int>{0, 0, 0, 0}));
}

TEST(ContoursFrames, OptionsThatDoNotGoTogetherAreRefused) {
  const TemporaryFolder folder;
  const std::vector<std::vector<std::string>> calls = {{"--turn", "90"},
                                                       {"--animate"},
                                                       {"--frames", "3", "--views", "2"},
                                                       {"--frames", "3", "--turn", "90", "--seed", "2"},
                                                       {"--frames", "3", "--fps", "10"},
                                                       {"--frames", "3", "--animate", "-o", "a.pdf"},
                                                       {"--frames", "3", "--animate", "--fps", "0"}};
  for (const auto& arguments : calls) {
    std::vector<std::string> call = {"contours", "ellipsoid", "--size", "64x48"};
    call.insert(call.end(), arguments.begin(), arguments.end());
    const RunResult run = run_limn(call, folder.path());
    EXPECT_EQ(run.exit_code, 2) << fmt::format("{}: {}", fmt::join(arguments, " "), run.err);
  }
  EXPECT_EQ(folder.files(), std::vector<std::string>{});
}

/// A scene, the picture's size, and how many frames are looked at unless LIMN_FRAMES says so.
struct Walk {
  const char* scene;
  int width_px, height_px, frames;
};

/// LIMN_FRAMES=240: once around; by default the first of these frames.
TEST(ContoursFrames, AroundScenesVisibleLinesAppearAndVanishAtEventsOfTheGraphOnly) {
  constexpr int kAround = 240;
  const char* const wanted = std::getenv("LIMN_FRAMES");
  for (const Walk& walk : {Walk{"teacup", 320, 180, 10}, Walk{"rook", 640, 360, 20}, Walk{"gyroid", 192, 108, 2}}) {
    const std::string name = walk.scene;
    const int frames = wanted != nullptr ? std::atoi(wanted) : walk.frames;
    const Scene scene = find_scene(name)->make();
    CameraSettings settings = scene.camera;
    settings.width_px = walk.width_px;
    settings.height_px = walk.height_px;
    const Camera first = camera_of_view(settings, {bounds(scene), {}}, {}, 0, 1);
    const GraphAt graph_at = [&](double time) {
      return solve_lines(scene, turned_camera(first, *settings.target, settings.up, 2.0 * std::numbers::pi * time / kAround), {}, {});
    };
    LineTracks tracks;
    ViewGraph before = graph_at(0.0);
    std::vector<int> ids = first_ids(before, tracks);
    for (int k = 1; k <= frames; ++k) {
      ViewGraph graph = graph_at(k);
      const size_t known = tracks.events.size();
      std::set<int> visible, visible_before;
      for (size_t c = 0; c < ids.size(); ++c) {
        if (before.chains[c].invisibility == 0) visible_before.insert(ids[c]);
      }
      ids = follow_chains(before, ids, k - 1, graph, k, graph_at, {}, tracks);
      for (size_t c = 0; c < ids.size(); ++c) {
        if (graph.chains[c].invisibility > 0) continue;
        EXPECT_TRUE(visible.insert(ids[c]).second) << name << ": an id twice in frame " << k;
      }
      // What is there in one frame and not in the next has an event, and no event is of what was always there.
      for (size_t e = known; e < tracks.events.size(); ++e) {
        const ChainEvent& event = tracks.events[e];
        if (event.change == ChainChange::birth || event.change == ChainChange::split) visible_before.insert(event.id);
      }
      for (size_t e = known; e < tracks.events.size(); ++e) {
        const ChainEvent& event = tracks.events[e];
        if (event.change != ChainChange::death && event.change != ChainChange::merge) continue;
        EXPECT_EQ(visible_before.erase(event.id), 1u) << name;
      }
      EXPECT_EQ(visible, visible_before) << name << ", frame " << k;
      before = std::move(graph);
    }
    for (const ChainEvent& event : tracks.events) {
      EXPECT_NE(event.cause, ChainCause::unexplained)
          << fmt::format("{}: {} of {} between {} and {} at {}, {}: {} px", name, name_of(event.change), event.id, event.from, event.to,
                         event.px.x, event.px.y, event.length_px);
    }
  }
}

}  // namespace
}  // namespace limn
