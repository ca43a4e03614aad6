#include "tests/paths.h"

#include <string>

namespace trilobe {

std::string MeasuredData(const std::string& name) {
  return TRILOBE_TEST_DATA_DIR + (name.empty() ? "" : "/" + name);
}

std::string InRepository(const std::string& name) { return TRILOBE_SOURCE_DIR "/" + name; }

std::string Program() { return TRILOBE_PROGRAM; }

}  // namespace trilobe
