#pragma once
// All of limn::subdiv that is installed: meshes, their files, subdivision, tessellated fields, meshes turned into level sets. The build
// installs the headers that are named here.

#include "sdf/sdf.h"
#include "subdiv/import.h"
#include "subdiv/mesh.h"
#include "subdiv/mesh_audit.h"
#include "subdiv/mesh_level_set.h"
#include "subdiv/refine.h"
#include "subdiv/tessellate.h"
