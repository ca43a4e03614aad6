#include "trilobe/io/content.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "trilobe/io/utf8.h"

namespace trilobe {
namespace {

using namespace std::string_view_literals;
using Kind = Content::Kind;

struct Signature {
  std::string_view begin;
  Kind kind;
  const char* name;
};

constexpr const char* kJsonInUtf16 = "a JSON file in UTF-16; save it as UTF-8";

// The first that fits counts.
constexpr Signature kSignatures[] = {
    {"\x5A\0\0\0\x5A\0\0\0\xB4\0\0\0"sv, Kind::kMerl, "a MERL measurement"},
    {kTensorMagic, Kind::kTensor, "an RGL measurement"},
    {"\xFF\xFE{\0"sv, Kind::kForeign, kJsonInUtf16},
    {"\xFE\xFF\0{"sv, Kind::kForeign, kJsonInUtf16},
    {"{\0\""sv, Kind::kForeign, kJsonInUtf16},
    {"{\0\n"sv, Kind::kForeign, kJsonInUtf16},
    {"{\0\r"sv, Kind::kForeign, kJsonInUtf16},
    {"{\0 "sv, Kind::kForeign, kJsonInUtf16},
    {"\0{\0"sv, Kind::kForeign, kJsonInUtf16},
    {"\xFF\xFE"sv, Kind::kForeign, "text in UTF-16; save it as UTF-8"},
    {"\xFE\xFF"sv, Kind::kForeign, "text in UTF-16; save it as UTF-8"},
    {"\x89PNG\r\n"sv, Kind::kForeign, "a PNG picture"},
    {"\xFF\xD8\xFF"sv, Kind::kForeign, "a JPEG picture"},
    {"#?RADIANCE"sv, Kind::kForeign, "a Radiance picture"},
    {"#?RGBE"sv, Kind::kForeign, "a Radiance picture"},
    {"\x76\x2F\x31\x01"sv, Kind::kForeign, "an OpenEXR picture"},
    {"II*\0"sv, Kind::kForeign, "a TIFF picture"},
    {"MM\0*"sv, Kind::kForeign, "a TIFF picture"},
    {"%PDF-"sv, Kind::kForeign, "a PDF document"},
    {"\x89HDF\r\n"sv, Kind::kForeign, "an HDF5 file"},
    {"MATLAB 5.0 "sv, Kind::kForeign, "a MATLAB file"},
    {"\x93NUMPY"sv, Kind::kForeign, "a NumPy array"},
    {"PK\x03\x04"sv, Kind::kForeign, "a ZIP archive; unpack it"},
    {"\x1F\x8B"sv, Kind::kForeign, "a gzip file; unpack it"},
    {"BZh"sv, Kind::kForeign, "a bzip2 file; unpack it"},
    {"\xFD\x37zXZ\0"sv, Kind::kForeign, "an xz file; unpack it"},
    {"7z\xBC\xAF\x27\x1C"sv, Kind::kForeign, "a 7-Zip archive; unpack it"},
    {"\x28\xB5\x2F\xFD"sv, Kind::kForeign, "a Zstandard file; unpack it"},
};

// Directions of incidence by directions of reflection, 6 elevations by 48 azimuths each, by colour.
constexpr size_t kUtiaSize = sizeof(double) * 288 * 288 * 3;

// Printable characters and white space in UTF-8. A binary table is not: it has zeros.
bool LooksLikeText(std::string_view bytes) {
  for (std::string_view rest = bytes.substr(0, 64); !rest.empty();) {
    const char c = rest[0];
    const bool space = c == '\n' || c == '\r' || c == '\t';
    const size_t length = Utf8Length(rest);
    if (length == 0 && bytes.size() > 64 && rest.size() < 4) return true;  // cut by the 64
    if (length == 0 || (length == 1 && !space && (c < ' ' || c == '\x7F'))) return false;
    rest.remove_prefix(length);
  }
  return true;
}

}  // namespace

Content RecogniseContent(std::string_view bytes) {
  const auto found = std::ranges::find_if(
      kSignatures, [&](const Signature& signature) { return bytes.starts_with(signature.begin); });
  if (found != std::end(kSignatures)) return {found->kind, found->name};
  if (bytes.empty()) return {};
  if (LooksLikeText(bytes)) {
    if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
    const size_t first = bytes.find_first_not_of(" \t\r\n");
    if (first != std::string_view::npos && bytes[first] == '{') return {Kind::kJson, "a JSON file"};
    return {Kind::kText, "text"};
  }
  if (bytes.size() == kUtiaSize) {
    return {Kind::kForeign,
            "a UTIA table (288 x 288 x 3 doubles, by its size), which cannot be read yet"};
  }
  return {};
}

Content RecogniseFile(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return {};  // a pipe would be waited for
  std::ifstream file(path, std::ios::binary);
  std::array<char, 256> begin{};
  file.read(begin.data(), begin.size());
  return RecogniseContent({begin.data(), static_cast<size_t>(file.gcount())});
}

}  // namespace trilobe
