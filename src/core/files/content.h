#ifndef TRILOBE_CORE_FILES_CONTENT_H_
#define TRILOBE_CORE_FILES_CONTENT_H_

#include <string>
#include <string_view>

namespace trilobe {

// What a file holds, as far as its first bytes tell (64 are enough but for white space before
// JSON). Measurements are for their formats to recognise.
struct Content {
  enum class Kind {
    kUnknown,
    kJson,    // an object, in UTF-8
    kText,    // any other
    kForeign  // nothing that this program reads, or a picture
  };
  Kind kind = Kind::kUnknown;
  std::string name;  // "a PNG picture"; for text in UTF-16, also what to do; "" if unknown
};
Content RecogniseContent(std::string_view bytes);

// The first 256 bytes of a file, or all that it has; none where it is no file that can be read.
std::string BeginningOf(const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_CORE_FILES_CONTENT_H_
