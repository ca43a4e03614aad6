#ifndef TRILOBE_CORE_BASE_ERROR_H_
#define TRILOBE_CORE_BASE_ERROR_H_

#include <concepts>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "trilobe/core/base/printable.h"

namespace trilobe {

// What a caller would handle differently.
enum class ErrorKind {
  kFormat,       // a text or a file is not written as it must be, or a value is of another type
  kRange,        // a value is outside of what is allowed
  kUnknown,      // a name is not among those that are known
  kConflict,     // two things were given that exclude each other, or one was given twice
  kMismatch,     // sizes or forms of what belongs together differ
  kMissing,      // something that is needed was not given, or is not in the data
  kUnsupported,  // what was asked for cannot be had of this input, solver or format
  kFile,         // a file, a folder, a stream or another program cannot be used
  kData,         // numbers are of no use: too few, all 0, not finite, or they overflow
  kLimit,        // memory, size, accuracy or time do not suffice, or the work was interrupted
};

// "format", "range", ..., for logs and other languages.
std::string_view NameOf(ErrorKind kind);

// What a program can read off an Error, as it was given and not escaped. Empty, or 0, is unknown.
struct ErrorFacts {
  std::string file = {};   // the file, or another source, as synth:felt
  int line = 0;            // of the file, from 1
  std::string key = {};    // what is wrong: the name of an option, an argument, a column, a JSON
                           // pointer; or what could not be done with a file: "read", "write"
  std::string value = {};  // what it is or has: a number, a word, a length, the system's reason
};

// The text of a number for ErrorFacts: "3", "0.05", "nan".
std::string FactText(double number);

// Bad input or an impossible request. what() is one printable line that a user can act on: what is
// wrong, where (file, bin, key), and what to do. The program prints it and exits with status 1.
// Programs and tests go by its kind and facts, since sentences may be bettered. Thrown as
//
//   throw Error(ErrorKind::kRange, "lobes is 9; it must be from 0 to 8").About("lobes", lobes);
//   throw ErrorIn(ErrorKind::kData, path, "all counts are 0");  // "PATH: all counts are 0"
//
// Programming errors are glog CHECKs instead.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, std::string_view message)
      : std::runtime_error(Printable(message)), kind_(kind) {}

  ErrorKind kind() const { return kind_; }
  const ErrorFacts& facts() const { return facts_; }

  // The same error, which also tells its place.
  Error At(std::string_view file, int line = 0) && {
    facts_.file = file;
    facts_.line = line;
    return std::move(*this);
  }

  // The same error, which also tells what it is about. "--lobes" is of the option `lobes`.
  Error About(std::string_view key, std::string_view value = "") && {
    facts_.key = key.starts_with("--") ? key.substr(2) : key;
    facts_.value = value;
    return std::move(*this);
  }
  template <typename Number>
  requires std::is_arithmetic_v<Number> Error About(std::string_view key, Number value) && {
    std::string text;
    if constexpr (std::floating_point<Number>) {
      text = FactText(value);
    } else {
      text = std::to_string(value);
    }
    const std::string_view view = text;
    return std::move(*this).About(key, view);
  }

  // The same kind and facts in another sentence, mostly this one after what it belongs to.
  Error WithMessage(std::string_view message) const {
    Error error(kind_, message);
    error.facts_ = facts_;
    return error;
  }

 private:
  ErrorKind kind_;
  ErrorFacts facts_;
};

// "FILE: PROBLEM", at this file.
inline Error ErrorIn(ErrorKind kind, const std::string& file, const std::string& problem) {
  return Error(kind, file + ": " + problem).At(file);
}

// One line about the exception that ended one of many jobs, while the other jobs continue.
inline std::string MessageOf(const std::exception& exception) {
  if (dynamic_cast<const Error*>(&exception) != nullptr) return exception.what();
  if (dynamic_cast<const std::bad_alloc*>(&exception) != nullptr) {
    return "out of memory; try fewer threads";
  }
  return "internal error: " + Printable(exception.what());
}

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_ERROR_H_
