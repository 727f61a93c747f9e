#include "tests/bench/image_methods.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "raymarch/picture.h"
#include "sdf/shape.h"

namespace limn::bench {
namespace {

constexpr double kLimit = 2.0, kFloodLimit = 1.5;
constexpr int kBlurRadius_px = 8;

struct Work {
  std::string name;
  std::function<void()> run;
  int peer_of = -1;       ///< Index of our own work that it is held against; -1: ours.
  double limit = kLimit;  ///< Of our time over the peer's; 0: told, and held to none.
  std::vector<double> times_ms{}, cpu_ms{};
};

/// What the methods read and what OpenCV reads: the same picture.
struct Input {
  Scene scene;
  Camera camera;
  SceneModel model;
  GBuffer seen;
  std::vector<cv::Mat> channels;  ///< Depth (0 where nothing is hit), normal x y z, id.
  cv::Mat mask, empty;            ///< float 0/1; 8 bit, 0 on the object's inner border as distanceTransform wants it.
};

SceneObject object(const std::string& shape, const glm::vec3& color) {
  SceneObject made{.name = shape, .source = make_shape(shape)};
  made.color = color;
  return made;
}

Input make_input(const ImageBenchSettings& settings) {
  Input input;
  input.scene.objects = {object("torus", {0.8f, 0.5f, 0.3f}), object("sphere", {0.3f, 0.5f, 0.8f})};
  input.scene.camera.width_px = settings.width_px;
  input.scene.camera.height_px = settings.height_px;
  input.camera = resolve_camera(input.scene.camera, bounds(input.scene));
  input.model = build_model(input.scene, {.kind = "analytic"});
  input.seen = render_gbuffer(input.model, input.camera, {});
  for (int i = 0; i < 5; ++i) input.channels.emplace_back(settings.height_px, settings.width_px, CV_32F);
  input.mask.create(settings.height_px, settings.width_px, CV_32F);
  input.empty.create(settings.height_px, settings.width_px, CV_8U);
  for (int y = 0; y < settings.height_px; ++y) {
    for (int x = 0; x < settings.width_px; ++x) {
      const size_t i = input.seen.id.index(x, y);
      const bool hit = input.seen.id.pixels[i] != 0;
      input.channels[0].at<float>(y, x) = hit ? input.seen.depth.pixels[i] : 0.0f;
      for (int k = 0; k < 3; ++k) input.channels[static_cast<size_t>(k + 1)].at<float>(y, x) = input.seen.normal.pixels[i][k];
      input.channels[4].at<float>(y, x) = static_cast<float>(input.seen.id.pixels[i]);
      input.mask.at<float>(y, x) = hit ? 1.0f : 0.0f;
      input.empty.at<std::uint8_t>(y, x) = hit ? 0 : 1;
    }
  }
  return input;
}

std::function<void()> ours(const Input& input, const std::string& method, const std::map<std::string, double>& numbers,
                           const std::map<std::string, std::string>& words = {}) {
  std::map<std::string, ParameterInput> given;
  for (const auto& [name, number] : numbers) given[name].numbers = {number};
  for (const auto& [name, word] : words) given[name].word = word;
  const BorderMethod& found = find_border_method(method);
  return [&input, &found, parameters = resolve(found.parameters, given)] {
    const Border border = found.draw({input.seen, input.camera, input.model, input.scene}, parameters);
    if (border.coverage.pixels.empty()) throw std::logic_error("no border");
  };
}

/// Two Sobel passes for each of the channels [first, last), into new pictures as our methods make new ones.
std::function<void()> sobel_passes(const Input& input, size_t first, size_t last) {
  return [&input, first, last] {
    for (size_t c = first; c < last; ++c) {
      cv::Mat across, down;
      cv::Sobel(input.channels[c], across, CV_32F, 1, 0);
      cv::Sobel(input.channels[c], down, CV_32F, 0, 1);
    }
  };
}

std::vector<Work> all_work(const Input& input) {
  std::vector<Work> work;
  const auto pair = [&](const std::string& name, std::function<void()> run, const std::string& peer, std::function<void()> peer_run) {
    work.push_back({name, std::move(run)});
    work.push_back({peer, std::move(peer_run), static_cast<int>(work.size()) - 1});
  };
  constexpr int taps = 2 * kBlurRadius_px + 1;
  const auto precise = [&input] {
    cv::Mat distances;
    cv::distanceTransform(input.empty, distances, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  };
  pair("normal4", ours(input, "normal4", {}), "OpenCV 2 Sobel x 3 channels", sobel_passes(input, 1, 4));
  pair("roberts (depth, normal, id)", ours(input, "roberts", {}), "OpenCV 2 Sobel x 5 channels", sobel_passes(input, 0, 5));
  pair("sobel (depth, normal, id)", ours(input, "sobel", {}), "OpenCV 2 Sobel x 5 channels", sobel_passes(input, 0, 5));
  pair("blur box 8 px", ours(input, "blur", {{"radius", kBlurRadius_px}}, {{"kernel", "box"}}), "OpenCV blur", [&input] {
    cv::Mat out;
    cv::blur(input.mask, out, {taps, taps});
  });
  pair("blur gaussian 8 px", ours(input, "blur", {{"radius", kBlurRadius_px}}), "OpenCV GaussianBlur", [&input] {
    cv::Mat out;
    cv::GaussianBlur(input.mask, out, {taps, taps}, kBlurRadius_px / 3.0);
  });
  pair("distance 10 px", ours(input, "distance", {{"width", 10}}), "OpenCV distanceTransform, precise", precise);
  pair("distance 100 px", ours(input, "distance", {{"width", 100}}), "OpenCV distanceTransform, precise", precise);
  // Without the exact transform that counts its wrong pixels, which is another method's time; with it, as called without a word, below.
  const std::map<std::string, std::string> unchecked{{"check", "false"}};
  work.push_back({"jump_flood 10 px, check off", ours(input, "jump_flood", {{"width", 10}}, unchecked)});
  const int small = static_cast<int>(work.size()) - 1;
  work.push_back({"jump_flood 100 px, check off", ours(input, "jump_flood", {{"width", 100}}, unchecked)});
  // The wide outline is "ours", the narrow one what it is held against.
  work[static_cast<size_t>(small)].peer_of = small + 1;
  work[static_cast<size_t>(small)].limit = kFloodLimit;
  work.push_back({"OpenCV distanceTransform, precise", precise, small + 1});
  pair("jump_flood 100 px, check on", ours(input, "jump_flood", {{"width", 100}}), "OpenCV distanceTransform, precise", precise);
  work.back().limit = 0.0;
  return work;
}

nlohmann::json measure(std::vector<Work> work, int threads, const ImageBenchSettings& settings) {
  cv::setNumThreads(threads);
  tbb::task_arena arena(threads);
  arena.execute([&] {
    for (Work& each : work) each.run();  // first touch of memory is nobody's time
    for (int run = 0; run < settings.runs; ++run) {
      for (Work& each : work) {
        const auto start = std::chrono::steady_clock::now();
        const std::clock_t cpu_start = std::clock();
        each.run();
        each.times_ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
        each.cpu_ms.push_back(1e3 * static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC);
      }
    }
  });
  for (Work& each : work) {
    std::sort(each.times_ms.begin(), each.times_ms.end());
    std::sort(each.cpu_ms.begin(), each.cpu_ms.end());
  }
  const auto median = [](const Work& each) { return each.times_ms[each.times_ms.size() / 2]; };
  // Processor time of all threads: what a busy machine does not stretch.
  const auto median_cpu = [](const Work& each) { return each.cpu_ms[each.cpu_ms.size() / 2]; };
  nlohmann::json rows = nlohmann::json::array();
  for (const Work& each : work) {
    nlohmann::json row = {{"name", "image"},
                          {"object", fmt::format("{}x{}", settings.width_px, settings.height_px)},
                          {"threads", threads},
                          {"opencv_threads", cv::getNumThreads()},
                          {"contestant", each.name},
                          {"median_ms", median(each)},
                          {"min_ms", each.times_ms.front()},
                          {"max_ms", each.times_ms.back()},
                          {"cpu_ms", median_cpu(each)}};
    std::string verdict;
    if (each.peer_of >= 0) {
      const Work& held = work[static_cast<size_t>(each.peer_of)];
      const double share = median(held) / median(each);
      row["against"] = held.name;
      row["ratio"] = 1.0 / share;
      row["ours_over_peer"] = share;
      row["cpu_ours_over_peer"] = median_cpu(held) / std::max(1e-3, median_cpu(each));
      if (each.limit > 0.0) row["limit"] = each.limit;
      verdict = fmt::format("{} takes {:.2f} of it ({:.2f} of its processor time){}", held.name, share,
                            median_cpu(held) / std::max(1e-3, median_cpu(each)),
                            each.limit > 0.0 ? fmt::format(", limit {:.1f}", each.limit) : "");
    }
    fmt::print(settings.table, "{:10} {:3} {:36} {:9.2f} {:9.2f} {:9.2f}  {}\n", "image", threads, each.name, median(each),
               each.times_ms.front(), median_cpu(each), verdict);
    rows.push_back(std::move(row));
  }
  std::fflush(settings.table);
  return rows;
}

}  // namespace

nlohmann::json bench_image_methods(const ImageBenchSettings& settings) {
  const Input input = make_input(settings);
  const int before = cv::getNumThreads();
  fmt::print(settings.table, "\n{:10} {:>3} {:36} {:>9} {:>9} {:>9}  {}x{}, OpenCV {} with as many threads\n", "suite", "thr", "contestant",
             "median_ms", "min_ms", "cpu_ms", settings.width_px, settings.height_px, cv::getVersionString());
  nlohmann::json rows = nlohmann::json::array();
  for (const int threads : {1, 2}) {
    for (auto& row : measure(all_work(input), threads, settings)) rows.push_back(std::move(row));
  }
  cv::setNumThreads(before);
  return rows;
}

}  // namespace limn::bench
