#pragma once
// All of limn::sdf that is installed: fields, level sets, cameras, images, errors. The build installs the headers that are named here.

/// \namespace limn
/// All that limn declares. Lengths are in world units unless a name ends in `_px` or `_voxels`; angles are radians unless it ends in
/// `_deg`; transforms are named target_from_source; fields and level sets are negative inside. Functions throw InputError for what a caller
/// can cause and MachineError where the machine fails.

#include "sdf/answer.h"
#include "sdf/camera.h"
#include "sdf/color.h"
#include "sdf/descriptor.h"
#include "sdf/error.h"
#include "sdf/field.h"
#include "sdf/field_from_formula.h"
#include "sdf/field_from_functions.h"
#include "sdf/framed_surface.h"
#include "sdf/geometry.h"
#include "sdf/guard.h"
#include "sdf/image.h"
#include "sdf/large_pages.h"
#include "sdf/level_set.h"
#include "sdf/output_together.h"
#include "sdf/registry.h"
#include "sdf/shape.h"
#include "sdf/vm_field.h"
