#ifndef TRILOBE_APP_FIT_NAME_H_
#define TRILOBE_APP_FIT_NAME_H_

#include <string>

namespace trilobe {

// What stands beside the folders of several fits.
inline constexpr const char* kTableName = "fits.csv";
inline constexpr const char* kPageName = "index.html";

// What a measurement's folder is called: synth:NAME's or a file's name, without its ending unless
// only with it that can be a folder beside the others.
std::string FitNameOf(const std::string& source);

}  // namespace trilobe

#endif  // TRILOBE_APP_FIT_NAME_H_
