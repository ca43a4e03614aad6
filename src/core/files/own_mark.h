#ifndef TRILOBE_CORE_FILES_OWN_MARK_H_
#define TRILOBE_CORE_FILES_OWN_MARK_H_

#include <string>
#include <string_view>

// Marks by which the program knows again, from the content of a file, that it has written it.

namespace trilobe {

// Stands in a comment where a format has them.
inline constexpr std::string_view kOwnMark = "written by Trilobe";

// "format" of JSON files that are no models, nor reports.
inline constexpr const char* kPlanFormat = "trilobe-plan";
inline constexpr const char* kStudyFormat = "trilobe-study";

// A whole .png, .svg or .pdf picture with the mark of this program in it.
std::string MarkedPicture(std::string picture);

// Whether the content of a file says that this program wrote it. MERL's and UTIA's files have no
// room to say so.
bool SaysOwn(std::string_view bytes);

}  // namespace trilobe

#endif  // TRILOBE_CORE_FILES_OWN_MARK_H_
