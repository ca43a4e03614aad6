#ifndef TRILOBE_IO_PICTURES_DOCUMENT_H_
#define TRILOBE_IO_PICTURES_DOCUMENT_H_

#include <string>
#include <string_view>

namespace trilobe {

// The text of web/NAME. Throws Error for an unknown name.
std::string_view WebText(std::string_view name);

// web/NAME as one file, with JSON for its scripts, in which these comments are replaced:
//   <!-- title -->         the title
//   <!-- policy: IMAGES --> a Content-Security-Policy that lets the page load IMAGES (sources of
//                          img-src) and nothing else, and run what stands in it alone
//   <!-- style: a.css -->  a style sheet
//   <!-- body -->          the markup
//   <!-- data -->          the JSON, as a script element of the id "data"
//   <!-- shaders -->       all of web/*.glsl, as JSON, of the id "shaders"
//   <!-- module: a.js -->  a module after all that it imports, as one script; their top-level names
//                          must be unique
// Throws Error if a file is missing.
std::string FormatDocument(std::string_view name, std::string_view title, std::string_view json,
                           std::string_view body = "");

// RFC 4648, with padding, and a line break after each `line` characters (a multiple of 4; 0: none).
std::string Base64(std::string_view bytes, int line = 0);

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_DOCUMENT_H_
