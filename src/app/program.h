#ifndef TRILOBE_APP_PROGRAM_H_
#define TRILOBE_APP_PROGRAM_H_

#include <string>

namespace trilobe {

// "trilobe VERSION", as written into files.
std::string ProgramName();

// Identifies the build: a hash of the bytes of the program and of its shared library. Results of
// another build are not reused, because it may fit differently. Empty if the bytes cannot be read.
const std::string& ProgramBuild();

// The revision of the sources when the program was built, as `git describe` names it, "-dirty" if
// they were changed; "" where that is not known, as of an installed program. It is a file beside
// the program: no part of it, since results of the same build are reused.
std::string ProgramRevision();

}  // namespace trilobe

#endif  // TRILOBE_APP_PROGRAM_H_
