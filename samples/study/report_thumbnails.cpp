#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "samples/page/html.h"
#include "samples/study/report_page.h"

namespace limn {
namespace {

// Width and height stand at fixed places behind the signature (PNG, third edition, 11.2.1); 0 for what is no PNG.
std::pair<int, int> size_of_png(const std::string& bytes) {
  static const std::string signature = "\x89PNG\r\n\x1a\n";
  if (bytes.size() < 33 || bytes.compare(0, 8, signature) != 0 || bytes.compare(12, 4, "IHDR") != 0) return {0, 0};
  const auto number = [&](size_t at) {
    unsigned value = 0;
    for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value > 4096u ? 0 : static_cast<int>(value);
  };
  return {number(16), number(20)};
}

void add_pictures(const ReportData& data, size_t drawing, const std::filesystem::path& folder, size_t& room, ReportThumbnails& out) {
  for (const ModelPoint& point : points_of(data, drawing, data.main_metric)) {
    const ReportCell& cell = point.typical();
    std::ifstream file(thumbnail_file(folder, cell.key), std::ios::binary);
    if (!file) continue;
    std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    const auto [width, height] = size_of_png(bytes);
    if (width == 0 || height == 0) continue;
    if (bytes.size() > room) {
      ++out.left_out;
      continue;
    }
    room -= bytes.size();
    ReportThumbnail& picture = out.pictures.emplace_back();
    picture = {point.model, drawing, cell.view, std::abs(cell.values.at(data.main_metric)), width, height, {}};
    picture.png = std::move(bytes);
  }
}

}  // namespace

ReportThumbnails read_thumbnails(const ReportData& data, const std::filesystem::path& folder, size_t most_bytes) {
  ReportThumbnails out;
  if (data.drawings.empty()) return out;
  size_t room = most_bytes;
  add_pictures(data, data.main_drawing, folder, room, out);
  for (size_t drawing = 0; drawing < data.drawings.size(); ++drawing) {
    if (drawing != data.main_drawing) add_pictures(data, drawing, folder, room, out);
  }
  return out;
}

std::string thumbnails_html(const ReportData& data, const ReportThumbnails& thumbnails) {
  if (thumbnails.pictures.empty()) return "<p class=\"details\">No pictures of cells were kept.</p>\n";
  const ErrorWords error = error_words(data, data.main_metric);
  std::string html = "<p class=\"details\">Of each model the view whose error is the median of its views.";
  if (thumbnails.left_out > 0)
    html += fmt::format(" {} pictures are left out to keep the page small; they are in the folder cells.", thumbnails.left_out);
  html += "</p>\n<div class=\"cells\">\n";
  for (const ReportThumbnail& one : thumbnails.pictures) {
    const std::string title = data.title(one.model), drawn = data.drawings[one.drawing].title();
    const std::string numbers = fmt::format("{} off, view {}", error(one.error), one.view);
    html += fmt::format("<figure class=\"cell\" id=\"cell-{}-{}\" data-model=\"{}\" data-drawing=\"{}\">", one.model, one.drawing,
                        one.model, one.drawing);
    html +=
        fmt::format("<img width=\"{}\" height=\"{}\" loading=\"lazy\" alt=\"{}\" src=\"data:image/png;base64,{}\">", one.width, one.height,
                    escaped(fmt::format("{}, {}: wrong ink in red, missing ink in blue; {}", title, drawn, numbers)), base64(one.png));
    html += fmt::format("<figcaption><strong>{}</strong><br>{}<br>{}</figcaption></figure>\n", escaped(title), escaped(drawn),
                        escaped(numbers));
  }
  return html + "</div>\n";
}

}  // namespace limn
