#include "io/formats/foreign_file.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "core/base/text.h"
#include "core/files/file.h"
#include "io/formats/text/table_columns.h"

namespace trilobe {
namespace {

using namespace std::string_view_literals;

// Number of leading bytes that are searched for a word of a known kind of file.
constexpr size_t kLookedAt = 1 << 16;

constexpr std::string_view kPickle = "a pickle of Python",
                           kFromPython = "in Python trilobe.Measurement takes its samples",
                           kScript = "a script, and not what it makes";

struct Foreign {
  // The first bytes, without white space before them, in lower case or as they are.
  std::string_view begin;
  std::string_view holds;   // a word further on; "": none
  std::string_view ending;  // of the file's name, instead of the word; "": none
  std::string_view name;
  std::string_view advice;  // "": to save it as CSV
};

// The first match counts.
constexpr std::array kForeign = {
    Foreign{"<!doctype html"sv, "", "", "a web page", "download the file itself"},
    Foreign{"<html"sv, "", "", "a web page", "download the file itself"},
    Foreign{"<?xml"sv, "<html", "", "a web page", "download the file itself"},
    Foreign{"version https://git-lfs"sv, "", "", "a Git LFS pointer in the place of a file",
            "get the file itself by `git lfs pull`"},
    Foreign{"pk\3\4"sv, "[content_types].xml", ".xlsx", "a workbook", ""},
    Foreign{"pk\3\4"sv, "opendocument.spreadsheet", ".ods", "a workbook", ""},
    Foreign{"pk\3\4"sv, "iwa", ".numbers", "a workbook", ""},
    Foreign{"pk\3\4"sv, ".npy", ".npz", "an archive of NumPy arrays",
            "in Python trilobe.Measurement takes their samples"},
    Foreign{"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"sv, "", "", "a workbook or a document of Office", ""},
    Foreign{"\x93numpy"sv, "", "", "a NumPy array",
            "in Python trilobe.Measurement takes its samples"},
    Foreign{"\x89hdf\r\n"sv, "com.xrite.materials", ".axf",
            "an AxF file, whose format is not public",
            "export the material as samples from the program that wrote it"},
    Foreign{"matlab "sv, "", "", "a MATLAB file", "write its samples by writematrix or writetable"},
    Foreign{"\x89hdf\r\n"sv, "", ".mat", "a MATLAB file", "write its samples by writetable"},
    Foreign{"\x89hdf\r\n"sv, "", "", "an HDF5 file", ""},
    Foreign{"sqlite format 3\0"sv, "", "", "a SQLite database", ""},
    Foreign{"par1\x15"sv, "", "", "a Parquet file", ""},
    Foreign{"iesna"sv, "", "", "an IES file of a luminaire, which is no material",
            "give the measurement of a material"},
    Foreign{"rar!\x1a\7"sv, "", "", "a RAR archive", "unpack it"},
    Foreign{"scatfun"sv, "", "", "a SCATFUN .bsdf file of Fourier coefficients",
            "evaluate it at pairs of directions, as layerlab does"},
    Foreign{"analytic"sv, "::begin", "",
            "a BRDF Explorer .brdf script, which is a formula and no measurement",
            "evaluate it at pairs of directions"},
    Foreign{"optis"sv, "", "", "an OPTIS/Speos text file, which is not read", ""},
    Foreign{"<?xml"sv, "", "", "an XML file, which is not read", ""},
    Foreign{"tracepro"sv, "", "", "a TracePro surface property, whose format is not public",
            "make its table (ScatterBeta, ScatterAzimuth, BRDF) one of theta_i, theta_o and phi_o: "
            "beta is the distance of the sines of the direction and of the mirror direction"},
    Foreign{""sv, "tracepro", "", "a TracePro file, whose format is not public", ""},
    Foreign{
        "[{"sv, "", "", "a list in JSON, which is not read",
        R"(make it an object of columns, as {"theta_i": [...], "brdf": [...]}, or save it as CSV)"},
    Foreign{
        "[["sv, "", "", "a list in JSON, which is not read",
        R"(make it an object of columns, as {"theta_i": [...], "brdf": [...]}, or save it as CSV)"},
    Foreign{"{"sv, "}\n{", ".jsonl", "a file of lines of JSON, which is not read", ""},
    Foreign{"{"sv, "", ".ndjson", "a file of lines of JSON, which is not read", ""},
    Foreign{"\x80\2"sv, "", "", kPickle, kFromPython},
    Foreign{"\x80\3"sv, "", "", kPickle, kFromPython},
    Foreign{"\x80\4"sv, "", "", kPickle, kFromPython},
    Foreign{"\x80\5"sv, "", "", kPickle, kFromPython},
    Foreign{""sv, "", ".pkl", kPickle, kFromPython},
    Foreign{""sv, "", ".pickle", kPickle, kFromPython},
    Foreign{"%yaml"sv, "", "", "a YAML file, which is not read", ""},
    Foreign{""sv, "", ".yaml", "a YAML file, which is not read", ""},
    Foreign{""sv, "", ".yml", "a YAML file, which is not read", ""},
    Foreign{""sv, "", ".toml", "a TOML file, which is not read", ""},
    Foreign{""sv, "", ".ldt", "an EULUMDAT file of a luminaire, which is no material",
            "give the measurement of a material"},
    Foreign{""sv, "", ".m", kScript, "run it, and save its samples as CSV"},
    Foreign{""sv, "", ".py", kScript, "run it, and save its samples as CSV"},
    Foreign{""sv, "", ".sql", "a script of SQL, which is not read", ""},
    Foreign{""sv, "", ".tex", "a LaTeX file, which is not read", ""},
    Foreign{R"({\rtf)"sv, "", "", "a document in RTF, which is not read", ""},
    Foreign{"<svg"sv, "", "", "an SVG picture", "give the numbers that it shows, as CSV"},
    Foreign{"# vtk datafile"sv, "", "", "a VTK file, which is not read", ""},
    Foreign{"simple  ="sv, "", "", "a FITS file, which is not read", ""},
    Foreign{"cgats"sv, "", "", "a table of a spectrophotometer (CGATS), which has no directions",
            "give a measurement at many pairs of directions"},
    Foreign{"mdl 1."sv, "", "", "an MDL module, which describes a material and is no measurement",
            "give the .mbsdf file that it names"},
    Foreign{"cdf\1"sv, "", "", "a NetCDF file", ""},
    Foreign{"cdf\2"sv, "", "", "a NetCDF file", ""},
    Foreign{"<"sv, "</", "", "a web page or other markup", "download the file itself"},
};

std::string Lower(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

// Without white space and comments as of C++ at its beginning.
std::string_view WithoutComments(std::string_view text) {
  for (;;) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    const std::string_view end = text.starts_with("//") ? "\n" : text.starts_with("/*") ? "*/" : "";
    const size_t at = end.empty() ? std::string_view::npos : text.find(end);
    if (at == std::string_view::npos) return text;
    text.remove_prefix(at + end.size());
  }
}

}  // namespace

std::string ForeignFile(std::string_view bytes, const std::string& name) {
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  const std::string lower = Lower(WithoutComments(bytes.substr(0, kLookedAt)));
  const std::string_view looked_at = lower;
  const std::string ending = EndingOf(name);
  const auto* const found = std::ranges::find_if(kForeign, [&](const Foreign& foreign) {
    if (!looked_at.starts_with(foreign.begin)) return false;
    if (foreign.holds.empty() && foreign.ending.empty()) return true;
    return (!foreign.ending.empty() && ending == foreign.ending) ||
           (!foreign.holds.empty() && looked_at.find(foreign.holds) != std::string_view::npos);
  });
  if (found == kForeign.end()) return "";
  std::string text(found->name);
  text += "; ";
  if (found->advice.empty()) return text + "save it as CSV, with the header " + kUsualColumns;
  return text.append(found->advice);
}

}  // namespace trilobe
