#ifndef TRILOBE_CORE_FILES_CONTENT_H_
#define TRILOBE_CORE_FILES_CONTENT_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace trilobe {

inline constexpr std::string_view kTensorMagic("tensor_file\0", 12);
inline constexpr std::string_view kMbsdfMagic = "NVIDIA ARC MBSDF V1\n";
// Bytes of a UTIA table, which has no header: directions of incidence by directions of reflection,
// 6 elevations by 48 azimuths each, by colour.
inline constexpr size_t kUtiaSize = sizeof(double) * 288 * 288 * 3;

// What a file holds, as far as its beginning tells (256 bytes are enough for all but the texts with
// samples, whose headers may be longer) and, for UTIA tables, which have no header, its size.
struct Content {
  enum class Kind {
    kUnknown,
    kMerl,     // by the header alone
    kTensor,   // of RGL
    kMbsdf,    // of NVIDIA MDL
    kUtia,     // by the size alone
    kZemax,    // tabular BSDF
    kAstm,     // E1392-96
    kCornell,  // scattered spectra
    kCsv,      // samples with a header row
    kJson,     // an object, in UTF-8
    kText,     // any other
    kForeign   // nothing that this program reads, or a picture
  };
  Kind kind = Kind::kUnknown;
  std::string name;  // "a PNG picture"; for text in UTF-16, also what to do; "" if unknown
};
Content RecogniseContent(std::string_view bytes);

// The same for a file by its beginning alone; kUnknown where it is none that can be read.
Content RecogniseFile(const std::string& path);

// Throws Error "WHAT: this is a PNG picture" for content that is known, and is no JSON text.
void CheckMayBeJson(const Content& content, const std::string& what);

}  // namespace trilobe

#endif  // TRILOBE_CORE_FILES_CONTENT_H_
