// A gradient, for the test of this folder: the central one under another name.

#include "sdf/gradients/gradients.h"

namespace limn {

GradientDescriptor central_gradient();

GradientDescriptor trial_gradient() {
  GradientDescriptor gradient = central_gradient();
  gradient.about = {.name = "trial", .help = "central differences, on trial", .source = "limn"};
  return gradient;
}

}  // namespace limn
