#ifndef TRILOBE_CORE_FILES_FILE_H_
#define TRILOBE_CORE_FILES_FILE_H_

#include <cstdio>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>

namespace trilobe {

// Returns the bytes of a file. Throws Error if it is missing, a directory, unreadable, or changes
// while it is read.
std::string ReadFile(const std::string& path);

// 16 random hexadecimal digits, for unique names.
std::string RandomDigits();

// The extension of a file name in lower case, such as ".csv"; "" if it has none.
std::string EndingOf(const std::string& path);

// Writes a file atomically: `write` fills a temporary file beside `path`, which replaces `path`
// when complete. On any failure, including an exception from `write`, the temporary file is
// removed, an existing file at `path` is unchanged, and Error gives the reason ("No space left on
// device"). `before_renaming` is called with the content when the new file is complete and before
// the old one is replaced.
using BeforeRenaming = std::function<void(std::string_view content)>;
void WriteFile(
    const std::string& path, const std::function<void(std::ostream&)>& write,
    const BeforeRenaming& before_renaming = [](std::string_view) {});

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using NamelessFile = std::unique_ptr<std::FILE, CloseFile>;

// A file to write and read in the folder where WriteFile would write `path`. It has no name, and is
// gone when it is closed, however the program ends. Throws Error.
NamelessFile MakeNamelessFile(const std::string& path);

// Throws the Error that WriteFile would throw for this path, as far as it can be known in advance,
// or one if the file could not be opened again (umask 0777).
// It creates and removes a temporary file in the nearest existing parent folder.
void CheckWritable(const std::string& path);

// Removes temporary files left in a folder by killed runs, but not those of running ones. Ignores
// files that it cannot remove.
void SweepTemporaryFiles(const std::string& folder);

// Creates a directory and its missing parents. Throws Error on failure.
void MakeDirectories(const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_CORE_FILES_FILE_H_
