#ifndef TRILOBE_IO_PAGE_DOCUMENT_H_
#define TRILOBE_IO_PAGE_DOCUMENT_H_

#include <string>
#include <string_view>

namespace trilobe {

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

}  // namespace trilobe

#endif  // TRILOBE_IO_PAGE_DOCUMENT_H_
