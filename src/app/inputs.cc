#include "trilobe/app/inputs.h"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "trilobe/app/flags.h"
#include "trilobe/base/error.h"
#include "trilobe/io/content.h"
#include "trilobe/io/file.h"

namespace trilobe {

bool IsModelFile(const std::string& path) {
  return RecogniseFile(path).kind == Content::Kind::kJson;
}

std::string RequiredOut(const std::string& command, const std::string& what) {
  if (FLAGS_out.empty()) {
    throw Error("trilobe " + command + " needs --out=" + what + ", to know where to write");
  }
  return FLAGS_out;
}

std::string RequiredMeasurementOut(const std::string& command) {
  // Of formats that other programs would take the file for.
  constexpr std::string_view kOthers[] = {
      ".bsdf", ".json", ".txt", ".png", ".jpg", ".jpeg", ".hdr", ".pic", ".exr",
      ".tif",  ".tiff", ".pdf", ".svg", ".npy", ".npz",  ".mat", ".h5",  ".xml",
      ".zip",  ".gz",   ".tgz", ".xz",  ".bz2", ".zst",  ".7z",  ".tar"};
  std::string out = RequiredOut(command, "FILE");
  const std::string ending = EndingOf(out);
  if (std::ranges::find(kOthers, ending) != std::end(kOthers)) {
    throw Error("--out=" + out + ": trilobe " + command + " writes MERL data, and the ending '" +
                ending +
                "' says another format; end the name in .binary, in .bin for UTIA's directions, or "
                "in .csv");
  }
  return out;
}

}  // namespace trilobe
