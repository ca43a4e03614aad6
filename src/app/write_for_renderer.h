#ifndef TRILOBE_APP_WRITE_FOR_RENDERER_H_
#define TRILOBE_APP_WRITE_FOR_RENDERER_H_

#include <string>
#include <vector>

namespace trilobe {

// The flags that are for files alone that WriteForRenderer writes; and an Error where one is given
// that is for others than `path`.
std::vector<std::string> RendererFlags();
void CheckRendererFlags(const std::string& path);

// Writes a model or a measurement to --out as a file that renderers read (trilobe/convert), by its
// ending, and says on standard output what it is and how far off. Throws Error.
void WriteForRenderer(const std::string& source);

}  // namespace trilobe

#endif  // TRILOBE_APP_WRITE_FOR_RENDERER_H_
