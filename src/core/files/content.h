#ifndef TRILOBE_CORE_FILES_CONTENT_H_
#define TRILOBE_CORE_FILES_CONTENT_H_

#include <string>
#include <string_view>

namespace trilobe {

// The content of a file by its first bytes (64 suffice except for white space before JSON).
// Measurements are recognised by their formats instead.
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

// The first bytes of a file, or all if it is shorter; none if it cannot be read as a file.
std::string BeginningOf(const std::string& path, size_t size = 256);

}  // namespace trilobe

#endif  // TRILOBE_CORE_FILES_CONTENT_H_
