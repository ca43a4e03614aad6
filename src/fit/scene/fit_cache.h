#ifndef TRILOBE_FIT_SCENE_FIT_CACHE_H_
#define TRILOBE_FIT_SCENE_FIT_CACHE_H_

#include <optional>
#include <string>
#include <string_view>

namespace trilobe {

// A folder of cached results, one file each, named by the hash of a key that contains everything
// that the result depends on. Files may be deleted at any time and several processes may share the
// folder: files are written under a temporary name and renamed, and begin with a hash and their
// key. Truncated, edited or swapped files are ignored.
class FitCache {
 public:
  // A cache that keeps nothing.
  FitCache() = default;
  // Creates the folder. Throws Error if that fails.
  explicit FitCache(const std::string& folder);

  // The content of a key, or nothing.
  std::optional<std::string> Find(std::string_view key) const;

  // Stores the content of a key. Failures, such as a full disk, are ignored.
  void Keep(std::string_view key, std::string_view content) const;

  // The path of a key's file, which need not exist.
  std::string PathOf(std::string_view key) const;

 private:
  std::string folder_;
};

// $XDG_CACHE_HOME/trilobe, or ~/.cache/trilobe; empty if neither is known.
std::string DefaultCacheFolder();

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_FIT_CACHE_H_
