#ifndef TRILOBE_CORE_BASE_MARKUP_H_
#define TRILOBE_CORE_BASE_MARKUP_H_

#include <string>
#include <string_view>

namespace trilobe {

// A text as HTML and XML have it, between tags and in attributes.
std::string EscapedMarkup(std::string_view text);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_MARKUP_H_
