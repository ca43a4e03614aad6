#ifndef TRILOBE_IO_PAGE_DOCUMENT_H_
#define TRILOBE_IO_PAGE_DOCUMENT_H_

#include <string>
#include <string_view>

namespace trilobe {

// The text of web/NAME. Throws Error where there is none of this name.
std::string_view WebText(std::string_view name);

// web/NAME with the files that it names put into their places, as one file, and JSON for its
// scripts:
//   <!-- title -->         the title
//   <!-- style: a.css -->  a style sheet
//   <!-- body -->          the markup
//   <!-- data -->          the JSON, as a script element of the id "data"
//   <!-- shaders -->       all of web/*.glsl, as JSON, of the id "shaders"
//   <!-- module: a.js -->  a module and, before it, all that it imports, as one script: each name
//                          that stands outside of functions is there once in all of them
// Throws Error where a file is missing.
std::string FormatDocument(std::string_view name, std::string_view title, std::string_view json,
                           std::string_view body = "");

// RFC 4648, with padding; with a line break after each `line` characters, a multiple of 4, if that
// is not 0.
std::string Base64(std::string_view bytes, int line = 0);

}  // namespace trilobe

#endif  // TRILOBE_IO_PAGE_DOCUMENT_H_
