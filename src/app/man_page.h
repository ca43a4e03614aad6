#ifndef TRILOBE_APP_MAN_PAGE_H_
#define TRILOBE_APP_MAN_PAGE_H_

#include <string>

namespace trilobe {

// The page trilobe(1) in roff, for man: what `trilobe help` says of the program and of each command
// with its common flags.
std::string ManPage();

}  // namespace trilobe

#endif  // TRILOBE_APP_MAN_PAGE_H_
