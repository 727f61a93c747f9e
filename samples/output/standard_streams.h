#pragma once

namespace limn {

/// Makes the standard streams safe to write to, whatever the caller did to them. Of those that are closed each is opened on nothing, so
/// that no output file gets its number and the program's text in it; writing to it then fails as on a closed one. A reader that went away
/// and a file that grew beyond its limit become errors of the call instead of signals.
void keep_standard_streams();

}  // namespace limn
