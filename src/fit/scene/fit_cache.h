#ifndef TRILOBE_FIT_SCENE_FIT_CACHE_H_
#define TRILOBE_FIT_SCENE_FIT_CACHE_H_

#include <optional>
#include <string>
#include <string_view>

namespace trilobe {

// A folder of results that can be had again at the cost of time: a file each, named by the hash of
// a key, which is to say everything that the result depends on. Any of the files, or all, may be
// deleted at any time. Each is written under a temporary name and then renamed, holds its key, and
// begins with a hash, so several processes can share the folder, and a file that is torn, cut off,
// edited, or put in the place of another counts as none.
class FitCache {
 public:
  // A cache that keeps nothing.
  FitCache() = default;
  // Makes the folder. Throws Error if that fails.
  explicit FitCache(const std::string& folder);

  // Nothing unless this very content was kept under this key.
  std::optional<std::string> Find(std::string_view key) const;

  // Where this fails, as on a full disk, the content is not kept, and that is all.
  void Keep(std::string_view key, std::string_view content) const;

  // The file of a key, whether there is one or not.
  std::string PathOf(std::string_view key) const;

 private:
  std::string folder_;
};

// $XDG_CACHE_HOME/trilobe, or ~/.cache/trilobe; empty where neither is known.
std::string DefaultCacheFolder();

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_FIT_CACHE_H_
