#include "samples/output/picture_facts.h"

#include <fmt/format.h>

#include <glm/gtc/matrix_inverse.hpp>

namespace limn {
namespace {

/// Channels that belong together: "N" of N.X, N.Y and N.Z; no name for R, G, B and A; each other one by itself.
struct Layer {
  std::string name{};
  std::vector<const PictureChannel*> channels{};
};

bool is_color(const std::string& name) { return name == "R" || name == "G" || name == "B" || name == "A"; }

std::string layer_name(const std::string& channel) {
  const size_t dot = channel.rfind('.');
  if (dot != std::string::npos) return channel.substr(0, dot);
  return is_color(channel) ? "" : channel;
}

std::vector<Layer> layers_of(const PicturePart& part) {
  std::vector<Layer> layers;
  for (const PictureChannel& channel : part.channels) {
    const std::string name = layer_name(channel.name);
    if (layers.empty() || layers.back().name != name) layers.push_back({name, {}});
    layers.back().channels.push_back(&channel);
  }
  return layers;
}

struct PictureFinding {
  std::string check{}, severity{}, message{};
  std::int64_t value = 0;
};

/// Depth and position are infinite where nothing is hit; a NaN is nowhere meant.
std::vector<PictureFinding> findings_of(const PictureFile& picture) {
  std::vector<PictureFinding> findings;
  for (const PicturePart& part : picture.parts) {
    for (const PictureChannel& channel : part.channels) {
      if (channel.nan > 0)
        findings.push_back(
            {"not a number", "warning", fmt::format("{} values of {} are no numbers", channel.nan, channel.name), channel.nan});
      if (channel.infinite > 0 && channel.name != "Z" && layer_name(channel.name) != "P")
        findings.push_back(
            {"infinite", "warning", fmt::format("{} values of {} are infinite", channel.infinite, channel.name), channel.infinite});
    }
  }
  if (picture.format == "openexr" && picture.version.empty())
    findings.push_back({"foreign", "info", "not written by limn: no limn:version in its header", 0});
  return findings;
}

Json matrix_json(const std::optional<glm::dmat4>& matrix) {
  if (!matrix) return nullptr;
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row) {
    Json values = Json::array();
    for (int column = 0; column < 4; ++column) values.push_back((*matrix)[column][row]);
    rows.push_back(std::move(values));
  }
  return rows;
}

Json part_json(const PicturePart& part) {
  Json layers = Json::array();
  for (const Layer& layer : layers_of(part)) {
    Json channels = Json::array();
    for (const PictureChannel* channel : layer.channels) {
      channels.push_back({{"name", channel->name},
                          {"type", channel->type},
                          {"min", number_or_null(channel->least)},
                          {"max", number_or_null(channel->most)},
                          {"nan", channel->nan},
                          {"infinite", channel->infinite}});
    }
    layers.push_back({{"name", layer.name}, {"channels", std::move(channels)}});
  }
  return {{"name", part.name},
          {"width_px", part.width_px},
          {"height_px", part.height_px},
          {"compression", part.compression},
          {"layers", std::move(layers)}};
}

std::string layer_text(const Layer& layer) {
  std::string names, types;
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const PictureChannel* channel : layer.channels) {
    const size_t dot = channel->name.rfind('.');
    names += (names.empty() ? "" : " ") + (dot == std::string::npos ? channel->name : channel->name.substr(dot + 1));
    if (types.find(channel->type) == std::string::npos) types += (types.empty() ? "" : ", ") + channel->type;
    least = std::fmin(least, channel->least);
    most = std::fmax(most, channel->most);
  }
  const std::string range = least <= most ? fmt::format("{:g} to {:g}", least, most) : "no finite value";
  return fmt::format("  layer    {:<24} {:<10} {:<8} {}\n", layer.name.empty() ? "(color)" : layer.name, names, types, range);
}

std::string camera_text(const glm::dmat4& camera_from_world) {
  const glm::dmat4 world_from_camera = glm::inverse(camera_from_world);
  const glm::dvec3 eye(world_from_camera[3]), direction(-world_from_camera[2]);
  if (!std::isfinite(glm::dot(eye, eye) + glm::dot(direction, direction))) return "";
  // What is left of rounding in the file's single precision is no place.
  const auto clean = [](double value) { return std::abs(value) < 1e-6 ? 0.0 : value; };
  return fmt::format("  camera   at [{:.6g}, {:.6g}, {:.6g}] looking along [{:.4g}, {:.4g}, {:.4g}]\n", clean(eye.x), clean(eye.y),
                     clean(eye.z), clean(direction.x), clean(direction.y), clean(direction.z));
}

}  // namespace

Json picture_json(const PictureFile& picture) {
  Json parts = Json::array(), audit = Json::array();
  std::int64_t channels = 0;
  for (const PicturePart& part : picture.parts) {
    parts.push_back(part_json(part));
    channels += static_cast<std::int64_t>(part.channels.size());
  }
  for (const PictureFinding& finding : findings_of(picture))
    audit.push_back({{"check", finding.check}, {"severity", finding.severity}, {"value", finding.value}, {"message", finding.message}});
  return {{"kind", "picture"},
          {"bounds", nullptr},
          {"counts",
           {{"width_px", picture.parts.front().width_px},
            {"height_px", picture.parts.front().height_px},
            {"parts", picture.parts.size()},
            {"channels", channels}}},
          {"audit", std::move(audit)},
          {"format", picture.format},
          {"software", picture.software},
          {"limn",
           {{"version", picture.version},
            {"call", picture.call},
            {"camera_from_world", matrix_json(picture.camera_from_world)},
            {"ndc_from_world", matrix_json(picture.ndc_from_world)}}},
          {"parts", std::move(parts)}};
}

std::string picture_text(const PictureFile& picture, const std::string& name) {
  std::string text;
  for (const PicturePart& part : picture.parts) {
    text += fmt::format("{}{}: picture, {} x {}, {}{}\n", name, part.name.empty() ? "" : " (" + part.name + ")", part.width_px,
                        part.height_px, picture.format, part.compression.empty() ? "" : ", " + part.compression);
    for (const Layer& layer : layers_of(part)) text += layer_text(layer);
  }
  if (!picture.software.empty()) text += "  made by  " + picture.software + "\n";
  if (!picture.call.empty()) text += "  call     " + picture.call + "\n";
  if (picture.camera_from_world) text += camera_text(*picture.camera_from_world);
  for (const PictureFinding& finding : findings_of(picture))
    text += fmt::format("  {:<8} {:<24} {}\n", finding.severity, finding.check, finding.message);
  return text;
}

}  // namespace limn
