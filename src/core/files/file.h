#ifndef TRILOBE_CORE_FILES_FILE_H_
#define TRILOBE_CORE_FILES_FILE_H_

#include <cstdio>
#include <functional>
#include <memory>
#include <ostream>
#include <string>

namespace trilobe {

// The bytes of a file. Throws Error: missing, a directory, unreadable, changed while read.
std::string ReadFile(const std::string& path);

// 16 hexadecimal digits that nobody else has, for names.
std::string RandomDigits();

// The ending of a file's name in lower case, as ".csv"; "" if it has none.
std::string EndingOf(const std::string& path);

// Writes a whole file or nothing: `write` fills a temporary file beside `path`, which is renamed
// over it once every byte is on it. On any failure (also of `write` itself) the temporary file is
// removed, an earlier file at `path` is left as it was, and Error says why ("No space left on
// device"). `before_renaming` is called when the new file is whole but the old one still there.
void WriteFile(
    const std::string& path, const std::function<void(std::ostream&)>& write,
    const std::function<void()>& before_renaming = [] {});

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using NamelessFile = std::unique_ptr<std::FILE, CloseFile>;

// A file to write and read in the folder where WriteFile would write `path`. It has no name, and is
// gone when it is closed, however the program ends. Throws Error.
NamelessFile MakeNamelessFile(const std::string& path);

// Throws the Error that WriteFile would throw for this path, as far as can be known before there is
// anything to write: makes and removes a temporary file, in the nearest folder that exists.
void CheckWritable(const std::string& path);

// Removes the temporary files that killed runs have left in a folder, and none that a running one
// still writes. What cannot be removed stays.
void SweepTemporaryFiles(const std::string& folder);

// Makes a directory and its parents where they are missing. Throws Error.
void MakeDirectories(const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_CORE_FILES_FILE_H_
