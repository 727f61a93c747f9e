#include "samples/commands/render_writer.h"

#include <algorithm>
#include <memory>

#include "raymarch/files/animated_png.h"
#include "raymarch/image_output.h"
#include "samples/commands/render_outputs.h"
#include "samples/experiment/thread_settings.h"
#include "samples/output/interrupt.h"
#include "sdf/output_file.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

bool plays(const Render& render, const Options& options) {
  return std::any_of(render.outputs.begin(), render.outputs.end(), [&](const fs::path& file) { return is_animated(file, options); });
}

Image<glm::vec4> over_ground(const Image<glm::vec4>& picture, const glm::vec3& ground) {
  auto over = Image<glm::vec4>::unset(picture.width, picture.height);
  parallel_parts(picture.size(), size_t{1} << 14, [&](const IndexRange<size_t>& part) {
    for (size_t i = part.first; i < part.last; ++i) {
      const glm::vec4& pixel = picture.pixels[i];
      over.pixels[i] = pixel + (1.0f - pixel.a) * glm::vec4(ground, 1.0f);
    }
  });
  return over;
}

/// Writes it; the time that took, ms. Of `render` only the frames of an animation change.
double write_picture(const Picture& picture, const Camera& camera, int index, const Options& options, Render& render) {
  const auto start = std::chrono::steady_clock::now();
  const std::string call = resolved_call("render", options.spec, resolved_model(render), camera, render.picture);
  // Layers keep their alpha; a picture to be looked at has a ground.
  const bool grounded = !options.transparent && !options.ink_only && !render.picture.background;
  const Image<glm::vec4> over = grounded ? over_ground(picture.composite, render.ground) : Image<glm::vec4>();
  std::vector<OutputFile> files;
  for (const fs::path& name : render.outputs) {
    if (is_animated(name, options)) continue;
    const fs::path file = picture_file(name, index, options);
    OutputFile output = ending_of(file) == ".exr" ? exr_output(picture, camera, call, file)
                        : in_bytes(render)        ? image_output(picture.bytes, file)
                                                  : image_output(grounded ? over : picture.composite, file);
    files.push_back({file, [write = std::move(output.write)](const fs::path& temporary) {
                       if (interrupted()) throw Cancelled{};
                       write(temporary);
                     }});
  }
  if (plays(render, options))
    render.frames.push_back(in_bytes(render) ? encode_png(picture.bytes) : encode_png(grounded ? over : picture.composite));
  // A layer file and the picture beside it show the same, or are both those of an earlier call.
  write_together(files);
  return elapsed_ms(start);
}

}  // namespace

PictureWriter::~PictureWriter() {
  for (const std::future<double>& one : under_way_) one.wait();
}

void PictureWriter::write(Picture picture, int index) {
  // Of bytes, which are small, a second one: tracing and writing take about as long, and neither should wait for the other's longest.
  // Films keep their frames in order.
  wait_for(in_bytes(render_) && !plays(render_, options_) ? 1 : 0);
  for (const fs::path& name : render_.outputs)
    if (!is_animated(name, options_)) render_.files.push_back(picture_file(name, index, options_).string());
  if (pictures_of(options_) == 1) {
    render_.timings.write_ms += write_picture(picture, render_.camera, index, options_, render_);
    return;
  }
  under_way_.push_back(run_beside([this, kept = std::make_shared<const Picture>(std::move(picture)), camera = render_.camera, index] {
    return write_picture(*kept, camera, index, options_, render_);
  }));
}

void PictureWriter::wait_for(size_t most) {
  while (under_way_.size() > most) {
    std::future<double> oldest = std::move(under_way_.front());
    under_way_.pop_front();
    render_.timings.write_ms += oldest.get();
  }
}

void write_animation(const Options& options, Render& render) {
  if (!plays(render, options)) return;
  const auto start = std::chrono::steady_clock::now();
  const std::vector<std::byte> bytes = animated_png(render.frames, options.lines.frames_per_second);
  for (const fs::path& file : render.outputs) {
    if (!is_animated(file, options)) continue;
    write_whole(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    render.files.push_back(file.string());
  }
  render.timings.write_ms += elapsed_ms(start);
}

}  // namespace limn
