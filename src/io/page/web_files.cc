#include "io/page/web_files.h"

#include <string>

#include "trilobe/core/base/error.h"

namespace trilobe {

std::string_view WebText(std::string_view name) {
  for (const EmbeddedFile& file : WebFiles()) {
    if (file.name == name) return file.text;
  }
  throw Error("the program was built without web/" + std::string(name));
}

}  // namespace trilobe
