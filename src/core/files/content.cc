#include "core/files/content.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "core/base/text.h"

namespace trilobe {
namespace {

using namespace std::string_view_literals;
using Kind = Content::Kind;

// Files that this program does not read.
struct Signature {
  std::string_view begin;
  const char* name;
};

constexpr const char* kJsonInUtf16 = "a JSON file in UTF-16; save it as UTF-8";

// The first match counts.
constexpr Signature kSignatures[] = {
    {"\xFF\xFE{\0"sv, kJsonInUtf16},
    {"\xFE\xFF\0{"sv, kJsonInUtf16},
    {"{\0\""sv, kJsonInUtf16},
    {"{\0\n"sv, kJsonInUtf16},
    {"{\0\r"sv, kJsonInUtf16},
    {"{\0 "sv, kJsonInUtf16},
    {"\0{\0"sv, kJsonInUtf16},
    {"\xFF\xFE"sv, "text in UTF-16; save it as UTF-8"},
    {"\xFE\xFF"sv, "text in UTF-16; save it as UTF-8"},
    {"\x89PNG\r\n"sv, "a PNG picture"},
    {"\xFF\xD8\xFF"sv, "a JPEG picture"},
    {"#?RADIANCE"sv, "a Radiance picture"},
    {"#?RGBE"sv, "a Radiance picture"},
    {"\x76\x2F\x31\x01"sv, "an OpenEXR picture"},
    {"II*\0"sv, "a TIFF picture"},
    {"MM\0*"sv, "a TIFF picture"},
    {"%PDF-"sv, "a PDF document"},
    {"\x89HDF\r\n"sv, "an HDF5 file"},
    {"MATLAB 5.0 "sv, "a MATLAB file"},
    {"\x93NUMPY"sv, "a NumPy array"},
    {"PK\x03\x04"sv, "a ZIP archive; unpack it"},
    {"\x1F\x8B"sv, "a gzip file; unpack it"},
    {"BZh"sv, "a bzip2 file; unpack it"},
    {"\xFD\x37zXZ\0"sv, "an xz file; unpack it"},
    {"7z\xBC\xAF\x27\x1C"sv, "a 7-Zip archive; unpack it"},
    {"\x28\xB5\x2F\xFD"sv, "a Zstandard file; unpack it"},
};

// Printable characters and white space in UTF-8 or Latin-1, as far as the first 64 bytes tell. A
// binary table is not: it has zeros.
bool LooksLikeText(std::string_view bytes) {
  for (std::string_view rest = bytes.substr(0, 64); !rest.empty();) {
    const char c = rest[0];
    const bool space = c == '\n' || c == '\r' || c == '\t';
    const size_t length = Utf8Length(rest);
    if (length == 0 && bytes.size() > 64 && rest.size() < 4) return true;  // cut by the 64
    const bool is_latin = length == 0 && static_cast<unsigned char>(c) >= 0xA0;
    const bool is_control = length == 1 && !space && (c < ' ' || c == '\x7F');
    if ((length == 0 && !is_latin) || is_control) return false;
    rest.remove_prefix(std::max(length, size_t{1}));
  }
  return true;
}

}  // namespace

Content RecogniseContent(std::string_view bytes) {
  const auto found = std::ranges::find_if(
      kSignatures, [&](const Signature& signature) { return bytes.starts_with(signature.begin); });
  if (found != std::end(kSignatures)) return {Kind::kForeign, found->name};
  if (bytes.empty()) return {};
  if (!LooksLikeText(bytes)) return {};
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  const size_t first = bytes.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && bytes[first] == '{') return {Kind::kJson, "a JSON file"};
  return {Kind::kText, "text"};
}

std::string BeginningOf(const std::string& path, size_t size) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return {};
  // O_NONBLOCK as in ReadFile: some files of the system are regular by name, and would be waited
  // for.
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return {};
  std::string begin(size, '\0');
  size_t done = 0;
  while (done < size) {
    const ssize_t count = read(fd, begin.data() + done, size - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<size_t>(count);
  }
  close(fd);
  begin.resize(done);
  return begin;
}

}  // namespace trilobe
