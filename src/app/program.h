#ifndef TRILOBE_APP_PROGRAM_H_
#define TRILOBE_APP_PROGRAM_H_

#include <string>

namespace trilobe {

// "trilobe VERSION", as files name what wrote them.
std::string ProgramName();

// Which build of it this is: a hash of the bytes of the program, and of the shared library if it
// has one. Results are taken for one's own only if they are of the same build, since what was built
// of other sources may fit otherwise. Empty where these bytes cannot be read.
const std::string& ProgramBuild();

}  // namespace trilobe

#endif  // TRILOBE_APP_PROGRAM_H_
