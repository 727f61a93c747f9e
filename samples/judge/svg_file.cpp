#include "samples/judge/svg_file.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>

#include "sdf/error.h"
#include "sdf/guard.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExpected = "an SVG file";
constexpr std::uint64_t kMostLines = 5'000'000, kMostNotes = 64;

/// In proportion to the file: what takes more than this is no honest drawing of that size.
GuardLimits limits_for(const fs::path& file) {
  const auto bytes = static_cast<std::int64_t>(fs::file_size(file));
  GuardLimits limits;
  limits.memory_bytes = std::clamp<std::int64_t>((std::int64_t{1} << 30) + 64 * bytes, 0, std::int64_t{64} << 30);
  limits.answer_bytes = std::int64_t{1} << 30;
  limits.time = std::chrono::seconds(20 + bytes / 4'000'000);
  return limits;
}

/// Control characters become question marks, because terminals act on them.
std::string get_plain_text(ByteReader& answer) {
  std::string text = answer.get_text();
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }, '?');
  return text;
}

[[noreturn]] void refuse_answer(const fs::path& file) {
  throw InputError({file.string(), {}, {}, "the reader's answer makes no sense; the file is damaged", "an undamaged SVG"});
}

SvgLine get_line(ByteReader& answer, const fs::path& file) {
  SvgLine line;
  line.id = get_plain_text(answer);
  line.color = get_plain_text(answer);
  line.width_px = answer.get<double>();
  line.opacity = answer.get<double>();
  line.closed = answer.get<std::uint8_t>() != 0;
  const auto numbers = answer.get_vector<double>();
  if (numbers.size() < 4 || numbers.size() % 2 != 0) refuse_answer(file);
  if (!std::isfinite(line.width_px) || line.width_px < 0.0 || !std::isfinite(line.opacity)) refuse_answer(file);
  line.points.reserve(numbers.size() / 2);
  for (size_t i = 0; i < numbers.size(); i += 2) {
    if (!std::isfinite(numbers[i]) || !std::isfinite(numbers[i + 1])) refuse_answer(file);
    line.points.emplace_back(numbers[i], numbers[i + 1]);
  }
  return line;
}

}  // namespace

SvgFile read_svg_file(const fs::path& file) {
  check_readable(file, kExpected);
  const std::string arguments[] = {fs::absolute(file).string()};
  return svg_from_answer(run_guarded("limn-read-svg", arguments, file, limits_for(file)), file);
}

void put_svg(ByteWriter& answer, const SvgFile& svg) {
  answer.put(svg.width_px);
  answer.put(svg.height_px);
  answer.put(static_cast<std::uint64_t>(svg.left_out.size()));
  for (const std::string& what : svg.left_out) answer.put_text(what);
  answer.put(static_cast<std::uint64_t>(svg.lines.size()));
  for (const SvgLine& line : svg.lines) {
    answer.put_text(line.id);
    answer.put_text(line.color);
    answer.put(line.width_px);
    answer.put(line.opacity);
    answer.put(static_cast<std::uint8_t>(line.closed));
    std::vector<double> numbers;
    numbers.reserve(2 * line.points.size());
    for (const glm::dvec2& p : line.points) numbers.insert(numbers.end(), {p.x, p.y});
    answer.put_span(std::span<const double>(numbers));
  }
}

SvgFile svg_from_answer(std::span<const std::byte> bytes, const fs::path& file) {
  ByteReader answer(bytes, file.string());
  SvgFile svg;
  svg.width_px = answer.get<double>();
  svg.height_px = answer.get<double>();
  if (!std::isfinite(svg.width_px) || !std::isfinite(svg.height_px) || svg.width_px <= 0.0 || svg.height_px <= 0.0) refuse_answer(file);
  const auto notes = answer.get<std::uint64_t>();
  if (notes > kMostNotes) refuse_answer(file);
  for (std::uint64_t i = 0; i < notes; ++i) svg.left_out.push_back(get_plain_text(answer));
  const auto count = answer.get<std::uint64_t>();
  if (count > kMostLines) refuse_answer(file);
  for (std::uint64_t i = 0; i < count; ++i) svg.lines.push_back(get_line(answer, file));
  if (!answer.done()) refuse_answer(file);
  return svg;
}

}  // namespace limn
