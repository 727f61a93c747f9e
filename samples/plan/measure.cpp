#include <algorithm>
#include <chrono>
#include <cmath>

#include "raymarch/measured_border.h"
#include "samples/plan/plan.h"

namespace limn {
