#pragma once
// The list of checks. A new one is a file in this folder and a line in registry.cpp.

#include "samples/stability/checks/check.h"

namespace limn {

StabilityCheck finite_outputs_check();
StabilityCheck finite_field_check();
StabilityCheck same_picture_check();
StabilityCheck no_holes_check();
StabilityCheck one_closed_component_check();
StabilityCheck faces_whole_check();
StabilityCheck continuous_check();
StabilityCheck border_within_check();
StabilityCheck normals_within_check();
StabilityCheck sign_right_check();
StabilityCheck width_within_check();
StabilityCheck even_cusps_check();
StabilityCheck no_false_lines_check();
StabilityCheck flicker_confined_check();
StabilityCheck flips_beyond_check();
StabilityCheck unchanged_beyond_check();
StabilityCheck ink_width_check();
StabilityCheck clean_seams_check();
StabilityCheck frame_free_check();
StabilityCheck same_width_check();
StabilityCheck samples_agree_check();
StabilityCheck mirror_picture_check();

}  // namespace limn
