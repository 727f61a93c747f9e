#pragma once
// A formula whose bounds and Lipschitz constant say little of what it is near its surface, as a .vm file has it.

#include <fmt/format.h>

#include <string>

#include "sdf/vm_field.h"

namespace limn {

/// x^4 - a x^2 + y^4 - b y^2 + z^4 - c z^2 + d: at the corners of its bounds several times as steep as on the surface, and between powers
/// that nearly cancel out. With a = b = c = 5 and d = 10 a tangle of tubes within 2.3 of the origin.
inline Field quartic(double a, double b, double c, double d) {
  const std::string text = fmt::format(
      "x var-x\ny var-y\nz var-z\na const {}\nb const {}\nc const {}\nd const {}\n"
      "x2 square x\ny2 square y\nz2 square z\nx4 square x2\ny4 square y2\nz4 square z2\n"
      "ax mul a x2\nby mul b y2\ncz mul c z2\npx sub x4 ax\npy sub y4 by\npz sub z4 cz\n"
      "xy add px py\nxyz add xy pz\nout add xyz d\n",
      a, b, c, d);
  return vm_field(text, "quartic.vm").field;
}

}  // namespace limn
