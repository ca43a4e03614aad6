#ifndef TRILOBE_APP_STATUS_H_
#define TRILOBE_APP_STATUS_H_

#include <memory>
#include <optional>
#include <string>

namespace trilobe {

// One line on standard error that says what the program is doing, and for how long. On a terminal
// it is drawn over and over, each half second, cut to its width. In a file or a pipe, with
// TERM=dumb or NO_COLOR, there is one line for each stage that takes more than two seconds, and one
// more each minute. --quiet prints none of this. For the whole process, from any thread.
class Status {
 public:
  // Begins a stage, which goes on until the next: "comparing with the measurement".
  static void Stage(const std::string& what);
  // More of the stage that goes on, on a terminal alone: "iteration 3 ...".
  static void Show(const std::string& text);
  // Clears the line, before something else is printed. The stage goes on.
  static void Clear();
  // The same, and nothing goes on.
  static void End();

  // Whether lines are drawn over.
  static bool OnTerminal();
};

// Columns of the terminal that a stream is, which has this descriptor; nothing of another file.
std::optional<int> TerminalColumns(int descriptor);

// A stage that ends with its scope.
class StageScope {
 public:
  explicit StageScope(const std::string& what) { Status::Stage(what); }
  ~StageScope() { Status::End(); }
  StageScope(const StageScope&) = delete;
  StageScope& operator=(const StageScope&) = delete;
};

// While it lives, what is printed to std::cout and std::cerr clears the line before, on a terminal.
class LineClearing {
 public:
  LineClearing();
  ~LineClearing();
  LineClearing(const LineClearing&) = delete;
  LineClearing& operator=(const LineClearing&) = delete;

 private:
  class Buffer;
  std::unique_ptr<Buffer> out_, error_;
};

}  // namespace trilobe

#endif  // TRILOBE_APP_STATUS_H_
