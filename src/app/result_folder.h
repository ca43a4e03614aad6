#ifndef TRILOBE_APP_RESULT_FOLDER_H_
#define TRILOBE_APP_RESULT_FOLDER_H_

#include <sys/types.h>

#include <functional>
#include <map>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/own_files.h"

namespace trilobe {

// Input files of a command, which it must not overwrite. `synth:` sources are ignored.
class Inputs {
 public:
  Inputs() = default;
  explicit Inputs(const std::vector<std::string>& paths);

  // Throws Error if `path` is an input, under any name or link, cannot be written, or may not be
  // replaced. Removes temporary files that killed runs have left beside it.
  using MayReplace = std::function<void(const std::string& path)>;
  void CheckOutput(const std::string& path, const MayReplace& may_replace = CheckMayReplace) const;
  // Throws Error if `path` is an input.
  void CheckNotRead(const std::string& path) const;

 private:
  std::map<std::pair<dev_t, ino_t>, std::string> name_of_;
};

// "model.previous.json" of "model.json".
std::string PreviousName(const std::string& name);

// Says on standard error that pictures of a folder are missing, and why: that the disk is full, if
// it is. Returns whether it is, which is a failure; a missing gnuplot is none.
bool TellMissingPictures(const std::string& why, const std::string& folder);

// A folder with the files of one run. When the first file of a new run is complete, all files of
// the earlier run are removed, so the files of two runs never mix, however the program ends. Other
// files are kept. Not thread-safe.
class ResultFolder {
 public:
  // `names`: all files that this or an earlier run may write; first its record, which a complete
  // run writes last. Does not create the folder. Throws Error if a file is an input, cannot be
  // written, or may not be replaced.
  ResultFolder(std::string path, std::vector<std::string> names, const Inputs& inputs);

  const std::string& path() const { return path_; }
  std::string PathOf(const std::string& name) const { return path_ + "/" + name; }
  // Unique identifier of this run: 16 hexadecimal digits.
  const std::string& run() const { return run_; }
  // Creates the folder and removes temporary files of killed runs. Throws Error if files cannot be
  // written into what was made.
  void Open() const;

  // Has the first Write rename this file of the earlier run to its PreviousName instead of removing
  // or replacing it. Throws Error if that cannot be done, or may not be.
  void KeepEarlier(const std::string& name);

  // Writes a file of this run without removing the earlier run; the first Write keeps it.
  void WriteAhead(const std::string& name, const std::function<void(std::ostream&)>& write);
  // Writes a file of this run. The first call removes the files of the earlier run; after it, other
  // code may write files of the run directly.
  void Write(const std::string& name, const std::function<void(std::ostream&)>& write);

  // To be called, after the first Write, when a file is complete whose format has no room to say
  // who wrote it, and before it has its name: keeps its checksum in the record, which says until
  // the run is complete that it is not.
  void KeepChecksum(const std::string& name, std::string_view content);
  // Checksums by name, for the record of the complete run.
  const std::map<std::string, std::string>& checksums() const { return checksums_; }

  // Those of the names that exist in the folder. After the first Write they are all of this run.
  std::vector<std::string> Files() const;

 private:
  void RemoveEarlierRun() const;

  std::string path_;
  std::vector<std::string> names_;
  std::string run_;
  bool begun_ = false;
  std::map<std::string, std::string> checksums_;
  std::vector<std::string> ahead_;  // written by WriteAhead
  std::vector<std::string> kept_;   // of the earlier run
};

}  // namespace trilobe

#endif  // TRILOBE_APP_RESULT_FOLDER_H_
