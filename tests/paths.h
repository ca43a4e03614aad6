#ifndef TRILOBE_TESTS_PATHS_H_
#define TRILOBE_TESTS_PATHS_H_

#include <string>

namespace trilobe {

// Paths of this build. Only paths.cc is compiled with them, so that a compiler's cache can serve
// the tests of another checkout.

// NAME among the measured materials that may be there; without one, their folder.
std::string MeasuredData(const std::string& name = "");

// NAME in the repository that the tests were built from.
std::string InRepository(const std::string& name);

// The program under test; empty where it is not built.
std::string Program();

}  // namespace trilobe

#endif  // TRILOBE_TESTS_PATHS_H_
