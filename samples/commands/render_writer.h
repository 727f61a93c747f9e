#pragma once
// The pictures of `limn render` on their way to files.

#include <deque>
#include <future>

#include "samples/commands/render_call.h"

namespace limn {

/// Pictures are written while the next one is traced, if there is a second thread.
class PictureWriter {
 public:
  PictureWriter(const Options& options, Render& render) : options_(options), render_(render) {}
  ~PictureWriter();
  PictureWriter(const PictureWriter&) = delete;
  PictureWriter& operator=(const PictureWriter&) = delete;

  /// Adds the names of its files to the report.
  void write(Picture picture, int index);
  /// Waits for all of them. Throws what writing threw.
  void finish() { wait_for(0); }

 private:
  /// Until so many are under way, the oldest first.
  void wait_for(size_t most);

  const Options& options_;
  Render& render_;
  std::deque<std::future<double>> under_way_{};
};

/// Whether pictures are made as bytes.
inline bool in_bytes(const Render& render) { return render.picture.colors == PictureColors::bytes; }
/// All frames as one picture, where an output plays them.
void write_animation(const Options& options, Render& render);

}  // namespace limn
