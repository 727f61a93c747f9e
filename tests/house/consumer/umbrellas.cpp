// What is installed includes nothing that is not.
#include <raymarch/raymarch.h>
#include <samples/experiment/experiment.h>
#include <sdf/sdf.h>
#include <subdiv/subdiv.h>
