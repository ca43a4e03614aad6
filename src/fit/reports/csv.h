#ifndef TRILOBE_FIT_REPORTS_CSV_H_
#define TRILOBE_FIT_REPORTS_CSV_H_

#include <iomanip>
#include <limits>
#include <locale>
#include <optional>
#include <sstream>
#include <string>

#include "core/base/text.h"

namespace trilobe {

// A table with a header line. Numbers that read back to the same double, in any locale; "" where
// there is none.
class Csv {
 public:
  explicit Csv(const char* header) {
    out_.imbue(std::locale::classic());
    out_ << header << '\n' << std::setprecision(std::numeric_limits<double>::max_digits10);
  }
  template <typename Value>
  Csv& Add(const Value& value) {
    Begin() << value;
    return *this;
  }
  Csv& Add(const std::string& text) {
    Begin() << CsvField(text);
    return *this;
  }
  Csv& Add(const std::optional<double>& value) { return value ? Add(*value) : Add(""); }
  void EndRow() {
    out_ << '\n';
    first_ = true;
  }
  std::string text() const { return out_.str(); }

 private:
  std::ostream& Begin() {
    if (!first_) out_ << ',';
    first_ = false;
    return out_;
  }

  std::ostringstream out_;
  bool first_ = true;
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_CSV_H_
