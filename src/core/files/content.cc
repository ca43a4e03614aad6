#include "trilobe/core/files/content.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "core/base/text.h"
#include "core/files/text_lines.h"
#include "trilobe/core/base/error.h"

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
    {kMbsdfMagic, Kind::kMbsdf, "an MBSDF measurement"},
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

// Printable characters and white space in UTF-8, as far as the first 64 bytes tell. A binary table
// is not: it has zeros.
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

// Cuts the first line from a text, trimmed.
std::string_view TakeLine(std::string_view* text) {
  const size_t end = std::min(text->find('\n'), text->size());
  const std::string_view line = text->substr(0, end);
  text->remove_prefix(std::min(end + 1, text->size()));
  return Trimmed(line);
}

// The same for the first line that is neither blank nor a comment.
std::string_view TakeSignificantLine(std::string_view* text) {
  while (!text->empty()) {
    const std::string_view line = TakeLine(text);
    if (!line.empty() && line[0] != '#') return line;
  }
  return {};
}

bool HasCell(std::string_view line, std::string_view cell) {
  while (!line.empty()) {
    const size_t end = std::min(line.find(','), line.size());
    if (Trimmed(line.substr(0, end)) == cell) return true;
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return false;
}

// A header of keys, of which VARS is the last.
bool LooksLikeAstm(std::string_view text) {
  constexpr size_t kLongestHeader = 1 << 16;
  text = text.substr(0, kLongestHeader);
  while (!text.empty()) {
    const std::string_view line = TakeLine(&text);
    if (line.starts_with("VARS ") || line.starts_with("VARS\t")) return true;
  }
  return false;
}

// The first of the keys, with the only value that it has.
bool LooksLikeZemax(std::string_view text) {
  const std::string_view line = TakeSignificantLine(&text);
  constexpr std::string_view kKey = "Source", kValue = "Measured";
  return line.starts_with(kKey) && line.ends_with(kValue) &&
         Trimmed(line.substr(kKey.size())) == kValue;
}

// The number of wavelengths alone on its line, then the first of them [nm].
bool LooksLikeCornell(std::string_view text) {
  const auto number_at_begin = [](std::string_view line, bool alone) {
    double number = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
    return error == std::errc() && (!alone || end == line.data() + line.size()) ? number : 0;
  };
  const double count = number_at_begin(TakeSignificantLine(&text), true);
  const double first = number_at_begin(TakeSignificantLine(&text), false);
  return count >= 2 && count <= 10000 && first >= 200 && first <= 3000;
}

}  // namespace

Content RecogniseContent(std::string_view bytes) {
  const auto found = std::ranges::find_if(
      kSignatures, [&](const Signature& signature) { return bytes.starts_with(signature.begin); });
  if (found != std::end(kSignatures)) return {found->kind, found->name};
  if (bytes.empty()) return {};
  // Samples in a text are these even if something else follows the first line; their reader says
  // where.
  const std::string_view first_line = bytes.substr(0, bytes.find('\n'));
  const bool is_text = LooksLikeText(bytes);
  if (is_text || (!Trimmed(first_line).empty() && LooksLikeText(first_line))) {
    if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
    const size_t first = bytes.find_first_not_of(" \t\r\n");
    if (is_text && first != std::string_view::npos && bytes[first] == '{') {
      return {Kind::kJson, "a JSON file"};
    }
    std::string_view rest = bytes;
    if (HasCell(TakeSignificantLine(&rest), "theta_i")) return {Kind::kCsv, "samples in CSV"};
    if (LooksLikeZemax(bytes)) return {Kind::kZemax, "a Zemax BSDF"};
    if (LooksLikeAstm(bytes)) return {Kind::kAstm, "an ASTM E1392 measurement"};
    if (LooksLikeCornell(bytes)) return {Kind::kCornell, "spectra as Cornell measured them"};
    if (is_text) return {Kind::kText, "text"};
  }
  if (bytes.size() == kUtiaSize) {
    return {Kind::kUtia, "a UTIA measurement (288 x 288 x 3 doubles, by its size)"};
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

void CheckMayBeJson(const Content& content, const std::string& what) {
  if (content.kind != Content::Kind::kJson && content.kind != Content::Kind::kText &&
      content.kind != Content::Kind::kUnknown) {
    throw Error(what + ": this is " + content.name);
  }
}

}  // namespace trilobe
