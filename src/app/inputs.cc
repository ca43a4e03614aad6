#include "trilobe/app/inputs.h"

#include <fstream>

#include "trilobe/app/flags.h"
#include "trilobe/base/error.h"

namespace trilobe {

bool LooksLikeModel(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  char first = 0;
  return (file >> std::ws >> first) && first == '{';
}

std::string RequiredOut(const std::string& command, const std::string& what) {
  if (FLAGS_out.empty()) {
    throw Error("trilobe " + command + " needs --out=" + what + ", to know where to write");
  }
  return FLAGS_out;
}

}  // namespace trilobe
