#include "trilobe/app/inputs.h"

#include <fstream>

#include "trilobe/app/flags.h"
#include "trilobe/base/error.h"
#include "trilobe/io/content.h"

namespace trilobe {

bool IsModelFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string begin(256, ' ');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<size_t>(file.gcount()));
  return RecogniseContent(begin).kind == Content::Kind::kJson;
}

std::string RequiredOut(const std::string& command, const std::string& what) {
  if (FLAGS_out.empty()) {
    throw Error("trilobe " + command + " needs --out=" + what + ", to know where to write");
  }
  return FLAGS_out;
}

}  // namespace trilobe
