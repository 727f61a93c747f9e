#pragma once
// Separable blurs of one plane, in two passes, and the change of size around them.

#include <functional>

#include "sdf/image.h"

namespace limn {

enum class BlurKernel { gaussian, box };

/// Weights of the taps -radius..radius, sum 1. Gaussian: standard deviation radius / 3, so that the cut ends lose 0.3 %.
std::vector<float> blur_taps(BlurKernel kernel, int radius_px);

/// Blurs along the lines, then along the columns, with OpenCV's filters; beyond the picture its border pixels repeat. In bands that stay
/// in the cache: `read(y, line)` fills a line of the source (some are asked for more than once), `write(y, line)` takes a blurred one;
/// both are called from many threads at a time.
void blur_lines(int width, int height, BlurKernel kernel, int radius_px, const std::function<void(int, float*)>& read,
                const std::function<void(int, const float*)>& write);
Image<float> blur_separable(const Image<float>& source, BlurKernel kernel, int radius_px);

/// Means of blocks of `scale` x `scale` pixels (of what there is of a block at the right and lower border).
Image<float> reduced(const Image<float>& source, int scale);
/// Back to `width` x `height`, bilinear between the block centres.
Image<float> enlarged(const Image<float>& source, int scale, int width, int height);

}  // namespace limn
