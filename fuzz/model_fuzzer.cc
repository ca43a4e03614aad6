// ParseModel on arbitrary text; what it accepts must survive being written and read again.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "trilobe/core/base/error.h"
#include "trilobe/io/model_files/model_file.h"

namespace {

bool Same(const trilobe::ModelFile& a, const trilobe::ModelFile& b) {
  const auto x = a.model.parameters(), y = b.model.parameters();
  return a.model.spec() == b.model.spec() && x.size() == y.size() &&
         std::memcmp(x.data(), y.data(), x.size_bytes()) == 0 && a.unobserved == b.unobserved;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  trilobe::ModelFile file;
  try {
    file = trilobe::ParseModel(text, "fuzz");
  } catch (const trilobe::Error&) {
    return 0;
  }
  const std::string formatted = trilobe::FormatModel(file);
  const trilobe::ModelFile again = trilobe::ParseModel(formatted, "fuzz");
  if (!Same(file, again) || trilobe::FormatModel(again) != formatted) std::abort();
  return 0;
}
