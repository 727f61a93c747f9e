// limn-read-vdb list FILE | grid FILE NAME | all FILE: reads a .vdb that nobody vouches for and puts it into the answer
// (sdf/guard.h).
#include "sdf/read_vdb.h"

#include <cstdio>
#include <string_view>

#include "sdf/guard_helper.h"

int main(int count, char** arguments) {
  const std::string_view verb = count > 1 ? arguments[1] : "";
  using limn::ByteWriter;
  if (verb == "list" && count == 3) return limn::run_helper([&](ByteWriter& answer) { limn::put_vdb_list(arguments[2], answer); });
  if (verb == "grid" && count == 4)
    return limn::run_helper([&](ByteWriter& answer) { limn::put_vdb_grid(arguments[2], arguments[3], answer); });
  if (verb == "all" && count == 3) return limn::run_helper([&](ByteWriter& answer) { limn::put_vdb_all(arguments[2], answer); });
  std::fputs("usage: limn-read-vdb list FILE | grid FILE NAME | all FILE (started by limn, answers on file descriptor 3)\n", stderr);
  return 2;
}
