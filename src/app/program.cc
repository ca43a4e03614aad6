#include "app/program.h"

#include <dlfcn.h>
#include <gflags/gflags.h>

#include <filesystem>
#include <system_error>

#include "core/files/file.h"
#include "core/system/content_hash.h"
#include "fit/scene/fit_cache.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

std::string FileBytes(const char* path) {
  try {
    return ReadFile(path);
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

std::string ProgramName() { return std::string("trilobe ").append(gflags::VersionString()); }

const std::string& ProgramBuild() {
  static const std::string build = [] {
    std::string bytes = FileBytes("/proc/self/exe");
    // If the library is part of the program, both are one file.
    Dl_info program{}, library{};
    if (dladdr(reinterpret_cast<void*>(&ProgramName), &program) != 0 &&
        dladdr(reinterpret_cast<void*>(&ContentHash), &library) != 0 &&
        program.dli_fbase != library.dli_fbase) {
      bytes += FileBytes(library.dli_fname);
    }
    return bytes.empty() ? bytes : ContentHash(bytes);
  }();
  return build;
}

std::string ProgramRevision() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return "";
  const std::string text = FileBytes((program.string() + ".revision").c_str());
  return text.substr(0, text.find('\n'));
}

}  // namespace trilobe
