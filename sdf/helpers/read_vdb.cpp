// limn-read-vdb list FILE | grid FILE NAME | all FILE: reads a .vdb that nobody vouches for and sends it through the answer pipe
// (sdf/guard.h).
#include "sdf/read_vdb.h"

#include <cstdio>
#include <string_view>

#include "sdf/guard_helper.h"

int main(int count, char** arguments) {
  const std::string_view verb = count > 1 ? arguments[1] : "";
  if (verb == "list" && count == 3) return limn::run_helper([&] { return limn::vdb_list_answer(arguments[2]); });
  if (verb == "grid" && count == 4) return limn::run_helper([&] { return limn::vdb_grid_answer(arguments[2], arguments[3]); });
  if (verb == "all" && count == 3) return limn::run_helper([&] { return limn::vdb_all_answer(arguments[2]); });
  std::fputs("usage: limn-read-vdb list FILE | grid FILE NAME | all FILE (started by limn, answers on file descriptor 3)\n", stderr);
  return 2;
}
