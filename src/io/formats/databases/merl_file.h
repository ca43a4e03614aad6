#ifndef TRILOBE_IO_FORMATS_DATABASES_MERL_FILE_H_
#define TRILOBE_IO_FORMATS_DATABASES_MERL_FILE_H_

#include <string>
#include <string_view>

#include "core/files/file.h"
#include "trilobe/model/measurement/brdf_table.h"

namespace trilobe {

// MERL `.binary` (docs/file-formats.md): 3 little-endian int32 (90, 90, 180), then float64 planes
// R, G, B. All throw Error for bad input: too short, trailing bytes, ... Writing what was read
// gives the same bytes, except that bins that do not count as measured are written as -1. What is
// read may have other numbers of bins, float32, big-endian numbers, or phi_d from 0 to 360 degrees,
// of which the means of exchanged directions are taken.
BrdfTable ParseMerl(std::string_view bytes, const std::string& source);
BrdfTable ReadMerl(const std::string& path);
// `before_renaming`: see WriteFile.
void WriteMerl(
    const BrdfTable& table, const std::string& path,
    const BeforeRenaming& before_renaming = [](std::string_view) {});

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_DATABASES_MERL_FILE_H_
