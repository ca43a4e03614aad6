#include "fit/scene/fit_cache.h"

#include <cstdlib>
#include <ostream>

#include "core/files/file.h"
#include "core/system/content_hash.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// The first line of an entry: this, the hash of what follows, the size of the key, and a newline.
// What follows is the key, a newline, and the content.
constexpr std::string_view kMagic = "trilobe-cache 2 ";

std::string Entry(std::string_view key, std::string_view content) {
  const std::string rest = std::string(key) + "\n" + std::string(content);
  return std::string(kMagic) + ContentHash(rest) + " " + std::to_string(key.size()) + "\n" + rest;
}

}  // namespace

FitCache::FitCache(const std::string& folder) : folder_(folder) {
  MakeDirectories(folder);
  SweepTemporaryFiles(folder);
}

std::string FitCache::PathOf(std::string_view key) const {
  return folder_ + "/" + ContentHash(key) + ".cache";
}

std::optional<std::string> FitCache::Find(std::string_view key) const {
  if (folder_.empty()) return std::nullopt;
  try {
    const std::string entry = ReadFile(PathOf(key));
    const size_t begin = Entry(key, "").size();
    if (entry.size() < begin || entry != Entry(key, entry.substr(begin))) return std::nullopt;
    return entry.substr(begin);
  } catch (const Error&) {
    return std::nullopt;  // not there, or not to be read
  }
}

void FitCache::Keep(std::string_view key, std::string_view content) const {
  if (folder_.empty()) return;
  try {
    WriteFile(PathOf(key), [&](std::ostream& out) { out << Entry(key, content); });
  } catch (const Error&) {
    return;  // it will be made again
  }
}

std::string DefaultCacheFolder() {
  // The XDG Base Directory Specification has relative paths ignored.
  const char* const xdg = std::getenv("XDG_CACHE_HOME");
  if (xdg != nullptr && xdg[0] == '/') return std::string(xdg) + "/trilobe";
  const char* const home = std::getenv("HOME");
  return home != nullptr && home[0] == '/' ? std::string(home) + "/.cache/trilobe" : "";
}

}  // namespace trilobe
