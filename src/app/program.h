#ifndef TRILOBE_APP_PROGRAM_H_
#define TRILOBE_APP_PROGRAM_H_

#include <string>

namespace trilobe {

// "trilobe VERSION", as written into files.
std::string ProgramName();

// Identifies the build: a hash of the bytes of the program and of its shared library. Results of
// another build are not reused, because it may fit differently. Empty if the bytes cannot be read.
const std::string& ProgramBuild();

}  // namespace trilobe

#endif  // TRILOBE_APP_PROGRAM_H_
