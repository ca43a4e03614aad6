#ifndef TRILOBE_APP_RESULT_FOLDER_H_
#define TRILOBE_APP_RESULT_FOLDER_H_

#include <sys/types.h>

#include <functional>
#include <map>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace trilobe {

// The files that a command reads, which it must not write. `synth:` sources are no files.
class Inputs {
 public:
  Inputs() = default;
  explicit Inputs(const std::vector<std::string>& paths);

  // Throws Error if `path` is one of them, under whatever name or link, or if no file can be
  // written there, as far as can be known now. Removes what killed runs have left beside it.
  void CheckOutput(const std::string& path) const;
  // The former alone.
  void CheckNotRead(const std::string& path) const;

 private:
  std::map<std::pair<dev_t, ino_t>, std::string> name_of_;
};

// A folder that holds one result: the files of one run. A run replaces those of an earlier one from
// the moment that its first file is whole, and not before: then all files of the earlier run go, so
// that files of two runs never lie side by side, however the program ends. Other files are left
// alone. Not for several threads at once.
class ResultFolder {
 public:
  // `names`: of all files that a run, this or an earlier one, may leave in the folder. Makes
  // nothing yet. The first is the one that a complete run writes last. Throws Error where one of
  // them is an input or cannot be written, and where a folder has some but none of `marks`, of
  // which every run leaves one: then they are somebody else's.
  ResultFolder(std::string path, std::vector<std::string> names,
               const std::vector<std::string>& marks, const Inputs& inputs);

  const std::string& path() const { return path_; }
  std::string PathOf(const std::string& name) const { return path_ + "/" + name; }
  // Distinguishes this run from all others: 16 hexadecimal digits.
  const std::string& run() const { return run_; }
  // Makes the folder, and removes what a killed run has left of its temporary files.
  void Open() const;

  // Writes a file of the run while all of the earlier one is still there; it stays when that goes.
  void WriteAhead(const std::string& name, const std::function<void(std::ostream&)>& write);
  // Writes a file of the run, the first time in the place of the earlier run. After that, others
  // may write theirs.
  void Write(const std::string& name, const std::function<void(std::ostream&)>& write);

  // Which of the names the folder has. Once the run has written a file, these are the run's.
  std::vector<std::string> Files() const;

 private:
  void RemoveEarlierRun() const;

  std::string path_;
  std::vector<std::string> names_;
  std::string run_;
  bool begun_ = false;
  std::vector<std::string> ahead_;  // the first files of the run
};

}  // namespace trilobe

#endif  // TRILOBE_APP_RESULT_FOLDER_H_
