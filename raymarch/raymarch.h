#pragma once
// All of limn::raymarch that is installed: scenes, surfaces, G-buffers, border methods, truth, measured borders, metrics, pictures in
// files. The build installs the headers that are named here.

#include "raymarch/audit.h"
#include "raymarch/border.h"
#include "raymarch/border_curves.h"
#include "raymarch/frames.h"
#include "raymarch/gbuffer.h"
#include "raymarch/image_io.h"
#include "raymarch/image_output.h"
#include "raymarch/line_tracks.h"
#include "raymarch/lines.h"
#include "raymarch/local_model.h"
#include "raymarch/measured_border.h"
#include "raymarch/metric.h"
#include "raymarch/picture.h"
#include "raymarch/scene.h"
#include "raymarch/surface.h"
#include "raymarch/truth.h"
#include "subdiv/subdiv.h"
